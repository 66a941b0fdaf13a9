// Sound as a user meets it: the demo's loudness, pillars found in a scan, a strike fitted, devices listed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "app/exploration/device_choice.h"
#include "audio/sound_bank.h"
#include "audio/wav/sink.h"
#include "base/yaml/yaml.h"
#include "haptics/servo/haptic_renderer.h"
#include "haptics/window/window.h"
#include "scene/scene.h"
#include "tests/app/program.h"
#include "tests/audio/listening.h"
#include "tests/audio/live/sound_server.h"

namespace sparsha {
namespace {

using ::testing::HasSubstr;

/// Samples of a 16-bit stereo WAV file.
std::vector<float> samples_of(const fs::path& file) {
  const std::string bytes = text_of(file);
  const std::size_t data = bytes.find("data");
  std::vector<float> samples;
  for (std::size_t at = data + 8; data != std::string::npos && at + 1 < bytes.size(); at += 2) {
    std::int16_t value = 0;
    std::memcpy(&value, bytes.data() + at, 2);
    samples.push_back(static_cast<float>(value) / 32768.0F);
  }
  return samples;
}

void append(std::string& bytes, std::uint32_t value, int count) {
  for (int k = 0; k < count; ++k) bytes += static_cast<char>(value >> (8 * k) & 0xFFU);
}

/// 48 kHz; channels interleaved.
std::string wav_of(const std::vector<double>& samples, std::uint32_t channels = 1) {
  std::string bytes = "RIFF";
  const auto size = static_cast<std::uint32_t>(2 * samples.size());
  append(bytes, 36 + size, 4);
  bytes += "WAVEfmt ";
  for (const auto& [value, count] : std::array<std::pair<std::uint32_t, int>, 7>{
           {{16, 4}, {1, 2}, {channels, 2}, {48000, 4}, {96000 * channels, 4}, {2 * channels, 2}, {16, 2}}})
    append(bytes, value, count);
  bytes += "data";
  append(bytes, size, 4);
  for (const double sample : samples)
    append(bytes, static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(32767.0 * sample))), 2);
  return bytes;
}

class Sound : public Program {};

/// The demo's hand as if every tick came on time and every zoom took none: a busy machine loses ticks, and what a hand
/// does after a pause is another run.
std::vector<float> ten_seconds_of(const scene::ScenePointer& scene, const fs::path& wav) {
  const auto hand = app::simulated_hand(scene->description(), 0.0);
  const double width_m = hand->info().workspace_width_m;
  const auto steps = haptics::zoom_steps(scene->description(), width_m);
  const auto window = [&](std::size_t step, const Eigen::Vector2d& centre_m) {
    return haptics::load_window(*scene, haptics::plan_window(scene->description(), steps.at(step), centre_m, width_m),
                                step + 1);
  };
  haptics::RendererOptions options;
  options.stiffness_n_per_m = scene->description().config.haptics.stiffness_n_per_m;
  haptics::HapticRenderer renderer(hand->info(), options,
                                   window(0, haptics::middle_of(scene->description().levels.at(0))));
  const auto bank = audio::make_sound_bank(*scene, 48000);
  audio::WavSink sink(bank, wav, 16);
  audio::ProfileReader profiles(scene, bank->scrape_grain);
  bool pressed = false;
  for (int tick = 0; tick < 10000; ++tick) {
    const haptics::DeviceSample sample = hand->read(tick * 1e-3, 1e-3);
    renderer.update(sample, 1e-3);
    const haptics::State& state = renderer.state();
    hand->write({state.commanded_force_n[0], state.commanded_force_n[1], state.commanded_force_n[2]});
    if (auto profile = profiles.update(state)) sink.profile(std::move(profile), state.time_s);
    if (renderer.event()) sink.contact(*renderer.event());
    sink.state(state);
    if (sample.buttons != 0 && !pressed) {
      haptics::Command zoom;
      zoom.kind = haptics::Command::Kind::swap;
      zoom.window = window(1, {state.proxy_m[0], state.proxy_m[1]});
      static_cast<void>(renderer.apply(zoom));
    }
    pressed = sample.buttons != 0;
  }
  sink.finish(10.0);
  return samples_of(wav);
}

