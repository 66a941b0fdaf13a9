// From a hand that taps, through the real servo, engine, PortAudio and sound server, to another client of that server
// that hears the first sample: how late, how many, and whether words in between change anything.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "audio/engine.h"
#include "audio/speech/speech.h"
#include "audio_scene.h"
#include "sound_server.h"
#include "tests/support/servo_parts.h"

#if __has_include(<jack/jack.h>)

namespace {

using namespace sparsha;
using sound_server::Clock;

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

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
  /// The machine gave the server and the servo their processors when they were due.
  [[nodiscard]] bool machine_in_time() const { return server_late_p90_s < 0.0015 && ticks_in_time > 0.95; }
};

class TouchToSoundLive : public testing::Test {
 protected:
  void SetUp() override {
    if (!server_.running()) GTEST_SKIP() << "no sound server: jackd is not installed or does not start";
  }

  /// Taps; while `speaks`, words are begun, played and cut short all the time.
  [[nodiscard]] Heard taps(int count, bool speaks) {
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
    const sound_server::Listener listener;
    EXPECT_TRUE(listener.connected());
    // The words are silent until their last sample, which newer ones never let them reach: what is heard is the taps.
    audio::SpeechOptions options;
    options.play = [&](std::vector<float> words, double rate_hz) {
      std::fill(words.begin(), words.end(), 0.0F);
      words.resize(std::max<std::size_t>(words.size(), static_cast<std::size_t>(20.0 * rate_hz)));
      words.back() = 1.0F;
      return engine.speak(words, rate_hz);
    };
    const auto speech = speaks ? std::make_unique<audio::Speech>(options) : nullptr;
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const int first = static_cast<int>(seconds(Clock::now() - hand.begin) / Tapping::kPeriod_s) + 2;
    std::uint64_t said = 0;
    while (Clock::now() < hand.tap(first + count) - std::chrono::milliseconds(20)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(70));
      if (!speaks) continue;
      if (++said % 4 == 0) {
        haptics::Announcement words;
        words.sequence = said;
        words.text = "Lotus medallion, twelve centimetres, two o'clock";
        speech->say(words);
      } else if (said % 4 == 2) {
        std::vector<float> own(320000, 0.0F);
        own.back() = 1.0F;
        static_cast<void>(engine.speak(own, 16000.0));
      }
    }
    servo.stop();
    return judge(hand, listener.onsets(), first, count, servo.figures());
  }

  static Heard judge(const Tapping& hand, const std::vector<sound_server::Listener::Onset>& onsets, int first,
                     int count, const haptics::ServoFigures& figures) {
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

  sound_server::SoundServer server_;
};

/// Times are judged at night, a thousand taps of them; else that every tap is heard, once and not too soon.
bool at_night() { return std::getenv("SPARSHA_NIGHTLY") != nullptr; }

TEST_F(TouchToSoundLive, ATapIsHeardByAnotherClientWithin10MillisecondsNeverBeforeItOnceEach) {
  double last_p90_s = 0.0;
  for (int attempt = 0; attempt < 4; ++attempt) {
    const Heard run = taps(at_night() ? 1000 : 40, false);
    EXPECT_EQ(run.too_soon, 0);
    if (run.machine_in_time() || attempt == 3) {
      EXPECT_EQ(run.doubled, 0);
      EXPECT_EQ(run.lost, 0);
    }
    last_p90_s = run.p90_s();
    if (last_p90_s <= 0.010 || (!at_night() && run.machine_in_time())) return;
    if (at_night()) {
      ASSERT_FALSE(run.machine_in_time()) << "p90 " << 1e3 * last_p90_s << " ms";
    }
  }
  GTEST_SKIP() << "the machine keeps neither servo nor server in time: p90 " << 1e3 * last_p90_s << " ms";
}

TEST_F(TouchToSoundLive, WordsDelayNeitherAStrikeNorTheServo) {
  // Side by side, more than once: what the machine does in between concerns both.
  double quiet_s = HUGE_VAL, spoken_s = HUGE_VAL, quiet_ns = HUGE_VAL, spoken_ns = HUGE_VAL;
  for (int round = 0; round < (at_night() ? 3 : 1); ++round) {
    const Heard quiet = taps(20, false);
    const Heard spoken = taps(20, true);
    EXPECT_EQ(quiet.too_soon + spoken.too_soon, 0);
    EXPECT_EQ(spoken.doubled, 0);
    if (spoken.machine_in_time()) {
      EXPECT_EQ(spoken.lost, 0) << "softer by 12 dB, but heard";
    }
    quiet_s = std::min(quiet_s, quiet.p90_s());
    spoken_s = std::min(spoken_s, spoken.p90_s());
    quiet_ns = std::min(quiet_ns, quiet.tick_ns_p50);
    spoken_ns = std::min(spoken_ns, spoken.tick_ns_p50);
  }
  if (!at_night()) return;
  EXPECT_LT(spoken_s, quiet_s + 128.0 / 48000.0) << "less than a cycle of the server";
  EXPECT_LT(spoken_ns, 2.0 * quiet_ns) << "a tick";
}

}  // namespace

#endif
