// Whole objects: time of a tick beside the force's error.
#pragma once

#include <filesystem>

namespace sparsha::bench {

/// A hand that wanders over clouds of known objects, up to four spacings deep, judged by a god-object on their exact
/// distance, and beside it what was measured of CHAI3D 3.3 on meshes of a relief: it is not run here. Writes
/// haptics_objects.csv and prints it. False when the file cannot be written or a hand came through.
[[nodiscard]] bool write_objects(const std::filesystem::path& out, bool quick);

}  // namespace sparsha::bench
