// A low-latency stereo output stream of the sound device, when there is one.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

namespace sparsha::audio {

/// Opening probes every sound system of the machine (milliseconds to a second): not for the main thread.
class LiveStream {
 public:
  /// Fills interleaved stereo; called from the sound system's thread, must not allocate, lock or throw.
  using Callback = std::function<void(std::span<float>)>;

  /// Prefers a JACK server, then the default device. The library's chatter on stderr is silenced. Throws Error{device}
  /// with the reason when nothing can play.
  LiveStream();
  ~LiveStream();
  LiveStream(const LiveStream&) = delete;
  LiveStream& operator=(const LiveStream&) = delete;

  [[nodiscard]] int sample_rate_hz() const;
  [[nodiscard]] std::string name() const;

  /// Starts the stream primed with silence. Throws Error{device}.
  void start(Callback callback);
  /// Plays what is buffered and ends. The stream of a device that went away is left behind; only playing() and this
  /// function may be called then.
  void stop() noexcept;
  /// False when the device went away (it has not asked for sound for 0.4 s).
  [[nodiscard]] bool playing() const noexcept;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::audio
