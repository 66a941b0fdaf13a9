// A pool of voices that play clips.
#pragma once

#include <array>
#include <cstddef>

#include "audio/clip/clip.h"

namespace sparsha::audio {

/// At most kSounding clips at full level; when one more starts, the quietest fades out within 5 ms, so that nothing
/// clicks. No allocation; one thread. Clips must outlive the player.
class ClipPlayer {
 public:
  static constexpr std::size_t kSounding = 32;

  explicit ClipPlayer(double sample_rate_hz);

  /// False when every voice is taken by sounds still fading (more than 64 strikes in 5 ms).
  bool start(const Clip& clip, double gain) noexcept;
  [[nodiscard]] bool sounding() const noexcept { return active_ > 0; }
  [[nodiscard]] std::size_t voices() const noexcept { return active_; }
  /// Adds `count` frames to the two channels.
  void render(double* left, double* right, std::size_t count) noexcept;

 private:
  struct Voice {
    const Clip* clip = nullptr;
    std::size_t at = 0;
    double gain = 0.0;
    bool fading = false;
    std::size_t faded = 0;  ///< frames since it began to fade
  };
  std::size_t fade_length_;
  std::size_t active_ = 0;
  std::array<Voice, 3 * kSounding> voices_{};
};

}  // namespace sparsha::audio
