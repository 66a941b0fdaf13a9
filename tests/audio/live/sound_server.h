// A real sound server without a sound card (JACK's dummy driver), and a client of it that listens to what it plays.
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#if __has_include(<jack/jack.h>)
#include <jack/jack.h>
#endif

#include "audio/live/stream.h"
#include "audio/speech/child_process.h"
#include "base/error.h"
#include "base/system/library.h"
#include "tests/audio/taps.h"

namespace sound_server {

using namespace sparsha;
using Clock = std::chrono::steady_clock;

inline constexpr const char* kMissing = "no sound server: jackd is not installed";
inline constexpr const char* kSilent = "jackd is installed, but does not start";

/// One of four names for a server, which no other test has while this lives. JACK lists at most eight servers and takes
/// one that was killed off its list only when another of its name starts: names that are new each time fill the list.
class ServerName {
 public:
  ServerName() {
    for (int k = 1; k <= 4 && lock_ < 0; ++k) {
      name_ = "sparsha-test-" + std::to_string(k);
      const auto file = std::filesystem::temp_directory_path() / (name_ + ".lock");
      lock_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
      if (lock_ < 0 || ::flock(lock_, LOCK_EX | LOCK_NB) == 0) continue;
      ::close(lock_);
      lock_ = -1;
    }
  }
  ~ServerName() {
    if (lock_ >= 0) ::close(lock_);
  }
  ServerName(const ServerName&) = delete;
  ServerName& operator=(const ServerName&) = delete;
  [[nodiscard]] const std::string& text() const { return name_; }

 private:
  std::string name_;
  int lock_ = -1;
};

/// A JACK server of our own, whose cycles have 128 frames at 48 kHz.
class SoundServer {
 public:
  /// `channels`: of its sound card.
  explicit SoundServer(int channels = 2) {
    const auto program = audio::find_program({"jackd"});
    installed_ = program.has_value();
    if (!installed_) return;
    setenv("JACK_DEFAULT_SERVER", name_.text().c_str(), 1);
    setenv("JACK_NO_AUDIO_RESERVATION", "1", 1);
    process_ = audio::ChildProcess::start(*program,
                                          {"--no-realtime", "--name", name_.text(), "-d", "dummy", "-r", "48000", "-p",
                                           "128", "-P", std::to_string(channels)},
                                          "");
    for (int i = 0; i < 120 && !ready_ && process_->running(); ++i) {  // a busy machine takes its time to start it
      std::this_thread::sleep_for(std::chrono::milliseconds(250));
      ready_ = reached();
    }
  }
  ~SoundServer() {
    freeze(false);
    end();
    unsetenv("JACK_DEFAULT_SERVER");
  }
  SoundServer(const SoundServer&) = delete;
  SoundServer& operator=(const SoundServer&) = delete;
  /// Where it is not, tests are skipped; where it is and does not run, they fail.
  [[nodiscard]] bool installed() const { return installed_; }
  [[nodiscard]] bool running() { return ready_ && process_->running(); }
  /// Lets it tidy up its shared memory.
  void end() {
    if (process_) process_->end(3000);
  }
  /// From now on it answers nothing, as a server that hangs; or goes on.
  void freeze(bool still) {
    if (process_ && process_->process_id() > 0) ::kill(process_->process_id(), still ? SIGSTOP : SIGCONT);
  }

 private:
  [[nodiscard]] static bool reached() {
    try {
      const auto devices = audio::output_devices();
      return std::any_of(devices.begin(), devices.end(), [](const audio::OutputDevice& device) {
        return device.system.find("JACK") != std::string::npos;
      });
    } catch (const Error&) {
      return false;
    }
  }

  ServerName name_;
  std::unique_ptr<audio::ChildProcess> process_;
  bool installed_ = false;
  bool ready_ = false;
};

#if __has_include(<jack/jack.h>)

/// Hears the first channel of the program's stream, as the server hands it on to the sound card. Its functions are
/// found by name in the library that the program's stream has loaded.
class Listener {
 public:
  using Onset = taps::Onset;  ///< a sample leaves the server one cycle after the one that it is made in

