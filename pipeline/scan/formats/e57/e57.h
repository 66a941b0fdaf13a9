// E57 (ASTM E2807): several scans with poses, Cartesian or spherical, every bit packing, checksums verified.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

[[nodiscard]] bool is_e57(const ScanFile& file);
void read_e57(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
