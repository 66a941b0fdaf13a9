// The JACK server ends in the middle of a run: the sound goes on through the desktop's sound server.
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <thread>

#include "audio/engine.h"
#include "tests/audio/audio_scene.h"
#include "tests/audio/live/desktop_server.h"
#include "tests/audio/live/sound_server.h"

namespace {

using namespace sparsha;
using namespace sparsha::audio;

constexpr int kNoServer = 77;

bool jack_is_chosen() {
  for (const OutputDevice& device : output_devices())
    if (device.chosen) return device.system.find("JACK") != std::string::npos;
  return false;
}

/// What is struck once every 100 ms, in servo time as it passes.
class Run {
 public:
  Run() { engine_.start(); }
  template <class Condition>
  [[nodiscard]] bool until(const Condition& condition, int most_ms) {
    for (int i = 0; i < most_ms; ++i) {
      if (i % 100 == 0 && condition()) return true;
      ++now_.tick;
      now_.time_s = static_cast<double>(now_.tick) * 1e-3;
      if (i % 100 == 50) queue_->push(audio_scene::touch(now_.time_s, 0.5, 0.5, 1.0));
      state_.publish(now_);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return condition();
  }
  [[nodiscard]] Engine& engine() { return engine_; }

 private:
  std::shared_ptr<haptics::ContactQueue> queue_ = std::make_shared<haptics::ContactQueue>(256);
  haptics::Seqlock<haptics::State> state_;
  haptics::State now_;
  Engine engine_{audio_scene::scene({audio_scene::note("sa", {0, 0, 1, 1}, 2400.0, 0.02)}), queue_, state_, {}};
};

/// 0 when all is as it should be; the number of what is not.
int changes_servers(desktop_server::DesktopServer& desktop, sound_server::SoundServer& jack) {
  if (!desktop.running() || !jack.running()) return kNoServer;
  for (int i = 0; i < 40 && !jack_is_chosen(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(250));
  if (!jack_is_chosen()) return kNoServer;
  Run run;
  if (!run.until([&] { return run.engine().playing(); }, 10000)) return 1;
  const desktop_server::Listener listener;
  if (run.until([&] { return !listener.onsets().empty(); }, 1000)) return 2;  // JACK's sound goes elsewhere
  jack.end();
  if (!run.until([&] { return listener.onsets().size() > 3; }, 30000)) return 3;
  if (!run.engine().playing()) return 4;
  run.engine().stop();
  return 0;
}

[[noreturn]] void change_servers() {
  alarm(100);  // a program that hangs is a failure
  // Never freed: they outlive what the sound libraries do at the end.
  static auto* const desktop = new desktop_server::DesktopServer;
  static auto* const jack = new sound_server::SoundServer;
  const int code = changes_servers(*desktop, *jack);
  jack->end();
  desktop->end();
  if (code != 0) std::fprintf(stderr, "failed at %d\n", code);
  std::_Exit(code);
}

TEST(SoundServers, WhenJackEndsTheSoundGoesOnThroughTheDesktopsServer) {
  if (!find_program({"jackd"}) || !find_program({"pulseaudio"}) || !find_program({"parec"}))
    GTEST_SKIP() << "no two sound servers: jackd or pulseaudio is not installed";
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      change_servers(), [](int status) { return WIFEXITED(status) && WEXITSTATUS(status) == 0; }, "");
}

}  // namespace
