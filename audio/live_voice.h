// What the sound card's callback does: newest state and events in, frames out. No allocation, no locks.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>

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

  /// Callback thread only. Events sound at the start of this block: as soon as possible.
  void render(std::span<float> interleaved) noexcept;
  /// Any other thread: fades to silence within 20 ms and waits for it (100 ms at most).
  void fade_out() noexcept;

 private:
  void listen(std::size_t frames) noexcept;

  Synth synth_;
  haptics::ContactQueue& contacts_;
  const haptics::Seqlock<haptics::State>& state_;
  haptics::ContactQueue* forward_;
  std::atomic<std::uint64_t>& strikes_;
  haptics::State last_;
  std::size_t silent_frames_ = 0;  ///< since the servo's last tick
  float fade_ = 1.0F;
  std::atomic<bool> ending_{false};
  std::atomic<bool> ended_{false};
};

}  // namespace sparsha::audio
