// PortAudio behind LiveStream.
#include "audio/live/stream.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>

#include <portaudio.h>

#include "base/error.h"
#include "base/system/library.h"
#include "base/text/lower_case.h"

namespace sparsha::audio {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kWishedRate_hz = 48000;
constexpr std::size_t kMixedFrames = 512;  // at once
/// A device that has not asked for sound for so long is gone (buffers are a tenth of it).
constexpr auto kGone = std::chrono::milliseconds(400);

/// PortAudio's calls are not for several threads at once. One that waits for ever for a sound system that hangs keeps
/// it.
std::mutex& portaudio() {
  static std::mutex mutex;
  return mutex;
}

void ignore_alsa(const char*, int, const char*, int, const char*, ...) {}
void ignore_jack(const char*) {}

/// ALSA and JACK, which PortAudio loads, talk to stderr while they look for devices. Their error handlers are reached
/// by name, so that neither is a dependency of ours.
void silence_sound_systems() {
  using AlsaHandler = void (*)(const char*, int, const char*, int, const char*, ...);
  using SetAlsaHandler = int (*)(AlsaHandler);
  using SetJackHandler = void (*)(void (*)(const char*));
  if (auto* set = reinterpret_cast<SetAlsaHandler>(system::find_symbol("snd_lib_error_set_handler"))) set(&ignore_alsa);
  for (const char* name : {"jack_set_error_function", "jack_set_info_function"})
    if (auto* set = reinterpret_cast<SetJackHandler>(system::find_symbol(name))) set(&ignore_jack);
}

Error device_error(const std::string& what) {
  return Error(ErrorKind::device, {}, "no sound: " + what, "a sound device; --audio-out writes the sound to a file");
}

/// The JACK server has ended. Its library never forgets that: from then on this program has no JACK.
std::atomic<bool>& jack_ended() {
  static std::atomic<bool> ended{false};
  return ended;
}

bool is_jack(const PaDeviceInfo& info) { return Pa_GetHostApiInfo(info.hostApi)->type == paJACK; }

PaDeviceIndex choose_device() {
  const PaHostApiIndex jack = Pa_HostApiTypeIdToHostApiIndex(paJACK);
  if (jack >= 0 && !jack_ended()) {
    const PaDeviceIndex device = Pa_GetHostApiInfo(jack)->defaultOutputDevice;
    if (device != paNoDevice) return device;
  }
  const PaDeviceIndex device = Pa_GetDefaultOutputDevice();
  return device != paNoDevice && jack_ended() && is_jack(*Pa_GetDeviceInfo(device)) ? paNoDevice : device;
}

/// PortAudio's devices while this object exists.
class Library {
 public:
  Library() {
    const std::lock_guard lock(portaudio());
    silence_sound_systems();
    const PaError started = Pa_Initialize();
    if (started != paNoError) throw device_error(Pa_GetErrorText(started));
  }
  ~Library() {
    const std::lock_guard lock(portaudio());
    Pa_Terminate();
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
};

std::vector<OutputDevice> list_devices() {
  std::vector<OutputDevice> devices;
  const PaDeviceIndex chosen = choose_device();
  for (PaDeviceIndex k = 0; k < Pa_GetDeviceCount(); ++k) {
    const PaDeviceInfo& info = *Pa_GetDeviceInfo(k);
    if (info.maxOutputChannels < 1 || (jack_ended() && is_jack(info))) continue;
    devices.push_back({k, info.name, Pa_GetHostApiInfo(info.hostApi)->name, info.maxOutputChannels,
                       info.defaultSampleRate, info.defaultLowOutputLatency, k == chosen});
  }
  return devices;
}

PaDeviceIndex find_device(const std::string& wanted) {
  if (wanted.empty()) return choose_device();
  const std::vector<OutputDevice> devices = list_devices();
  for (const OutputDevice& device : devices)
    if (std::to_string(device.number) == wanted) return device.number;
  for (const OutputDevice& device : devices)
    if (lower_case(device.name).find(lower_case(wanted)) != std::string::npos) return device.number;
  throw usage_error("there is no sound device '" + wanted + "'", "a number or a name that --list-audio shows");
}

}  // namespace

std::vector<OutputDevice> output_devices() {
  const Library library;
  return list_devices();
}

struct LiveStream::Implementation {
  Library library;
  PaStream* stream = nullptr;
  bool plays_on_jack = false;
  int channels = 2;
  std::array<float, 2 * kMixedFrames> both{};  ///< of a device of one channel
  double rate_hz = kWishedRate_hz;
  std::string name;
  Callback callback;
  std::atomic<Clock::rep> asked{0};  ///< when the device last asked for sound
  enum class Gate { open, inside, closed };
  std::atomic<Gate> gate{Gate::open};  ///< whether the device's thread may come in, or is in

  [[nodiscard]] Clock::duration silence() const {
    return Clock::now().time_since_epoch() - Clock::duration(asked.load(std::memory_order_relaxed));
  }

