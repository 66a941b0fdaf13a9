// A scan's whole way, from its file to a hand that touches it, and what must hold on it. Knows no test framework, so
// that fuzz targets and programs of their own take it too.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>

#include "scene/config/config.h"
#include "scene/scene_fwd.h"

namespace sparsha::test {

/// Thrown where something on the way is not as it must be; what() says what and where.
class Broken : public std::logic_error {
  using std::logic_error::logic_error;
};

/// Takes a scene of scans that are still there through all that the commands do with it: its folder written and opened
/// again, every level traced, every zoom step touched in the middle and at two corners, exported in every format, held
/// against its scans. `folder` is emptied. Throws Broken, also for an Error of what must not fail.
void use_scene(const scene::ScenePointer& scene, const std::filesystem::path& folder);

/// What bytes describe: a scan of a regular or an unlikely shape, and a configuration for it. Any bytes do; few changed
/// bytes are a small change.
struct Recipe {
  std::string name;              ///< of the scan's file
  std::string scan;              ///< its content
  bool suggested = false;        ///< the configuration is the one that `new` proposes, changed by `config`
  scene::Config config;          ///< its scan is to be set
  std::uint64_t points_at_once;  ///< > 0: it is built with so many points in memory as well
  std::string words;             ///< what it is, for reports
};
[[nodiscard]] Recipe recipe_of(std::span<const std::uint8_t> bytes);

/// The whole way of a recipe in `folder`, which is emptied. False where the scan or its configuration was refused as
/// such. Throws Broken.
bool go_whole_way(std::span<const std::uint8_t> bytes, const std::filesystem::path& folder);

}  // namespace sparsha::test
