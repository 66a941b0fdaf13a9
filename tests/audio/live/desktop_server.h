// The sound server of a desktop (PulseAudio) without a sound card, reached as ALSA's default device, and a program that
// records what it plays.
#pragma once

#include <unistd.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "audio/live/stream.h"
#include "audio/speech/child_process.h"
#include "base/error.h"
#include "tests/audio/taps.h"
#include "tests/support/test_folder.h"

namespace desktop_server {

using namespace sparsha;

inline constexpr double kRate_hz = 48000.0;

/// A server of our own with a null sink, and the environment in which PortAudio finds it and no other.
class DesktopServer {
 public:
  DesktopServer() {
    const auto program = audio::find_program({"pulseaudio"});
    if (!program || !audio::find_program({"parec"})) return;
    const std::string home = folder_.path().string();
    const std::string socket = (folder_ / "socket").string();
    std::ofstream(folder_ / "asound.conf") << "pcm.!default { type pulse }\nctl.!default { type pulse }\n";
    setenv("XDG_RUNTIME_DIR", home.c_str(), 1);
    setenv("PULSE_RUNTIME_PATH", home.c_str(), 1);
    setenv("HOME", home.c_str(), 1);
    setenv("PULSE_SERVER", ("unix:" + socket).c_str(), 1);
    // Read once: a second server in one program must not find the file of the first.
    static const char* const outside = std::getenv("ALSA_CONFIG_PATH");
    static const std::string files = outside != nullptr ? outside : "/usr/share/alsa/alsa.conf";
    setenv("ALSA_CONFIG_PATH", (files + ":" + (folder_ / "asound.conf").string()).c_str(), 1);
    setenv("JACK_NO_START_SERVER", "1", 1);
    setenv("JACK_DEFAULT_SERVER", "sparsha-test-none", 1);
    process_ = audio::ChildProcess::start(
        *program,
        {"-n", "--daemonize=no", "--exit-idle-time=-1", "--realtime=no", "--high-priority=no", "--use-pid-file=no",
         "-L", "module-null-sink sink_name=null rate=48000", "-L",
         "module-native-protocol-unix auth-anonymous=1 socket=" + socket},
        "");
    for (int i = 0; i < 40 && !ready_; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(250));
      try {
        ready_ = audio::LiveStream().name() == "default";
      } catch (const Error&) {
      }
    }
  }
  ~DesktopServer() { end(); }
  void end() {
    if (process_) process_->end(3000);
  }
  DesktopServer(const DesktopServer&) = delete;
  DesktopServer& operator=(const DesktopServer&) = delete;
  [[nodiscard]] bool running() { return ready_ && process_->running(); }

 private:
  test::TestFolder folder_;
  std::unique_ptr<audio::ChildProcess> process_;
  bool ready_ = false;
};

/// Records the null sink as `parec` gets it. What has arrived is due at the card within the sink's block, which the
/// recording holds at 2 ms: that is added, so that nothing is heard too soon.
class Listener {
 public:
  Listener() : onsets_(4096) {
    pipe_ = ::popen(
        "exec parec --raw --format=float32le --rate=48000 --channels=1 --latency-msec=2 -d null.monitor 2>/dev/null",
        "r");
    if (pipe_ == nullptr) return;
    connected_ = true;
    thread_ = std::thread([this] { listen(); });
  }
  ~Listener() {
    ending_ = true;
    if (thread_.joinable()) thread_.join();
    if (pipe_ != nullptr) ::pclose(pipe_);
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  [[nodiscard]] bool connected() const { return connected_; }
  [[nodiscard]] std::vector<taps::Onset> onsets() const {
    return {onsets_.begin(), onsets_.begin() + static_cast<std::ptrdiff_t>(count_.load(std::memory_order_acquire))};
  }

 private:
  static constexpr float kHeard = 1e-4F;
  static constexpr std::size_t kQuiet = 480;
  static constexpr double kBlock_s = 0.002;

  void listen() {
    std::array<float, 4096> samples{};
    const int file = ::fileno(pipe_);
    std::size_t partial = 0;  // bytes of a sample whose end is still to come
    while (!ending_) {
      auto* const bytes = reinterpret_cast<char*>(samples.data());
      const ssize_t got = ::read(file, bytes + partial, sizeof samples - partial);
      if (got <= 0) return;
      const auto now = taps::Clock::now();
      const std::size_t size = partial + static_cast<std::size_t>(got);
      hear(samples.data(), size / sizeof(float), now);
      partial = size % sizeof(float);
      std::memmove(bytes, bytes + size - partial, partial);
    }
  }
  void hear(const float* samples, std::size_t count, taps::Clock::time_point now) {
    for (std::size_t i = 0; i < count; ++i) {
      if (std::abs(samples[i]) < kHeard) {
        ++quiet_;
        continue;
      }
      if (const std::size_t at = count_.load(std::memory_order_relaxed); quiet_ >= kQuiet && at < onsets_.size()) {
        onsets_[at].when = now + std::chrono::duration_cast<taps::Clock::duration>(
                                     std::chrono::duration<double>(kBlock_s + static_cast<double>(i) / kRate_hz));
        count_.store(at + 1, std::memory_order_release);
      }
      quiet_ = 0;
    }
  }

  FILE* pipe_ = nullptr;
  bool connected_ = false;
  std::thread thread_;
  std::atomic<bool> ending_{false};
  std::size_t quiet_ = kQuiet;
  std::vector<taps::Onset> onsets_;
  std::atomic<std::size_t> count_{0};
};

}  // namespace desktop_server