  Listener() {
    client_ = call<decltype(&jack_client_open)>("jack_client_open")("listener", JackNoStartServer, nullptr);
    if (client_ == nullptr) return;
    port_ = call<decltype(&jack_port_register)>("jack_port_register")(client_, "in", JACK_DEFAULT_AUDIO_TYPE,
                                                                      JackPortIsInput, 0);
    onsets_.resize(4096);
    last_frame_time_ = call<decltype(&jack_last_frame_time)>("jack_last_frame_time");
    frames_to_time_ = call<decltype(&jack_frames_to_time)>("jack_frames_to_time");
    get_time_ = call<decltype(&jack_get_time)>("jack_get_time");
    get_buffer_ = call<decltype(&jack_port_get_buffer)>("jack_port_get_buffer");
    call<decltype(&jack_set_process_callback)>("jack_set_process_callback")(client_, &process, this);
    if (call<decltype(&jack_activate)>("jack_activate")(client_) != 0) return;
    const char** const ports =
        call<decltype(&jack_get_ports)>("jack_get_ports")(client_, nullptr, JACK_DEFAULT_AUDIO_TYPE, JackPortIsOutput);
    for (std::size_t k = 0; ports != nullptr && ports[k] != nullptr && !connected_; ++k) {
      const std::string name = ports[k];
      if (name.rfind("system:", 0) == 0) continue;
      connected_ = call<decltype(&jack_connect)>("jack_connect")(
                       client_, ports[k], call<decltype(&jack_port_name)>("jack_port_name")(port_)) == 0;
    }
    if (ports != nullptr) call<decltype(&jack_free)>("jack_free")(ports);
  }
  ~Listener() {
    if (client_ != nullptr) call<decltype(&jack_client_close)>("jack_client_close")(client_);
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  [[nodiscard]] bool connected() const { return connected_; }
  /// So far. Sounds between which `kQuiet` frames are below kHeard.
  [[nodiscard]] std::vector<Onset> onsets() const {
    const std::size_t count = count_.load(std::memory_order_acquire);
    return {onsets_.begin(), onsets_.begin() + static_cast<std::ptrdiff_t>(count)};
  }

 private:
  static constexpr float kHeard = 1e-4F;
  static constexpr std::size_t kQuiet = 480;

  template <class Function>
  static Function call(const char* name) {
    return reinterpret_cast<Function>(system::find_symbol(name));
  }
  static int process(jack_nframes_t frames, void* listener) {
    static_cast<Listener*>(listener)->hear(frames);
    return 0;
  }
  void hear(jack_nframes_t frames) {
    const auto* const samples = static_cast<const float*>(get_buffer_(port_, frames));
    // This cycle's and the next one's beginning, microseconds; the server's clock beside ours.
    const jack_nframes_t first = last_frame_time_(client_);
    const auto begin_us = static_cast<double>(frames_to_time_(client_, first));
    const auto next_us = static_cast<double>(frames_to_time_(client_, first + frames));
    const auto now_us = static_cast<double>(get_time_());
    const Clock::time_point now = Clock::now();
    for (jack_nframes_t i = 0; i < frames; ++i) {
      if (std::abs(samples[i]) < kHeard) {
        ++quiet_;
        continue;
      }
      if (quiet_ >= kQuiet) {
        const double leaves_us = std::max(next_us, now_us) + 1e6 * static_cast<double>(i) / 48000.0;
        const std::size_t at = count_.load(std::memory_order_relaxed);
        if (at < onsets_.size()) {
          onsets_[at].when = now + std::chrono::duration_cast<Clock::duration>(
                                       std::chrono::duration<double, std::micro>(leaves_us - now_us));
          onsets_[at].late_s = std::max(0.0, 1e-6 * (now_us - begin_us));
          count_.store(at + 1, std::memory_order_release);
        }
      }
      quiet_ = 0;
    }
  }

  jack_client_t* client_ = nullptr;
  jack_port_t* port_ = nullptr;
  decltype(&jack_last_frame_time) last_frame_time_ = nullptr;
  decltype(&jack_frames_to_time) frames_to_time_ = nullptr;
  decltype(&jack_get_time) get_time_ = nullptr;
  decltype(&jack_port_get_buffer) get_buffer_ = nullptr;
  bool connected_ = false;
  std::size_t quiet_ = kQuiet;  // the server's thread
  std::vector<Onset> onsets_;
  std::atomic<std::size_t> count_{0};
};

#endif

}  // namespace sound_server
