// Gaussian splats as .splat files have them: 32 bytes a splat, without a header, most important first.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// By its ending alone, as nothing in such a file tells.
[[nodiscard]] bool is_splat(const ScanFile& file);
void read_splat(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
