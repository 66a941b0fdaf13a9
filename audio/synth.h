// The sound of a hand on a scene, block by block: the one deterministic core behind every sink.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "audio/clip/player.h"
#include "audio/earcons.h"
#include "audio/levels.h"
#include "audio/limiter.h"
#include "audio/scrape/needle.h"
#include "audio/sound_bank.h"
#include "audio/strike_gate.h"
#include "haptics/state/state.h"

namespace sparsha::audio {

/// Largest sample that leaves a Synth, -1.5 dB full scale; half a dB is left for peaks between samples.
inline constexpr double kCeiling = 0.84139514164519502;

/// Events carry the frame at which they sound; frames that have passed mean "now". Same events, same bytes, however the
/// time is cut into blocks. After construction nothing allocates, locks or throws. One thread.
class Synth {
 public:
  explicit Synth(std::shared_ptr<const SoundBank> bank);

  /// Strikes what StrikeGate makes of the event. True when something sounds.
  bool contact(const haptics::ContactEvent& event, std::uint64_t frame) noexcept;
  /// False when the event queue is full (counted).
  bool strike(const Strike& strike, std::uint64_t frame) noexcept;
  /// The hand as it is at `frame`: where it strokes, what it has come to, and whether it slides onto a region that
  /// sounds; true when it does. States come in order of frames.
  bool state(const haptics::State& state, std::uint64_t frame) noexcept;
  /// The heights under the hand from `frame` on. Whoever gives them keeps a share of them, so that none is freed here.
  void profile(std::shared_ptr<const Profile> profile, std::uint64_t frame) noexcept;
  /// The hand is in the air, or gone, from `frame` on.
  void lift(std::uint64_t frame) noexcept {
    needle_.move({.frame = frame});
    earcons_.leave(frame);
  }

  /// Interleaved stereo, floats of at most kCeiling, latency_frames() after their events.
  void render(std::span<float> interleaved) noexcept;

  /// Frames rendered so far, latency included.
  [[nodiscard]] std::uint64_t frame() const noexcept { return frame_; }
  [[nodiscard]] static constexpr std::size_t latency_frames() noexcept { return Limiter::kDelay; }
  [[nodiscard]] int sample_rate_hz() const noexcept { return bank_->sample_rate_hz; }
  /// False once everything has died away and no event waits: what follows is exact zeros.
  [[nodiscard]] bool sounding() const noexcept;
  /// Strikes that could not be voiced, because more came at once than hands can make.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  struct Event {
    std::uint64_t frame = 0;
    Strike strike;
  };
  static constexpr std::size_t kBlock = 64;
  static constexpr std::size_t kMostEvents = 512;
  static constexpr std::size_t kMostBanks = 48;

  bool schedule(const Event& event) noexcept;
  void begin(const Event& event) noexcept;
  void limit_banks() noexcept;
  void render_block(float* out, std::size_t count) noexcept;

  std::shared_ptr<const SoundBank> bank_;
  std::vector<ModalBank> pillars_;      ///< one per region; empty for clips
  std::vector<std::uint32_t> ringing_;  ///< regions whose modes sound; capacity reserved
  ClipPlayer clips_;
  Needle needle_;
  Earcons earcons_;
  Limiter limiter_;
  std::uint64_t frame_ = 0;
  std::uint64_t last_sound_ = 0;  ///< frame before which something was not zero
  std::uint64_t dropped_ = 0;
  std::array<Event, kMostEvents> events_{};  ///< sorted by frame, stable
  std::size_t event_count_ = 0;
  StrikeGate gate_;
};

}  // namespace sparsha::audio