TEST_F(Sound, TenSecondsOfTheDemoAreMinus16LufsWithin2AndNothingClips) {
  const std::string relief = (fs::path(SPARSHA_SOURCE_DIR) / "configs" / "relief.yaml").string();
  ASSERT_EQ(run("build \"" + relief + "\" --out scene").code, 0);
  const std::vector<float> sound = ten_seconds_of(scene::open_scene(folder_ / "scene"), folder_ / "run.wav");
  ASSERT_GE(sound.size(), 2U * 48000U * 10U);
  const double loudness = listening::integrated_lufs(sound);
  EXPECT_NEAR(loudness, -16.0, 2.0);
  EXPECT_LT(listening::peak(listening::channel(sound, 0)), 0.9);
  std::printf("%.1f LUFS\n", loudness);
}

TEST_F(Sound, AClipThatCannotBePlayedStopsTheBuildBeforeItBegins) {
  write("stone.xyz", "0 0 0\n");  // too few points for a scene
  write("text.wav", "this is not a sound");
  std::ofstream(folder_ / "click.wav", std::ios::binary) << wav_of(std::vector<double>(48, 0.5));
  for (const std::string clip : {"text.wav", "missing.wav", "click.wav, loop: one_period"}) {
    write("stone.yaml",
          "scans: [{file: stone.xyz, units: m}]\naudio: {regions: [{name: a, box_m: [0, 0, 1, 1], clip: " + clip +
              "}]}\n");
    for (const char* command : {"build stone.yaml", "build stone.yaml --validate"}) {
      const Outcome outcome = run(command);
      EXPECT_EQ(outcome.code, 3) << clip;
      EXPECT_THAT(outcome.err, HasSubstr(clip.substr(0, clip.find(',')) + ": error: ")) << clip;
      EXPECT_FALSE(fs::exists(folder_ / "stone.scene"));
    }
  }
}

TEST_F(Sound, AStrikeWhoseModesBeatIsFittedWithAWarningThatNamesThem) {
  std::vector<double> strike(96000), pair(96000);
  for (std::size_t i = 0; i < strike.size(); ++i) {
    const double t = static_cast<double>(i) / 48000.0, turn = 2.0 * std::numbers::pi * t;
    pair[i] = 0.2 * std::exp(-6.9 * t / 1.5) * (std::sin(440.0 * turn) + 0.9 * std::sin(443.0 * turn));
    strike[i] = pair[i] + 0.3 * std::exp(-6.9 * t / 1.5) * std::sin(240.0 * turn);
  }
  std::ofstream(folder_ / "strike.wav", std::ios::binary) << wav_of(strike);
  std::ofstream(folder_ / "pair.wav", std::ios::binary) << wav_of(pair);
  const Outcome fitted = run("sound fit strike.wav");
  EXPECT_EQ(fitted.code, 0);
  EXPECT_THAT(fitted.out, HasSubstr("frequency_hz: 240.0"));
  EXPECT_THAT(fitted.err, HasSubstr("warning: "));
  EXPECT_THAT(fitted.err, HasSubstr("beat, or a hum, near 44"));
  const Outcome none = run("sound fit pair.wav");
  EXPECT_EQ(none.code, 3);
  EXPECT_THAT(none.err, HasSubstr("beat, or a hum, near 44"));
}

TEST_F(Sound, ARunOnTheMachinesOwnClockIsHeardAndNothingClips) {
  const std::string relief = (fs::path(SPARSHA_SOURCE_DIR) / "configs" / "relief.yaml").string();
  ASSERT_EQ(run("build \"" + relief + "\" --out scene").code, 0);
  ASSERT_EQ(run("explore scene --device simulated --headless --duration 5 --audio-out run.wav").code, 0);
  const std::vector<float> sound = samples_of(folder_ / "run.wav");
  ASSERT_GE(sound.size(), 2U * 48000U * 4U);
  const double peak = listening::peak(listening::channel(sound, 0));
  EXPECT_GT(peak, 0.01);
  EXPECT_LT(peak, 0.9);
}

