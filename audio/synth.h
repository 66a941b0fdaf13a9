// The sound of a hand on a scene, block by block: the one deterministic core behind every sink.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "audio/clip_player.h"
#include "audio/limiter.h"
#include "audio/scrape.h"
#include "audio/sound_bank.h"
#include "audio/strike_gate.h"
#include "haptics/state/state.h"

namespace sparsha::audio {

/// Largest sample that leaves a Synth, -1.5 dB full scale; half a dB is left for peaks between samples.
inline constexpr double kCeiling = 0.84139514164519502;

/// Amplitude of a strike relative to one of 1 N: force^0.7 (0 to 8 N span a comfortable 40 dB), growing up to 20 N.
[[nodiscard]] double strike_level(double force_n);

/// The friction sound's input from a state: 0 when nothing slides or the servo is in a fault.
[[nodiscard]] ScrapeInput scrape_input(const haptics::State& state);

/// Events carry the frame at which they sound; frames that have passed mean "now". Same events, same bytes, however the
/// time is cut into blocks. After construction nothing allocates, locks or throws. One thread.
class Synth {
 public:
  explicit Synth(std::shared_ptr<const SoundBank> bank);

  /// Strikes what StrikeGate makes of the event. True when something sounds.
  bool contact(const haptics::ContactEvent& event, std::uint64_t frame) noexcept;
  /// False when the event queue is full (counted).
  bool strike(const Strike& strike, std::uint64_t frame) noexcept;
  void scrape(const ScrapeInput& input, std::uint64_t frame) noexcept;

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
    enum class Kind { strike, scrape };
    Kind kind = Kind::strike;
    std::uint64_t frame = 0;
    Strike strike;
    ScrapeInput input;
  };
  static constexpr std::size_t kBlock = 64;
  static constexpr std::size_t kMostEvents = 512;
  static constexpr std::size_t kMostBanks = 48;

  bool schedule(const Event& event) noexcept;
  void begin(const Event& event) noexcept;
  void limit_banks() noexcept;
  void render_block(float* out, std::size_t count) noexcept;

  std::shared_ptr<const SoundBank> bank_;
  std::vector<ModalBank> pillars_;      ///< one a region; empty for clips
  std::vector<std::uint32_t> ringing_;  ///< regions whose pillar sounds; capacity reserved
  ClipPlayer clips_;
  Scrape scrape_;
  Limiter limiter_;
  std::uint64_t frame_ = 0;
  std::uint64_t last_sound_ = 0;  ///< frame before which something was not zero
  std::uint64_t dropped_ = 0;
  std::array<Event, kMostEvents> events_{};  ///< sorted by frame, stable
  std::size_t event_count_ = 0;
  StrikeGate gate_;
};

}  // namespace sparsha::audio
