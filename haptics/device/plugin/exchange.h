// What the process of a plug-in and the servo's share.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstdint>

#include "base/system/worker.h"
#include "sparsha/device_plugin.h"

namespace sparsha::haptics::plugin {

/// How far the plug-in has come. `refused`: it is none that can be used; `not_open`: it says that its device cannot.
enum class Stage : std::uint32_t { starts, opens, runs, refused, not_open };

/// A sample as words.
using SampleWords = std::array<std::uint64_t, 10>;
[[nodiscard]] inline SampleWords words_of(const sparsha_device_sample& sample) noexcept {
  SampleWords words{};
  for (std::size_t i = 0; i < 3; ++i) words[i] = std::bit_cast<std::uint64_t>(sample.position_m[i]);
  for (std::size_t i = 0; i < 4; ++i) words[3 + i] = std::bit_cast<std::uint64_t>(sample.orientation[i]);
  words[7] = std::bit_cast<std::uint64_t>(sample.delay_s);
  words[8] = sample.buttons;
  words[9] = (sample.fresh != 0 ? 1U : 0U) | (sample.homed != 0 ? 2U : 0U) | (sample.connected != 0 ? 4U : 0U);
  return words;
}

struct Exchange {
  system::WorkerHead head;
  std::atomic<Stage> stage{Stage::starts};
  char problem[512] = {};      ///< before Stage::refused and Stage::not_open
  sparsha_device_info info{};  ///< before Stage::runs
  system::SharedMail<10> samples;
  system::SharedMail<3> force;                ///< newtons
  std::atomic<std::uint32_t> void_up_to{0};   ///< forces up to this number are zero
  std::atomic<std::uint64_t> servo_beats{0};  ///< signs of life of whoever decides the force
  std::atomic<std::uint32_t> refusals{0};     ///< calls of write() that returned an error
};

/// Of new positions, as device_plugin.h tells them.
inline constexpr double kUsualRate_hz = 1000.0, kLeastRate_hz = 100.0, kMostRate_hz = 10'000.0;
/// What a force may rest upon: later than so without a beat of the servo the plug-in is told zero.
inline constexpr std::int64_t kServoSilent_ns = 20'000'000;
/// A call that lasts longer: zero() is called meanwhile.
inline constexpr std::int64_t kCallHangs_ns = 10'000'000;
/// And after so long its process is killed.
inline constexpr std::uint32_t kKilledAfter_ms = 500;

/// The work of the plug-in's process: loads `file`, opens the device, and runs it until it is asked to stop.
void run_plugin(const char* file, Exchange& shared);
/// The work of the one after a crash: loads it anew, opens, switches off, closes.
void switch_off(const char* file);

}  // namespace sparsha::haptics::plugin