TEST_F(Sound, ThePillarsOfTheHallAreFoundWhereTheyStandAndEachGetsItsRecording) {
  const fs::path source = SPARSHA_SOURCE_DIR;
  fs::create_directories(folder_ / "configs");
  fs::create_directories(folder_ / "data");
  fs::copy(source / "configs" / "pillars.yaml", folder_ / "configs" / "pillars.yaml");
  fs::copy(source / "data" / "audio", folder_ / "data" / "audio");
  ASSERT_EQ(run("simulate \"" + (source / "configs" / "simulate-pillars.yaml").string() + "\" --out data/pillars").code,
            0);
  const Outcome build = run("build configs/pillars.yaml --out hall");
  ASSERT_EQ(build.code, 0) << build.err;
  const scene::ScenePointer scene = scene::open_scene(folder_ / "hall");
  const auto& audio = scene->description().config.audio;
  ASSERT_TRUE(audio);
  EXPECT_FALSE(audio->find_pillars) << "a scene says where they are";
  ASSERT_EQ(audio->regions.size(), 8U);
  // Axes as configs/simulate-pillars.yaml places them, half a metre apart; the fifth is the major one.
  const std::array<std::pair<const char*, double>, 8> truth = {{{"major", 2.25},
                                                                {"sa", 0.25},
                                                                {"re", 0.75},
                                                                {"ga", 1.25},
                                                                {"ma", 1.75},
                                                                {"pa", 2.75},
                                                                {"dha", 3.25},
                                                                {"ni", 3.75}}};
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const scene::AudioRegionConfig& region = audio->regions[k];
    EXPECT_EQ(region.name, truth[k].first);
    ASSERT_EQ(region.polygon_m.size(), 4U) << region.name;
    double low_x = 1e9, high_x = -1e9, low_y = 1e9, high_y = -1e9;
    for (const auto& corner : region.polygon_m) {
      low_x = std::min(low_x, corner[0]), high_x = std::max(high_x, corner[0]);
      low_y = std::min(low_y, corner[1]), high_y = std::max(high_y, corner[1]);
    }
    const double radius = k == 0 ? 0.15 : 0.06;
    EXPECT_NEAR(0.5 * (low_x + high_x), truth[k].second, 0.02) << region.name;
    EXPECT_NEAR(0.5 * (high_x - low_x), radius, 0.2 * radius + 0.01) << region.name;
    // The shaft, between base and capital, each a twelfth of 2.4 m.
    EXPECT_LT(low_y, 0.35) << region.name;
    EXPECT_GT(high_y, 2.05) << region.name;
    const auto* clip = std::get_if<fs::path>(&region.sound);
    ASSERT_NE(clip, nullptr);
    EXPECT_THAT(clip->string(), HasSubstr(std::string("pillar-") + truth[k].first));
  }
}

TEST_F(Sound, AFittedStrikeIsABlockThatAConfigurationReads) {
  std::vector<double> strike(72000, 0.0);
  for (std::size_t i = 2400; i < strike.size(); ++i) {
    const double t = static_cast<double>(i - 2400) / 48000.0;
    strike[i] = 0.5 * std::exp(-6.9078 * t / 0.9) * std::sin(2.0 * std::numbers::pi * 328.5 * t) +
                0.2 * std::exp(-6.9078 * t / 0.4) * std::sin(2.0 * std::numbers::pi * 871.0 * t);
  }
  write("strike.wav", wav_of(strike));
  const Outcome fit = run("sound fit strike.wav");
  ASSERT_EQ(fit.code, 0) << fit.err;
  EXPECT_THAT(fit.out, HasSubstr("modal:\n  modes:\n    - {frequency_hz: 328."));
  std::string block = "audio:\n  regions:\n    - name: own\n      box_m: [0, 0, 1, 1]\n";
  std::istringstream lines(fit.out);
  for (std::string line; std::getline(lines, line);) block += "      " + line + "\n";
  const scene::Config config =
      scene::parse_config(yaml::parse_text("scans: [{file: a.ply}]\n" + block, "own.yaml"), {});
  const auto& modes = std::get<scene::ModalConfig>(config.audio->regions[0].sound).modes;
  ASSERT_EQ(modes.size(), 2U);
  EXPECT_NEAR(modes[0].frequency_hz, 328.5, 0.1);
  EXPECT_NEAR(modes[1].decay_s, 0.4, 0.02);
}

