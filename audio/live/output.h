// The live stream of an engine. It is opened, watched and ended on a thread of its own, since any call of a sound
// system may wait for ever: the run, its file and the program's end go on without it.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "audio/live/voice.h"
#include "audio/scrape/profile.h"

namespace sparsha::audio {

class LiveOutput {
 public:
  /// Makes the voice of a stream of this rate; called from the output's thread. May be called, and hold what it has
  /// captured, after stop() where a sound system hangs.
  using MakeVoice = std::function<std::unique_ptr<LiveVoice>(int sample_rate_hz)>;

  /// `device` as LiveStream takes it.
  LiveOutput(std::string device, MakeVoice make_voice);
  /// Ends it as stop() does.
  ~LiveOutput();
  LiveOutput(const LiveOutput&) = delete;
  LiveOutput& operator=(const LiveOutput&) = delete;

  /// Returns at once. A device that is not there, or goes away, is looked for every 3 s.
  void start();
  /// To be called every few milliseconds by one thread. True while the sound card's thread takes the contact events:
  /// then nobody else may. `newest`: the profile that a stream begins with; may be null.
  [[nodiscard]] bool tend(const std::shared_ptr<const Profile>& newest);
  /// What the needle reads from now on. The thread that calls tend().
  void profile(const std::shared_ptr<const Profile>& profile);
  /// After the last tend(): fades, and ends the stream. A sound system that does not answer within kPatience_s is left
  /// behind; nothing of the voice's is used after this in either case.
  void stop();

  /// See Engine::speak().
  bool speak(const std::vector<float>& words, double rate_hz);
  /// Why there is no live sound; empty once it plays.
  [[nodiscard]] std::string warning() const;
  [[nodiscard]] bool playing() const;

  static constexpr double kPatience_s = 2.0;

 private:
  struct Shared;
  static void run(Shared& shared);

  std::shared_ptr<Shared> shared_;  ///< with the thread
  std::thread thread_;
};

}  // namespace sparsha::audio
