// Gaussian splats as SPZ files have them (versions 1 to 3): gzip over a header of 16 bytes, then all splats' positions,
// opacities, colours, axes, turns and harmonics.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// By the first bytes within the gzip stream.
[[nodiscard]] bool is_spz(const ScanFile& file);
void read_spz(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