TEST_F(Sound, TwoMicrophonesInOppositePhaseGiveTheModesOfOne) {
  std::vector<double> one, two;
  for (std::size_t i = 0; i < 72000; ++i) {
    const double t = (static_cast<double>(i) - 2400.0) / 48000.0;
    const auto mode = [&](double amplitude, double frequency_hz, double decay_s) {
      return t < 0.0
                 ? 0.0
                 : amplitude * std::exp(-6.9078 * t / decay_s) * std::sin(2.0 * std::numbers::pi * frequency_hz * t);
    };
    const double near = mode(0.5, 328.5, 0.9) + mode(0.2, 871.0, 0.4);
    one.push_back(near);
    two.insert(two.end(), {near, mode(0.45, 328.5, 0.9) - mode(0.2, 871.0, 0.4)});
  }
  write("one.wav", wav_of(one));
  write("two.wav", wav_of(two, 2));
  const Outcome mono = run("sound fit one.wav");
  ASSERT_EQ(mono.code, 0) << mono.err;
  EXPECT_EQ(run("sound fit two.wav").out, mono.out);
}

TEST_F(Sound, WhatCannotBeFittedIsRefusedAsInput) {
  write("notes.wav", "not a sound");
  write("silence.wav", wav_of(std::vector<double>(48000, 0.0)));
  for (const char* file : {"notes.wav", "silence.wav", "missing.wav"}) {
    const Outcome fit = run(std::string("sound fit ") + file);
    EXPECT_EQ(fit.code, 3) << file;
    EXPECT_THAT(fit.err, HasSubstr(file));
  }
}

#if __has_include(<jack/jack.h>)
TEST_F(Sound, WithoutAWindowARunIsHeardThroughASoundServer) {
  sound_server::SoundServer server;
  if (!server.installed()) GTEST_SKIP() << sound_server::kMissing;
  ASSERT_TRUE(server.running()) << sound_server::kSilent;
  ASSERT_EQ(run("build " + relief_ + " --out scene").code, 0);
  Outcome outcome;
  std::thread program([&] { outcome = run("explore scene --device simulated --headless --duration 8"); });
  std::size_t heard = 0;
  for (int i = 0; i < 30 && heard == 0; ++i) {  // until the program has come to its ports
    const sound_server::Listener listener;
    for (int k = 0; k < 100 && listener.connected() && heard == 0; ++k) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      heard = listener.onsets().size();
    }
    if (!listener.connected()) std::this_thread::sleep_for(std::chrono::milliseconds(300));
  }
  program.join();
  EXPECT_GT(heard, 0U);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
}
#endif

TEST_F(Sound, DevicesAreListedAndAnUnknownOneIsAWarningNotTheEnd) {
  EXPECT_EQ(run("explore --list-audio").code, 0);
  EXPECT_TRUE(nlohmann::json::parse(run("explore --list-audio --json").out).is_array());
  EXPECT_EQ(run("explore").code, 2);
  ASSERT_EQ(run("build " + relief_ + " --out scene").code, 0);
  const Outcome outcome =
      run("explore scene --device simulated --headless --duration 2 --audio-device \"no such device\"");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("sound device"));
}

}  // namespace
}  // namespace sparsha
