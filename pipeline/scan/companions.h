// Files that a scan names to be read with it: libraries of materials, pictures on meshes, buffers of glTF.
#pragma once

#include <filesystem>

namespace sparsha::pipeline {

/// True for a file in the folder of `scan`, or below it, whose name stands in the scan or in a library of materials
/// that the scan names. A name that stands in a remark counts too. False when either cannot be read.
[[nodiscard]] bool names_companion(const std::filesystem::path& scan, const std::filesystem::path& file);

}  // namespace sparsha::pipeline
