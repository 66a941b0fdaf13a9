// 3MF: meshes in a zip package, placed by components and build items.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// A zip archive that names a 3MF model, or whose own name ends in .3mf.
[[nodiscard]] bool is_3mf(const ScanFile& file);
void read_3mf(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
