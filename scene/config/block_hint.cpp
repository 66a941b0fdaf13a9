#include "scene/config/block_hint.h"

#include <array>
#include <string>

#include "base/error.h"

namespace sparsha::scene {
namespace {

constexpr auto kPaths = std::to_array<std::string_view>({"grid.size",
                                                         "grid.spacing_mm",
                                                         "grid.bounds_m",
                                                         "grid.noise_mm",
                                                         "fill.max_gap_mm",
                                                         "texture.sigma_space_mm",
                                                         "texture.sigma_range_mm",
                                                         "friction.law",
                                                         "friction.mu_static",
                                                         "friction.mu_0",
                                                         "friction.mu_max",
                                                         "friction.scale_mm",
                                                         "levels.window",
                                                         "check.samples",
                                                         "haptics.stiffness_n_per_m",
                                                         "haptics.solver",
                                                         "haptics.surface",
                                                         "haptics.creases",
                                                         "haptics.beyond",
                                                         "haptics.rate_hz",
                                                         "haptics.resolution_mm",
                                                         "haptics.tip_radius_mm",
                                                         "haptics.impact",
                                                         "haptics.grain",
                                                         "orientation.look_from",
                                                         "orientation.up",
                                                         "orientation.euler_deg",
                                                         "orientation.quaternion",
                                                         "orientation.matrix",
                                                         "orientation.face",
                                                         "speech.language",
                                                         "speech.voice",
                                                         "speech.words_per_minute",
                                                         "guide.path",
                                                         "viewer.colour",
                                                         "viewer.stereo"});

}  // namespace

std::span<const std::string_view> keys_of_one_block() noexcept { return kPaths; }

void refuse_keys_without_block(const yaml::Node& root) {
  for (const yaml::Entry& entry : root.entries)
    for (const std::string_view path : kPaths)
      if (path.substr(path.rfind('.') + 1) == entry.key)
        throw Error(ErrorKind::usage, entry.place, "the configuration has no key '" + entry.key + "'",
                    "did you mean '" + std::string(path) + "'?");
}

}  // namespace sparsha::scene
