// What the sound card's callback does: newest state and events in, frames out. No allocation, no locks.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>

#include "audio/clip/clip.h"
#include "audio/synth.h"
#include "haptics/state/seqlock.h"
#include "haptics/state/spsc_queue.h"

namespace sparsha::audio {

class LiveVoice {
 public:
  /// References must outlive it; `forward` (may be null) gets every event on; `strikes` counts what sounds.
  LiveVoice(std::shared_ptr<const SoundBank> bank, haptics::ContactQueue& contacts,
            const haptics::Seqlock<haptics::State>& state, haptics::ContactQueue* forward,
            std::atomic<std::uint64_t>& strikes);
  /// What the needle reads from now on. One other thread, which keeps a share of it. False when too many wait.
  bool profile(std::shared_ptr<const Profile> profile) noexcept { return profiles_.push(std::move(profile)); }

  /// Words (stereo, at the stream's rate) over all other sounds, which become 12 dB softer meanwhile; null ends them.
  /// One other thread, which keeps a share of them. False when too many wait.
  bool speak(std::shared_ptr<const Clip> words) noexcept { return words_.push(std::move(words)); }

  /// Callback thread only. Events sound at the start of this block: as soon as possible.
  void render(std::span<float> interleaved) noexcept;
  /// Any other thread: fades to silence within 20 ms and waits for it (100 ms at most).
  void fade_out() noexcept;

 private:
  void listen(std::size_t frames) noexcept;
  [[nodiscard]] std::uint64_t frame_of(double time_s, std::size_t block) noexcept;

  Synth synth_;
  haptics::ContactQueue& contacts_;
  const haptics::Seqlock<haptics::State>& state_;
  haptics::ContactQueue* forward_;
  std::atomic<std::uint64_t>& strikes_;
  haptics::SpscQueue<std::shared_ptr<const Profile>> profiles_{8};
  void add_speech(std::span<float> interleaved) noexcept;

  haptics::SpscQueue<std::shared_ptr<const Clip>> words_{8};
  std::shared_ptr<const Clip> next_words_, spoken_;
  bool newer_words_ = false;
  std::size_t spoken_frames_ = 0;
  float duck_ = 1.0F;         ///< of all but speech
  float speech_gain_ = 0.0F;  ///< fades when words are cut short
  haptics::State last_;
  bool has_clock_ = false;
  double clock_frames_ = 0.0;      ///< frame of servo time 0
  std::size_t silent_frames_ = 0;  ///< since the servo's last tick
  float fade_ = 1.0F;
  std::atomic<bool> ending_{false};
  std::atomic<bool> ended_{false};
};

}  // namespace sparsha::audio
