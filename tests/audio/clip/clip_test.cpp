// Clips: read, resampled, played back, refused when damaged.
#include "audio/clip/clip.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include <sndfile.h>

#include "audio/clip/player.h"
#include "base/error.h"
#include "tests/audio/audio_scene.h"
#include "tests/audio/listening.h"

namespace {

using namespace sparsha;
using namespace sparsha::audio;

void write_sound(const std::filesystem::path& file, const std::vector<float>& samples, int channels, int rate,
                 int format = SF_FORMAT_WAV | SF_FORMAT_FLOAT) {
  SF_INFO info{};
  info.samplerate = rate;
  info.channels = channels;
  info.format = format;
  SNDFILE* sound = sf_open(file.c_str(), SFM_WRITE, &info);
  ASSERT_NE(sound, nullptr);
  const auto frames = static_cast<sf_count_t>(samples.size()) / channels;
  ASSERT_EQ(sf_writef_float(sound, samples.data(), frames), frames);
  sf_close(sound);
}

std::vector<float> noise(std::size_t count, float size) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> value(-size, size);
  std::vector<float> result(count);
  for (float& sample : result) sample = value(random);
  return result;
}

void expect_input_error(const std::filesystem::path& file) {
  try {
    (void)load_clip(file, 48000);
    FAIL() << "no error for " << file;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_EQ(error.place().file, file.string());
    EXPECT_FALSE(error.expected().empty());
  }
}

TEST(Clip, PlaybackEqualsTheFileAtItsOwnRate) {
  const audio_scene::Folder folder;
  const auto samples = noise(2 * 6000, 0.7F);
  write_sound(folder / "re.wav", samples, 2, 48000);
  Synth synth(audio_scene::bank({audio_scene::clip("re", {0, 0, 1, 1}, folder / "re.wav")}));
  // 4.5 N: a clip is at its own level from 4 N on.
  ASSERT_TRUE(synth.contact(audio_scene::touch(0.0, 0.5, 0.5, 4.5), 1000));
  const auto sound = audio_scene::render(synth, 0.2);
  const std::size_t first = 2 * (1000 + Synth::latency_frames());
  for (std::size_t i = 0; i < first; ++i) ASSERT_EQ(sound[i], 0.0F);
  // But for the last 5 ms, in which a clip fades that stops while it sounds.
  for (std::size_t i = 0; i < samples.size() - 2 * 240; ++i) ASSERT_EQ(sound[first + i], samples[i]) << i;
  for (std::size_t i = first + samples.size(); i < sound.size(); ++i) ASSERT_EQ(sound[i], 0.0F);
}

TEST(Clip, ARecordingThatStopsWhileItSoundsEndsWithoutAClick) {
  const audio_scene::Folder folder;
  std::vector<float> tone(9600);
  for (std::size_t i = 0; i < tone.size(); ++i)  // with the constant of a recorder; cut at its crest
    tone[i] = static_cast<float>(0.1 + 0.4 * std::sin(2.0 * std::numbers::pi * 0.00521 * static_cast<double>(i)));
  write_sound(folder / "cut.wav", tone, 1, 48000);
  Synth synth(audio_scene::bank({audio_scene::clip("cut", {0, 0, 1, 1}, folder / "cut.wav")}));
  ASSERT_TRUE(synth.contact(audio_scene::touch(0.0, 0.5, 0.5, 4.5), 1000));
  const auto sound = listening::channel(audio_scene::render(synth, 0.4), 0);
  const std::size_t first = 1000 + Synth::latency_frames();
  const double own = listening::sharpest_corner(sound, first + 100, first + 9000);
  // A fade by 0.5 over 240 frames bends by 0.5/240 at its ends; the cut would step by 0.5.
  EXPECT_LT(listening::sharpest_corner(sound, first + 9000, sound.size()), own + 3.0 * 0.5 / 240.0);
}

TEST(Clip, AMonoFileFillsBothChannels) {
  const audio_scene::Folder folder;
  const auto samples = noise(500, 0.7F);
  write_sound(folder / "mono.wav", samples, 1, 48000);
  const Clip clip = load_clip(folder / "mono.wav", 48000);
  ASSERT_EQ(clip.frames(), 500U);
  for (std::size_t i = 0; i < 500; ++i) {
    EXPECT_EQ(clip.samples[2 * i], samples[i]);
    EXPECT_EQ(clip.samples[2 * i + 1], samples[i]);
  }
}

