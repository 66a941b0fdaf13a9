// Surfer's ASCII grid (DSAA, .grd): counts, limits, then rows of heights from the lowest y to the highest.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

[[nodiscard]] bool is_surfer_grid(const ScanFile& file);
void read_surfer_grid(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