  ~Implementation() {
    const std::lock_guard lock(portaudio());
    if (stream != nullptr) Pa_CloseStream(stream);
  }

  /// The mean of both channels, so that it is no louder than they are.
  void fill_mono(std::span<float> out) {
    while (!out.empty()) {
      const std::size_t frames = std::min(out.size(), kMixedFrames);
      callback(std::span(both).first(2 * frames));
      for (std::size_t i = 0; i < frames; ++i) out[i] = 0.5F * (both[2 * i] + both[2 * i + 1]);
      out = out.subspan(frames);
    }
  }

  static int fill(const void*, void* output, unsigned long frames, const PaStreamCallbackTimeInfo*,
                  PaStreamCallbackFlags, void* self) {
    auto& stream = *static_cast<Implementation*>(self);
    const std::span<float> out(static_cast<float*>(output),
                               static_cast<std::size_t>(stream.channels) * static_cast<std::size_t>(frames));
    Gate open = Gate::open;
    if (!stream.gate.compare_exchange_strong(open, Gate::inside, std::memory_order_acquire)) {
      std::fill(out.begin(), out.end(), 0.0F);
      return paContinue;
    }
    stream.asked.store(Clock::now().time_since_epoch().count(), std::memory_order_relaxed);
    if (stream.channels == 2)
      stream.callback(out);
    else
      stream.fill_mono(out);
    stream.gate.store(Gate::open, std::memory_order_release);
    return paContinue;
  }
};

LiveStream::LiveStream(const std::string& wanted) : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  const std::lock_guard lock(portaudio());
  const PaDeviceIndex device = find_device(wanted);
  if (device == paNoDevice) throw device_error("this machine has no sound device");
  const PaDeviceInfo& info = *Pa_GetDeviceInfo(device);
  self.name = info.name;
  self.plays_on_jack = is_jack(info);
  PaStreamParameters output{};
  output.device = device;
  self.channels = std::min(2, info.maxOutputChannels);
  output.channelCount = self.channels;
  output.sampleFormat = paFloat32;
  PaError status = paNoError;
  // The wished rate first, at the lowest latency; then what the device likes.
  for (const double rate : {static_cast<double>(kWishedRate_hz), std::round(info.defaultSampleRate)}) {
    for (const double latency : {info.defaultLowOutputLatency, info.defaultHighOutputLatency}) {
      output.suggestedLatency = latency;
      self.stream = nullptr;
      status = Pa_OpenStream(&self.stream, nullptr, &output, rate, paFramesPerBufferUnspecified, paNoFlag,
                             &Implementation::fill, &self);
      if (status == paNoError) {
        self.rate_hz = rate;
        return;
      }
    }
  }
  self.stream = nullptr;
  throw device_error("'" + self.name + "': " + Pa_GetErrorText(status));
}

LiveStream::~LiveStream() { stop(); }

int LiveStream::sample_rate_hz() const { return static_cast<int>(implementation_->rate_hz); }

std::string LiveStream::name() const { return implementation_->name; }

void LiveStream::start(Callback callback) {
  implementation_->callback = std::move(callback);
  implementation_->asked.store(Clock::now().time_since_epoch().count());
  const PaError status = [this] {
    const std::lock_guard lock(portaudio());
    return Pa_StartStream(implementation_->stream);
  }();
  if (status != paNoError) throw device_error("'" + implementation_->name + "': " + Pa_GetErrorText(status));
}

void LiveStream::stop() noexcept {
  if (!implementation_ || implementation_->stream == nullptr || Pa_IsStreamStopped(implementation_->stream) != 0)
    return;
  // A pause is either the device's buffer or its end; look until it is clear which.
  const Clock::duration before = implementation_->silence();
  while (implementation_->silence() >= before && implementation_->silence() < kGone)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const bool alive = implementation_->silence() < kGone;
  shut_out();
  if (alive) {
    const std::lock_guard lock(portaudio());
    Pa_StopStream(implementation_->stream);
  } else {
    // Stopping or closing the stream of a sound server that has ended waits for ever: leave it alone, and its memory
    // with it.
    (void)implementation_.release();
  }
}

void LiveStream::shut_out() noexcept {
  using Gate = Implementation::Gate;
  if (!implementation_ || implementation_->gate.load(std::memory_order_acquire) == Gate::closed) return;
  for (Gate open = Gate::open;
       !implementation_->gate.compare_exchange_weak(open, Gate::closed, std::memory_order_acq_rel); open = Gate::open)
    std::this_thread::yield();
}

void LiveStream::give_up() noexcept {
  if (!implementation_) return;
  if (implementation_->plays_on_jack) {
    jack_ended() = true;
    (void)implementation_.release();
    return;
  }
  {
    const std::lock_guard lock(portaudio());
    Pa_AbortStream(implementation_->stream);
  }
  implementation_.reset();
}

bool LiveStream::playing() const noexcept {
  return implementation_ && Pa_IsStreamActive(implementation_->stream) == 1 && implementation_->silence() < kGone;
}

}  // namespace sparsha::audio
