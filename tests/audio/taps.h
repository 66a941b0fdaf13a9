// A hand that taps, through the real servo, engine, PortAudio and sound server, to whoever listens to that server: when
// each tap is heard.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "audio/engine.h"
#include "tests/audio/audio_scene.h"
#include "tests/support/servo_parts.h"

namespace taps {

using namespace sparsha;
using Clock = std::chrono::steady_clock;

/// Of a sound after silence, as a listener has it.
struct Onset {
  Clock::time_point when;  ///< its sample leaves the server for the card
  double late_s = 0.0;     ///< how late the server was, which is the machine's doing
};

inline double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

/// A hand that taps a plane, by the clock of the wall: at known instants it is at the surface, on its way down.
struct Tapping {
  // No multiple of a tick or of the server's cycle, so that taps meet all their phases.
  static constexpr double kPeriod_s = 0.10037;
  static constexpr double kDown_s = 0.03;  ///< when it meets the surface, in each period
  static constexpr double kSpeed_m_per_s = 0.2;

  Clock::time_point begin = Clock::now();

  [[nodiscard]] double height_m(Clock::time_point now) const {
    const double t = std::fmod(seconds(now - begin), kPeriod_s);
    const double down_m = kSpeed_m_per_s * (kDown_s - t);
    const double up_m = kSpeed_m_per_s * (t - kDown_s - 0.03);
    return std::clamp(std::max(down_m, up_m), -0.002, 0.005);
  }
  [[nodiscard]] Clock::time_point tap(int k) const {
    return begin + std::chrono::duration_cast<Clock::duration>(
                       std::chrono::duration<double>(static_cast<double>(k) * kPeriod_s + kDown_s));
  }
};

struct Heard {
  std::vector<double> late_s;  ///< of each tap that was heard once
  int lost = 0, doubled = 0, too_soon = 0;
  bool struck_once_each = true;  ///< the engine counted no more strikes than the hand made taps
  double server_late_p90_s = 0.0;
  double ticks_in_time = 0.0, tick_ns_p50 = 0.0, tick_ns_p99 = 0.0;

  [[nodiscard]] double p90_s() const {
    std::vector<double> sorted = late_s;
    std::sort(sorted.begin(), sorted.end());
    return sorted.empty() ? HUGE_VAL : sorted[std::min(sorted.size() - 1, sorted.size() * 9 / 10)];
  }
  [[nodiscard]] double most_s() const {
    return late_s.empty() ? HUGE_VAL : *std::max_element(late_s.begin(), late_s.end());
  }
  /// A sound that began twice though it was struck once: the machine made a gap in the stream.
  [[nodiscard]] bool had_gaps() const { return doubled > 0 && struck_once_each; }
  /// The machine gave the server and the servo their processors when they were due.
  [[nodiscard]] bool machine_in_time() const { return server_late_p90_s < 0.0015 && ticks_in_time > 0.95; }
};

inline Heard judge(const Tapping& hand, const std::vector<Onset>& onsets, int first, int count,
                   const haptics::ServoFigures& figures) {
  Heard run;
  std::vector<double> cycles_s;
  for (int k = first; k < first + count; ++k) {
    // From a third of a period before the tap on, to a third before the next one.
    const auto from = hand.tap(k) - std::chrono::milliseconds(33);
    int heard = 0;
    for (const auto& onset : onsets) {
      const double since_s = seconds(onset.when - from);
      if (since_s < 0.0 || since_s >= Tapping::kPeriod_s) continue;
      if (++heard > 1) continue;
      run.late_s.push_back(seconds(onset.when - hand.tap(k)));
      cycles_s.push_back(onset.late_s);
      run.too_soon += run.late_s.back() < 0.0 ? 1 : 0;
    }
    run.lost += heard == 0 ? 1 : 0;
    run.doubled += heard > 1 ? 1 : 0;
  }
  std::sort(cycles_s.begin(), cycles_s.end());
  if (!cycles_s.empty()) run.server_late_p90_s = cycles_s[std::min(cycles_s.size() - 1, cycles_s.size() * 9 / 10)];
  run.ticks_in_time = figures.share_in_time;
  run.tick_ns_p50 = figures.tick_ns.quantile_ns(0.5);
  run.tick_ns_p99 = figures.tick_ns.quantile_ns(0.99);
  std::vector<double> sorted = run.late_s;
  std::sort(sorted.begin(), sorted.end());
  std::printf(
      "%d taps: heard after %.2f ms at the median, %.2f at p90, %.2f at most; %d lost, %d doubled; server late by "
      "%.2f ms at p90, %.1f %% of ticks in time, tick %.0f ns at the median\n",
      count, sorted.empty() ? 0.0 : 1e3 * sorted[sorted.size() / 2], 1e3 * run.p90_s(), 1e3 * run.most_s(), run.lost,
      run.doubled, 1e3 * run.server_late_p90_s, 100.0 * run.ticks_in_time, run.tick_ns_p50);
  return run;
}

/// Times are judged at night; else that every tap is heard, once and not too soon.
inline bool at_night() { return std::getenv("SPARSHA_NIGHTLY") != nullptr; }

/// What goes on beside the taps: called every 70 ms, and gone before the engine.
using Meanwhile = std::function<std::function<void()>(audio::Engine&)>;

/// `Listener` is made when the engine plays; it has connected() and onsets().
template <class Listener>
[[nodiscard]] Heard hear_once(int count, double settled_s, const Meanwhile& make_meanwhile) {
  haptics::Seqlock<haptics::State> state;
  const auto queue = std::make_shared<haptics::ContactQueue>(256);
  audio::Engine engine(audio_scene::scene({audio_scene::note("ti", {-1, -1, 1, 1}, 2400.0, 0.02)}), queue, state, {});
  const Tapping hand;
  haptics::ScriptedDevice device([&](std::uint64_t, double time_s) {
    return haptics::sample_at({0.0, 0.0, hand.height_m(Clock::now())}, time_s);
  });
  haptics::Servo servo(device, haptics::patient(), haptics::window_on(sparsha::test::flat_scene()), state, {queue},
                       nullptr);
  servo.start();
  engine.start();
  EXPECT_TRUE(haptics::eventually([&] { return engine.playing(); })) << engine.warning();
  const Listener listener;
  EXPECT_TRUE(listener.connected());
  const std::function<void()> meanwhile = make_meanwhile ? make_meanwhile(engine) : [] {};
  std::this_thread::sleep_for(std::chrono::duration<double>(settled_s));
  const int first = static_cast<int>(seconds(Clock::now() - hand.begin) / Tapping::kPeriod_s) + 2;
  while (Clock::now() < hand.tap(first + count) - std::chrono::milliseconds(20)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(70));
    meanwhile();
  }
  servo.stop();
  Heard run = judge(hand, listener.onsets(), first, count, servo.figures());
  run.struck_once_each =
      static_cast<double>(engine.strikes()) <= 1.0 + seconds(Clock::now() - hand.begin) / Tapping::kPeriod_s;
  return run;
}

/// The same, again where the machine made gaps; a third run is judged as it is.
template <class Listener>
[[nodiscard]] Heard hear(int count, double settled_s, const Meanwhile& make_meanwhile = {}) {
  Heard run = hear_once<Listener>(count, settled_s, make_meanwhile);
  for (int more = 0; more < 2 && run.had_gaps(); ++more) run = hear_once<Listener>(count, settled_s, make_meanwhile);
  return run;
}

}  // namespace taps
