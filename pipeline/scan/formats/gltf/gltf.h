// glTF 2.0 and GLB: meshes and points of its default scene, with the transforms of its nodes.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// True for a binary glTF file of any version, and for a JSON object that says "asset" and "version".
[[nodiscard]] bool is_gltf(const ScanFile& file);
/// Metres; y is up. Buffers beside a .gltf are looked for in its own folder and below. Throws Error{input} with the
/// part of the file that is wrong, such as accessors[3].
void read_gltf(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
