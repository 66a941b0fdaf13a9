// Where a scene sounds, and what: the regions of its `audio:` block with their notes and clips made ready.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "audio/clip.h"
#include "audio/modal.h"
#include "scene/scene.h"

namespace sparsha::audio {

/// One region; `box_m` is xmin ymin xmax ymax in the regions' frame (scene/regions.h); none = never struck.
struct SoundRegion {
  std::string name;
  std::optional<std::array<double, 4>> box_m;
  std::variant<PillarModes, std::shared_ptr<const Clip>> sound;  ///< regions may share a clip
};

/// Immutable once made; shared by every Synth of the same rate.
struct SoundBank {
  int sample_rate_hz = 48000;
  std::vector<SoundRegion> regions;
  double scrape_gain = 0.0;           ///< 0 = no friction sound
  std::vector<std::string> warnings;  ///< what was asked for and cannot sound

  /// Index of the first region that holds the place (regions' frame, metres); none when there is none. No allocation.
  [[nodiscard]] std::optional<std::size_t> region_at(double x_m, double y_m) const noexcept;
};

/// Loads clips and works out modes. A scene without `audio:` gives an empty bank. Throws Error{input} for clips that
/// cannot be read, Error{usage} for impossible notes.
[[nodiscard]] std::shared_ptr<const SoundBank> make_sound_bank(const pipeline::Scene& scene, int sample_rate_hz);

}  // namespace sparsha::audio