TEST(Clip, ASofterTouchPlaysItSofter) {
  const audio_scene::Folder folder;
  write_sound(folder / "re.wav", noise(20000, 0.7F), 1, 48000);
  double last = 0.0;
  for (const double force : {0.1, 0.3, 1.0, 3.0}) {
    Synth synth(audio_scene::bank({audio_scene::clip("re", {0, 0, 1, 1}, folder / "re.wav")}));
    synth.contact(audio_scene::touch(0.0, 0.5, 0.5, force), 0);
    const auto sound = listening::channel(audio_scene::render(synth, 0.4), 0);
    EXPECT_GT(listening::rms(sound, 0, sound.size()), 1.5 * last);
    last = listening::rms(sound, 0, sound.size());
  }
}

TEST(Clip, ResamplingKeepsPitchLevelAndLength) {
  for (const double rate : {8000.0, 22050.0, 44100.0, 96000.0}) {
    std::vector<float> tone(static_cast<std::size_t>(rate));
    for (std::size_t i = 0; i < tone.size(); ++i)
      tone[i] = static_cast<float>(0.5 * std::sin(2.0 * std::numbers::pi * 1000.0 * static_cast<double>(i) / rate));
    const auto out = resample(tone, 1, rate, 48000.0);
    EXPECT_NEAR(static_cast<double>(out.size()), 48000.0, 1.0);
    for (std::size_t i = 4800; i < 43200; ++i)  // away from the ends, where the tone begins and stops
      ASSERT_NEAR(static_cast<double>(out[i]),
                  0.5 * std::sin(2.0 * std::numbers::pi * 1000.0 * static_cast<double>(i) / 48000.0), 2e-5);
  }
}

TEST(Clip, ResamplingDownFoldsNothingBack) {
  std::vector<float> tone(96000);
  for (std::size_t i = 0; i < tone.size(); ++i)
    tone[i] = static_cast<float>(std::sin(2.0 * std::numbers::pi * 30000.0 * static_cast<double>(i) / 96000.0));
  const auto out = resample(tone, 1, 96000.0, 48000.0);
  const listening::Samples sound(out.begin(), out.end());
  EXPECT_LT(listening::decibel(listening::rms(sound, 4800, 43200)), -90.0);
}

TEST(Clip, EveryDamagedFileIsAnInputErrorThatNamesIt) {
  const audio_scene::Folder folder;
  expect_input_error(folder / "missing.wav");
  std::ofstream(folder / "empty.wav");
  expect_input_error(folder / "empty.wav");
  std::ofstream(folder / "text.wav") << "this is not a sound";
  expect_input_error(folder / "text.wav");
  std::filesystem::create_directory(folder / "folder.wav");
  expect_input_error(folder / "folder.wav");
  write_sound(folder / "no-frames.wav", {}, 1, 48000);
  expect_input_error(folder / "no-frames.wav");
  write_sound(folder / "six.wav", noise(600, 0.5F), 6, 48000);
  expect_input_error(folder / "six.wav");
  write_sound(folder / "nan.wav", {0.0F, std::nanf(""), 0.0F}, 1, 48000);
  expect_input_error(folder / "nan.wav");
  write_sound(folder / "header-only.wav", noise(5000, 0.5F), 1, 48000, SF_FORMAT_WAV | SF_FORMAT_PCM_16);
  std::filesystem::resize_file(folder / "header-only.wav", 44);
  expect_input_error(folder / "header-only.wav");
  write_sound(folder / "cut.flac", noise(50000, 0.5F), 1, 48000, SF_FORMAT_FLAC | SF_FORMAT_PCM_16);
  std::filesystem::resize_file(folder / "cut.flac", 40000);
  expect_input_error(folder / "cut.flac");
}

TEST(Clip, StealingVoicesMakesNoClick) {
  // A slow swell whose own corners are tiny; 64 of them started 2 ms apart steal each other.
  Clip swell;
  for (std::size_t i = 0; i < 48000; ++i) {
    const auto value =
        static_cast<float>(0.01 * (1.0 - std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / 48000.0)));
    swell.samples.insert(swell.samples.end(), {value, value});
  }
  ClipPlayer player(48000.0);
  listening::Samples sound;
  for (int i = 0; i < 400; ++i) {
    if (i < 64) {
      EXPECT_TRUE(player.start(swell, 1.0));
    }
    listening::Samples left(96), right(96);
    player.render(left.data(), right.data(), 96);
    sound.insert(sound.end(), left.begin(), left.end());
    EXPECT_LE(player.voices(), ClipPlayer::kSounding + 3);  // 5 ms of fading, one start every 2 ms
  }
  // A linear fade over 240 frames of at most 0.02 bends by 0.02/240 where it begins and ends; a cut would step by 0.02.
  EXPECT_LT(listening::sharpest_corner(sound, 0, sound.size()), 3.0 * 0.02 / 240.0);
}

