// The engine as the program uses it: a session that runs, a WAV file at its end.
#include "audio/engine.h"

#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include <sndfile.h>

#include "audio/wav/sink.h"
#include "base/error.h"
#include "tests/audio/audio_scene.h"
#include "tests/audio/listening.h"

namespace {

using namespace sparsha;
using namespace sparsha::audio;
using audio_scene::note;

struct Sound {
  SF_INFO info{};
  std::vector<float> samples;
};

Sound read_sound(const std::filesystem::path& file) {
  Sound sound;
  SNDFILE* handle = sf_open(file.c_str(), SFM_READ, &sound.info);
  EXPECT_NE(handle, nullptr) << file;
  if (handle == nullptr) return sound;
  sound.samples.resize(static_cast<std::size_t>(sound.info.frames * sound.info.channels));
  sf_readf_float(handle, sound.samples.data(), sound.info.frames);
  sf_close(handle);
  return sound;
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

haptics::State at_tick(std::uint64_t tick) {
  haptics::State state;
  state.tick = tick;
  state.time_s = static_cast<double>(tick) / 1000.0;
  return state;
}

/// A servo of `ticks` milliseconds, as fast as it goes, that touches at the given ticks.
void run(Engine& engine, haptics::ContactQueue& queue, haptics::Seqlock<haptics::State>& state, std::uint64_t ticks,
         const std::vector<std::uint64_t>& touches) {
  engine.start();
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) {
    const haptics::State now = at_tick(tick);
    for (const std::uint64_t touch : touches)
      if (touch == tick) queue.push(audio_scene::touch(now.time_s, 0.5, 0.5, 1.0));
    state.publish(now);
    if (tick % 10 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  engine.stop();
}

TEST(WavSink, PlacesEveryStrikeAtItsServoTimeToTheSample) {
  const audio_scene::Folder folder;
  for (const double time_s : {0.0, 0.001, 0.123, 0.7654321, 1.9}) {
    WavSink sink(audio_scene::bank({note("sa", {0, 0, 1, 1}, 240.0, 0.3)}), folder / "run.wav", 24);
    EXPECT_TRUE(sink.contact(audio_scene::touch(time_s, 0.5, 0.5, 8.0)));
    for (std::uint64_t tick = 1; tick <= 2000; ++tick) sink.state(at_tick(tick));
    sink.finish(2.0);
    const Sound sound = read_sound(folder / "run.wav");
    EXPECT_EQ(listening::onset(listening::channel(sound.samples, 0)),
              static_cast<std::size_t>(std::llround(time_s * 48000.0)));
  }
}

TEST(WavSink, SameEventsGiveTheSameBytes) {
  const audio_scene::Folder folder;
  const auto profile = audio_scene::rough_profile();
  const auto write = [&](const std::string& name, int bits) {
    WavSink sink(audio_scene::bank({note("sa", {0, 0, 1, 1}, 240.0, 0.3)}, 0.5), folder / name, bits);
    for (std::uint64_t tick = 1; tick <= 1000; ++tick) {
      const double time_s = static_cast<double>(tick) / 1000.0;
      const haptics::State state =
          audio_scene::stroking(time_s, 0.2 + 0.3 * time_s, 0.5, tick > 300 && tick < 800 ? 1.0 : 0.0);
      if (tick == 1) sink.profile(profile, 0.0);
      if (tick == 300) sink.contact(audio_scene::touch(state.time_s, 0.5, 0.5, 1.0));
      sink.state(state);
    }
    sink.finish(1.0);
    return bytes_of(folder / name);
  };
  EXPECT_EQ(write("a.wav", 16), write("b.wav", 16));
  EXPECT_EQ(write("a.wav", 24), write("b.wav", 24));
}

TEST(WavSink, KeepsWhatStillRingsAndEndsInSilence) {
  const audio_scene::Folder folder;
  for (const double decay : {0.5, 20.0}) {
    WavSink sink(audio_scene::bank({note("sa", {0, 0, 1, 1}, 240.0, decay)}), folder / "run.wav", 16);
    sink.contact(audio_scene::touch(0.9, 0.5, 0.5, 8.0));
    sink.finish(1.0);
    const Sound sound = read_sound(folder / "run.wav");
    const auto frames = static_cast<double>(sound.info.frames);
    EXPECT_GE(frames, decay > 10.0 ? 6.0 * 48000.0 : 1.3 * 48000.0);
    EXPECT_LE(frames, 6.0 * 48000.0);
    EXPECT_LE(std::abs(sound.samples.back()), 1.5F / 32768.0F);
  }
}

/// A 16-bit file cannot hold the first, tiny samples of a strike: never before its time, within a quarter of a
/// millisecond after.
void expect_onset(const Sound& sound, std::size_t frame) {
  const std::size_t heard = listening::onset(listening::channel(sound.samples, 0));
  EXPECT_GE(heard, frame);
  EXPECT_LE(heard, frame + 12);
}

TEST(Engine, WritesARunsSoundOfAtLeastTheRunsLengthAt48Kilohertz) {
  const audio_scene::Folder folder;
  auto queue = std::make_shared<haptics::ContactQueue>(256);
  haptics::Seqlock<haptics::State> state;
  EngineOptions options;
  options.wav = folder / "run.wav";
  options.live = false;
  Engine engine(audio_scene::scene({note("sa", {0, 0, 1, 1}, 240.0, 0.2)}), queue, state, options);
  run(engine, *queue, state, 1500, {200, 700, 1100});
  EXPECT_EQ(engine.strikes(), 3U);
  EXPECT_EQ(engine.warning(), "");
  const Sound sound = read_sound(options.wav);
  EXPECT_EQ(sound.info.samplerate, 48000);
  EXPECT_EQ(sound.info.format, SF_FORMAT_WAV | SF_FORMAT_PCM_16);
  EXPECT_GE(sound.info.frames, 1500 * 48);
  const auto left = listening::channel(sound.samples, 0);
  expect_onset(sound, 200U * 48U);
  EXPECT_GT(listening::rms(left, 1100 * 48, 1150 * 48), 10.0 * listening::rms(left, 1040 * 48, 1090 * 48));
}

TEST(Engine, WritesExactSilenceForASceneWithoutSound) {
  const audio_scene::Folder folder;
  auto queue = std::make_shared<haptics::ContactQueue>(256);
  haptics::Seqlock<haptics::State> state;
  EngineOptions options;
  options.wav = folder / "run.wav";
  Engine engine(audio_scene::scene({}), queue, state, options);
  run(engine, *queue, state, 300, {100});
  const Sound sound = read_sound(options.wav);
  EXPECT_GE(sound.info.frames, 300 * 48);
  for (const float value : sound.samples) ASSERT_EQ(value, 0.0F);
  EXPECT_EQ(engine.strikes(), 0U);
}

TEST(Engine, LeavesNoFileWhenItIsNotStopped) {
  const audio_scene::Folder folder;
  {
    auto queue = std::make_shared<haptics::ContactQueue>(256);
    haptics::Seqlock<haptics::State> state;
    EngineOptions options;
    options.wav = folder / "run.wav";
    options.live = false;
    Engine engine(audio_scene::scene({note("sa", {0, 0, 1, 1}, 240.0, 0.2)}), queue, state, options);
    engine.start();
  }
  EXPECT_TRUE(std::filesystem::is_empty((folder / "x").parent_path()));
}

TEST(Engine, AFolderThatCannotBeWrittenIsAFailureAtOnce) {
  const audio_scene::Folder folder;
  auto queue = std::make_shared<haptics::ContactQueue>(256);
  haptics::Seqlock<haptics::State> state;
  EngineOptions options;
  options.wav = folder / "nowhere/run.wav";
  try {
    Engine engine(audio_scene::scene({}), queue, state, options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::failure);
  }
}

TEST(Engine, RunsOnWithoutASoundDeviceAndSaysSo) {
  const audio_scene::Folder folder;
  auto queue = std::make_shared<haptics::ContactQueue>(256);
  haptics::Seqlock<haptics::State> state;
  EngineOptions options;
  options.wav = folder / "run.wav";
  Engine engine(audio_scene::scene({note("sa", {0, 0, 1, 1}, 240.0, 0.2)}), queue, state, options);
  run(engine, *queue, state, 1000, {400, 800});
  EXPECT_EQ(engine.strikes(), 2U);
  if (!engine.warning().empty()) {
    EXPECT_NE(engine.warning().find("no sound"), std::string::npos);
  }
  expect_onset(read_sound(options.wav), 400U * 48U);
}

TEST(Engine, NamesRegionsThatCannotSound) {
  auto region = note("sa", {0, 0, 1, 1}, 240.0, 0.2);
  region.box_m.reset();
  region.label = 2;
  auto queue = std::make_shared<haptics::ContactQueue>(256);
  haptics::Seqlock<haptics::State> state;
  EngineOptions options;
  options.live = false;
  const Engine engine(audio_scene::scene({region}), queue, state, options);
  EXPECT_NE(engine.warning().find("'sa'"), std::string::npos);
}

}  // namespace
