// A low-latency output stream of the sound device, when there is one.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sparsha::audio {

/// What can play, of all sound systems that PortAudio reaches.
struct OutputDevice {
  int number = 0;
  std::string name;
  std::string system;  ///< e.g. ALSA, JACK Audio Connection Kit
  int channels = 0;
  double rate_hz = 0.0;
  double latency_s = 0.0;  ///< the lowest that it promises
  bool chosen = false;     ///< when none is asked for
};
[[nodiscard]] std::vector<OutputDevice> output_devices();

/// Opening probes every sound system of the machine (milliseconds to a second): not for the main thread. Any call but
/// playing() and shut_out() waits for ever where a sound system does.
class LiveStream {
 public:
  /// Fills interleaved stereo, of which a device of one channel plays the mean; called from the sound system's thread,
  /// must not allocate, lock or throw.
  using Callback = std::function<void(std::span<float>)>;

  /// `device`: a number of output_devices(), or a part of one's name whatever its case; empty: a JACK server, then the
  /// default device. The library's chatter on stderr is silenced. Throws Error{device} with the reason when nothing can
  /// play, Error{usage} for a device that is none.
  explicit LiveStream(const std::string& device = {});
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
  /// From here on the device's thread stays out: what the callback uses may go.
  void shut_out() noexcept;
  /// Gives a device that went away back to its sound system. Of a JACK server nothing can be given back without waiting
  /// for ever: it is left behind, and no stream of this program chooses JACK again. Takes its time.
  void give_up() noexcept;
  /// False when the device went away (it has not asked for sound for 0.4 s).
  [[nodiscard]] bool playing() const noexcept;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::audio
