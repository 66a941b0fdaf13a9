// Colour modes: a colour for every node and the legend that explains it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/config/viewer.h"
#include "scene/scene_fwd.h"
#include "viewer/surface/colour_maps.h"
#include "viewer/surface/relief_data.h"

namespace sparsha::viewer {

using ColourMode = scene::ViewerConfig::Colour;

/// What the colours mean; `unit` is the symbol after the numbers.
struct Legend {
  std::string title;
  std::string unit;
  ColourMap map = ColourMap::sequential;
  double low = 0.0;  ///< in `unit`
  double high = 1.0;
  bool scale = false;  ///< a colour bar is meant; false: only the title
  /// Colours with a meaning of their own.
  struct Swatch {
    std::string name;
    std::array<std::uint8_t, 3> colour{};
  };
  std::vector<Swatch> swatches;
};

/// sRGB colour and, as alpha, whether there is one: four bytes per node. Empty for ColourMode::relief.
struct Paint {
  std::vector<std::uint8_t> rgba;
  Legend legend;
};

/// Of ColourMode::coverage: what was measured, and what was made up.
inline constexpr std::array<std::uint8_t, 3> kMeasuredColour{206, 190, 164}, kFilledColour{46, 126, 190};
/// "measured 97.0 %".
[[nodiscard]] Legend::Swatch coverage_swatch(const char* name, std::size_t count, std::size_t of,
                                             const std::array<std::uint8_t, 3>& colour);

/// True when the scene has what the mode shows.
[[nodiscard]] bool has_mode(const scene::SceneDescription& description, ColourMode mode);
/// Colours of the scans as they are (0xAABBGGRR, 0: none), or where there are none their intensities as greys, whose
/// range all but 2 % lie in. One a vertex; the other may be empty.
[[nodiscard]] Paint paint_as_scanned(const std::vector<std::uint32_t>& colour_rgba,
                                     const std::vector<float>& intensity);
/// `title` of a mode in the interface, e.g. "Height".
[[nodiscard]] const char* name_of(ColourMode mode);
/// The next mode after `mode` that the scene has; `step` -1: the one before.
[[nodiscard]] ColourMode next_mode(const scene::SceneDescription& description, ColourMode mode, int step = 1);
/// `workspace_m`: width of the hand's workspace, which the paper's law of friction depends on. `legend`: the range to
/// use instead of the piece's own, so that pieces of one scene agree.
[[nodiscard]] Paint paint_relief(const ReliefData& relief, const scene::SceneDescription& description, ColourMode mode,
                                 double workspace_m, const Legend* legend = nullptr);

}  // namespace sparsha::viewer
