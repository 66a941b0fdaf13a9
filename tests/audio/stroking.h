// Stones that are stroked, hands that stroke them, and what is heard of it.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "audio/synth.h"
#include "tests/audio/audio_scene.h"
#include "tests/audio/listening.h"

namespace stroking {

using namespace sparsha;
using namespace sparsha::audio;

inline constexpr double kRate = 48000.0;

using Height = std::function<double(double, double)>;

inline scene::ScenePointer stone(const Height& height, const test::SceneOptions& options,
                                 std::optional<scene::Material> material = std::nullopt, double gain = 0.5,
                                 bool grain = true) {
  return test::scene_of(height, options, [&](scene::SceneDescription& scene) {
    scene.config.audio = scene::AudioConfig{};
    scene.config.audio->friction_sound_gain = gain;
    scene.config.audio->friction_sound_grain = grain;
    if (!material) return;
    scene.config.audio->material = scene::MaterialSoundConfig{};
    scene.config.audio->material->material = *material;
  });
}

/// A hand that presses with 1 N, as the servo would publish it.
inline haptics::State hand(double time_s, double x, double y, const test::SceneOptions& options, double press_n = 1.0) {
  haptics::State state;
  state.tick = static_cast<std::uint64_t>(std::llround(time_s * 1000.0));
  state.time_s = time_s;
  state.proxy_m = state.place_m = {x, y, 0.0};
  state.normal = {0.0, 0.0, 1.0};
  state.force_n = {0.0, 0.0, press_n};
  state.contact = 1;
  state.flags = haptics::kFlagTexture | haptics::kFlagArmed;
  state.window = {0, 0, options.nx, options.ny};
  return state;
}

/// Hears `states` from their first one's time on.
inline listening::Samples hear(const scene::ScenePointer& scene, const std::vector<haptics::State>& states,
                               double tail_s = 0.0) {
  Synth synth(make_sound_bank(*scene, 48000));
  ProfileReader reader(scene, scene->description().config.audio->friction_sound_grain);
  std::vector<std::shared_ptr<const Profile>> kept;
  std::vector<float> sound;
  for (const haptics::State& state : states) {
    if (auto profile = reader.update(state)) {
      kept.push_back(profile);
      synth.profile(profile, 0);
    }
    const auto frame = static_cast<std::uint64_t>(std::llround(state.time_s * kRate));
    synth.state(state, frame);
    if (frame <= synth.frame() + 9600) continue;
    const auto more = audio_scene::render(synth, static_cast<double>(frame - synth.frame() - 4800) / kRate);
    sound.insert(sound.end(), more.begin(), more.end());
  }
  const double left = states.back().time_s - static_cast<double>(synth.frame()) / kRate;
  const auto more = audio_scene::render(synth, left + tail_s);
  sound.insert(sound.end(), more.begin(), more.end());
  return listening::channel(sound, 0);
}

/// A stroke along x at `speed`.
inline std::vector<haptics::State> stroke(double speed, double seconds, const test::SceneOptions& options,
                                          double press_n = 1.0, double from_x = 0.002) {
  std::vector<haptics::State> states;
  const double y = 0.5 * (options.ny - 1) * options.spacing_m;
  for (double t = 0.0; t < seconds; t += 1e-3) states.push_back(hand(t, from_x + speed * t, y, options, press_n));
  return states;
}

}  // namespace stroking