TEST(Clip, ImpossibleNotesAreUsageErrors) {
  for (const auto& region :
       {audio_scene::note("a", {0, 0, 1, 1}, 0.0, 1.0), audio_scene::note("a", {0, 0, 1, 1}, 30000.0, 1.0),
        audio_scene::note("a", {0, 0, 1, 1}, 240.0, 0.0), audio_scene::note("a", {0, 0, 1, 1}, std::nan(""), 1.0)}) {
    try {
      (void)audio_scene::bank({region});
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
    }
  }
}

TEST(Clip, RegionsThatNameOneFileShareOneDecodedSound) {
  const audio_scene::Folder folder;
  write_sound(folder / "re.wav", noise(2 * 48000, 0.5F), 2, 48000);
  std::vector<scene::AudioRegionConfig> regions;
  for (int k = 0; k < 5000; ++k) regions.push_back(audio_scene::clip("re", {0, 0, 1, 1}, folder / "re.wav"));
  regions.push_back(audio_scene::clip("re", {0, 0, 1, 1}, folder / "." / "re.wav"));
  const auto bank = audio_scene::bank(regions);
  const auto& first = std::get<std::shared_ptr<const Clip>>(bank->regions.front().sound);
  for (const SoundRegion& region : bank->regions) {
    ASSERT_EQ(std::get<std::shared_ptr<const Clip>>(region.sound), first);
  }
}

/// A note of some partials that decays.
std::vector<float> decaying_note(double frequency_hz, int rate, double t60_s = 1.2) {
  std::vector<float> note(static_cast<std::size_t>(1.5 * rate));
  for (std::size_t i = 0; i < note.size(); ++i) {
    const double t = static_cast<double>(i) / rate, turn = 2.0 * std::numbers::pi * frequency_hz * t;
    note[i] = static_cast<float>(0.5 * std::exp(-6.9078 * t / t60_s) *
                                 (std::sin(turn) + 0.3 * std::sin(2.0 * turn + 0.4) + 0.1 * std::sin(3.0 * turn)));
  }
  return note;
}

TEST(Clip, OnePeriodOfANoteIsLoopedAtItsPitchWithin1CentAndWithItsDecay) {
  const audio_scene::Folder folder;
  for (const double frequency : {97.3, 240.0, 451.7, 1234.5})
    for (const int rate : {22050, 48000}) {
      write_sound(folder / "note.wav", decaying_note(frequency, rate), 1, rate);
      const Clip looped = loop_one_period(load_clip(folder / "note.wav", 48000), 48000, "note.wav");
      ASSERT_GT(looped.frames(), 48000U);
      const auto sound = listening::channel(looped.samples, 0);
      const double heard =
          listening::strongest_frequency(sound, 0.8 * frequency, 1.2 * frequency, 48000.0, 1000, 30000);
      EXPECT_LT(std::abs(1200.0 * std::log2(heard / frequency)), 1.0) << frequency << " at " << rate;
      EXPECT_NEAR(listening::t60_s(sound, heard, 48000.0, 0.05, 0.7) / 1.2, 1.0, 0.05);
      // No click where an end meets a beginning: no sharper bend than the note itself has.
      const auto note = listening::channel(load_clip(folder / "note.wav", 48000).samples, 0);
      EXPECT_LT(listening::sharpest_corner(sound, 1000, sound.size()),
                1.2 * listening::sharpest_corner(note, 10, note.size()));
    }
}

TEST(Clip, SilenceOrNoiseBehindANoteDoesNotLengthenItsLoopedDecay) {
  const audio_scene::Folder folder;
  std::mt19937 random(5);
  for (const double behind_db : {-300.0, -50.0}) {
    auto note = decaying_note(240.0, 48000);
    note.resize(note.size() + 3 * 48000U);
    std::uniform_real_distribution<double> value(-1.0, 1.0);
    // Uniform noise of that level below the note's largest sample, 0.5.
    for (float& sample : note)
      sample += static_cast<float>(0.5 * std::sqrt(3.0) * std::pow(10.0, behind_db / 20.0) * value(random));
    write_sound(folder / "note.wav", note, 1, 48000);
    const Clip looped = loop_one_period(load_clip(folder / "note.wav", 48000), 48000, "note.wav");
    const auto sound = listening::channel(looped.samples, 0);
    // Of a fall of 35 dB the last quarter holds noise up to 10 dB below the note.
    EXPECT_NEAR(listening::t60_s(sound, 240.0, 48000.0, 0.05, 0.7) / 1.2, 1.0, 0.08) << behind_db;
  }
}

