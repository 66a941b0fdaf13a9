#include "scene/config/block_hint.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

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

[[noreturn]] void refuse(const yaml::Entry& entry, std::string_view path) {
  throw Error(ErrorKind::usage, entry.place, "the configuration has no key '" + entry.key + "'",
              "did you mean '" + std::string(path) + "'?");
}

/// For the key that `error` names as unknown, where no block is near.
void refuse_near_key(const yaml::Node& root, const Error& error) {
  constexpr std::size_t kShort = 4;  // shorter ones are near to too much
  if (error.expected().starts_with("did you mean")) return;
  std::vector<std::string> keys;
  for (const std::string_view path : kPaths) keys.emplace_back(path.substr(path.rfind('.') + 1));
  for (const yaml::Entry& entry : root.entries) {
    if (entry.key.size() < kShort || error.wrong().find("'" + entry.key + "'") == std::string::npos) continue;
    const std::string near = yaml::nearest(entry.key, keys);
    const auto found = std::find(keys.begin(), keys.end(), near);
    if (found != keys.end()) refuse(entry, kPaths[static_cast<std::size_t>(found - keys.begin())]);
  }
}

}  // namespace

std::span<const std::string_view> keys_of_one_block() noexcept { return kPaths; }

void finish_root(const yaml::MapReader& reader, const yaml::Node& root) {
  for (const yaml::Entry& entry : root.entries) {
    for (const std::string_view path : kPaths) {
      if (path.substr(path.rfind('.') + 1) == entry.key) refuse(entry, path);
    }
  }
  try {
    reader.finish();
  } catch (const Error& error) {
    refuse_near_key(root, error);
    throw;
  }
}

}  // namespace sparsha::scene
