// Where a scene sounds, and what: the regions of its `audio:` block with their notes and clips made ready.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "audio/clip/clip.h"
#include "audio/modal/modal.h"
#include "scene/area/area.h"
#include "scene/config/cues.h"
#include "scene/scene_fwd.h"

namespace sparsha::audio {

/// One region, in the regions' frame (scene/area/regions.h): an area, or everywhere; nowhere it is never struck.
struct SoundRegion {
  std::string name;
  scene::Area area;
  std::variant<Modes, std::shared_ptr<const Clip>> sound;  ///< regions may share a clip
  bool everywhere = false;  ///< where no other region is; not played by a hand that slides onto it
  std::size_t scrape = 0;   ///< what is heard when it is stroked, index into SoundBank::scrapes
};

/// What a stroked surface is made of.
struct ScrapeSound {
  Modes modes;
  double grain_gain = 1.0;
};

/// Immutable once made; shared by every Synth of the same rate.
struct SoundBank {
  int sample_rate_hz = 48000;
  std::vector<SoundRegion> regions;
  std::vector<ScrapeSound> scrapes;       ///< the first is that of places without a region; never empty
  double scrape_gain = 0.0;               ///< 0 = no friction sound
  bool scrape_grain = true;               ///< the friction sound goes on below the nodes' distance
  std::optional<scene::CuesConfig> cues;  ///< which things that the hand comes to are told of
  std::vector<std::string> warnings;      ///< what was asked for and cannot sound

  /// False when nothing ever sounds.
  [[nodiscard]] bool sounds() const noexcept { return !regions.empty() || scrape_gain > 0.0 || cues.has_value(); }
  /// Index of the first region that holds the place (regions' frame, metres); none when there is none. No allocation.
  [[nodiscard]] std::optional<std::size_t> region_at(const std::array<double, 3>& place_m) const noexcept;
};

/// Throws Error{input} for the first clip of a configuration that a scene made of it could not play.
void require_clips(const scene::Config& config);

/// Loads clips and label image and works out modes. A scene without `audio:` gives a bank without regions. Throws
/// Error{input} for files that cannot be read, Error{usage} for impossible notes.
[[nodiscard]] std::shared_ptr<const SoundBank> make_sound_bank(const scene::Scene& scene, int sample_rate_hz);

}  // namespace sparsha::audio