TEST(Clip, APeriodOfAStoneWhosePartialsAreNoMultiplesIsLoopedInTuneWithoutAStep) {
  for (const double frequency : {120.0, 240.0, 317.3}) {
    Clip clip;
    for (std::size_t i = 0; i < 72000; ++i) {
      const double t = static_cast<double>(i) / 48000.0;
      double value = 0.0;
      for (const auto& [ratio, level] : {std::pair{1.0, 0.4}, {2.756, 0.25}, {5.404, 0.12}})  // of a bar
        value += level * std::exp(-6.9078 * t / 1.5) * std::sin(2.0 * std::numbers::pi * ratio * frequency * t + ratio);
      clip.samples.insert(clip.samples.end(), 2, static_cast<float>(value));
    }
    const Clip looped = loop_one_period(clip, 48000, "bar");
    const auto note = listening::channel(clip.samples, 0), sound = listening::channel(looped.samples, 0);
    EXPECT_LT(listening::sharpest_corner(sound, 100, sound.size()),
              1.5 * listening::sharpest_corner(note, 100, note.size()))
        << frequency;
    const double heard = listening::strongest_frequency(sound, 0.8 * frequency, 1.2 * frequency, 48000.0, 1000, 30000);
    EXPECT_LT(std::abs(1200.0 * std::log2(heard / frequency)), 5.0) << frequency;
  }
}

TEST(Clip, TheConstantOfARecorderChangesNoLoop) {
  const audio_scene::Folder folder;
  auto note = decaying_note(240.0, 48000);
  for (float& sample : note) sample = 0.8F * sample + 0.1F;
  write_sound(folder / "note.wav", note, 1, 48000);
  const Clip looped = loop_one_period(load_clip(folder / "note.wav", 48000), 48000, "note.wav");
  const auto sound = listening::channel(looped.samples, 0);
  EXPECT_NEAR(listening::t60_s(sound, 240.0, 48000.0, 0.05, 0.7) / 1.2, 1.0, 0.05);
  double sum = 0.0;
  for (std::size_t i = 0; i < 4800; ++i) sum += sound[i];  // whole periods
  EXPECT_LT(std::abs(sum / 4800.0), 0.01);
}

TEST(Clip, OfTheHallsOwnPillarsOnePeriodIsLoopedAndNotSeveral) {
  constexpr int kRate = 48000;
  const std::filesystem::path folder = std::filesystem::path(SPARSHA_SOURCE_DIR) / "data" / "audio";
  int pillars = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!entry.path().filename().string().starts_with("pillar-")) continue;
    ++pillars;
    const Clip clip = load_clip(entry.path(), kRate);
    const auto whole = listening::channel(clip.samples, 0);
    const auto looped = listening::channel(loop_one_period(clip, kRate, entry.path().string()).samples, 0);
    // Its lowest partial: the loudest below 600 Hz, in steps of a hertz.
    double pitch_hz = 0.0, most = 0.0;
    for (double hz = 60.0; hz < 600.0; hz += 1.0)
      if (const double level = listening::amplitude_at(whole, hz, kRate, 4800, 28800); level > most)
        most = level, pitch_hz = hz;
    const double own = listening::amplitude_at(looped, pitch_hz, kRate, 4800, 28800);
    for (const double share : {1.0 / 4.0, 1.0 / 3.0, 1.0 / 2.0, 2.0 / 3.0, 3.0 / 4.0})
      EXPECT_LT(listening::amplitude_at(looped, share * pitch_hz, kRate, 4800, 28800), 0.03 * own)
          << entry.path().filename() << ", " << share << " of " << pitch_hz << " Hz";
  }
  EXPECT_EQ(pillars, 8);
}

TEST(Clip, WhatHasNoPitchCannotBeLooped) {
  Clip clip;
  clip.samples = std::vector<float>(2 * 48000, 0.0F);
  EXPECT_THROW((void)loop_one_period(clip, 48000, "silence.wav"), Error);
  clip.samples.resize(200);
  EXPECT_THROW((void)loop_one_period(clip, 48000, "short.wav"), Error);
}

TEST(Clip, FlacAndOggAreReadToo) {
  const audio_scene::Folder folder;
  const auto note = decaying_note(240.0, 48000);
  write_sound(folder / "note.flac", note, 1, 48000, SF_FORMAT_FLAC | SF_FORMAT_PCM_16);
  write_sound(folder / "note.ogg", note, 1, 48000, SF_FORMAT_OGG | SF_FORMAT_VORBIS);
  for (const char* name : {"note.flac", "note.ogg"}) {
    const auto sound = listening::channel(load_clip(folder / name, 48000).samples, 0);
    EXPECT_NEAR(listening::strongest_frequency(sound, 200.0, 280.0, 48000.0, 0, 48000), 240.0, 0.1) << name;
  }
}

}  // namespace
