// Scenes that only sound.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "audio/sound_bank.h"
#include "audio/synth.h"
#include "scene/scene_fwd.h"
#include "tests/support/scenes.h"
#include "tests/support/test_folder.h"

namespace audio_scene {

using namespace sparsha;

using Folder = test::TestFolder;

inline scene::AudioRegionConfig note(const std::string& name, std::array<double, 4> box, double frequency_hz,
                                     double decay_s) {
  scene::AudioRegionConfig region;
  region.name = name;
  region.box_m = box;
  region.sound = scene::ModalConfig{frequency_hz, decay_s, {}};
  return region;
}

inline scene::AudioRegionConfig clip(const std::string& name, std::array<double, 4> box,
                                     const std::filesystem::path& file) {
  scene::AudioRegionConfig region;
  region.name = name;
  region.box_m = box;
  region.sound = file;
  return region;
}

/// A 2x2 flat scene with these sounds.
inline scene::ScenePointer scene(std::vector<scene::AudioRegionConfig> regions,
                                 std::optional<double> friction_gain = std::nullopt) {
  scene::AudioConfig audio;
  audio.regions = std::move(regions);
  audio.friction_sound_gain = friction_gain;
  return sparsha::test::scene_of([](double, double) { return 0.0; }, {2, 2, 1.0},
                                 [&](scene::SceneDescription& description) { description.config.audio = audio; });
}

inline std::shared_ptr<const audio::SoundBank> bank(std::vector<scene::AudioRegionConfig> regions,
                                                    std::optional<double> friction_gain = std::nullopt) {
  return audio::make_sound_bank(*scene(std::move(regions), friction_gain), 48000);
}

inline haptics::ContactEvent touch(double time_s, double x, double y, double force_n) {
  haptics::ContactEvent event;
  event.time_s = time_s;
  event.proxy_m = event.place_m = {x, y, 0.0};
  event.peak_force_n = force_n;
  return event;
}

inline haptics::ContactEvent lift(double time_s) {
  haptics::ContactEvent event;
  event.kind = haptics::ContactEvent::Kind::lift;
  event.time_s = time_s;
  return event;
}

/// A hand that presses with 1 N at a place, as the servo publishes it.
inline haptics::State stroking(double time_s, double x, double y, double press_n = 1.0) {
  haptics::State state;
  state.tick = static_cast<std::uint64_t>(std::llround(time_s * 1000.0));
  state.time_s = time_s;
  state.proxy_m = state.place_m = {x, y, 0.0};
  state.normal = {0.0, 0.0, 1.0};
  state.force_n = {0.0, 0.0, press_n};
  state.contact = press_n > 0.0 ? 1 : 0;
  state.flags = haptics::kFlagTexture | haptics::kFlagArmed;
  return state;
}

/// Rough stone of 1 m, 101 nodes per side.
inline std::shared_ptr<const audio::Profile> rough_profile() {
  const auto rough = [](double x, double y) { return 0.004 * std::sin(310.0 * x) * std::sin(290.0 * y + 1.0); };
  return std::make_shared<const audio::ViewProfile>(*sparsha::test::scene_of(rough, {101, 101, 0.01}),
                                                    audio::ViewProfile::Window{0, 0, 0, 101, 101, true}, nullptr);
}

/// The next `seconds` of a synth, interleaved.
inline std::vector<float> render(audio::Synth& synth, double seconds, std::size_t block = 256) {
  std::vector<float> result(2 * static_cast<std::size_t>(seconds * synth.sample_rate_hz()));
  for (std::size_t at = 0; at < result.size(); at += 2 * block)
    synth.render(std::span(result).subspan(at, std::min(2 * block, result.size() - at)));
  return result;
}

}  // namespace audio_scene
