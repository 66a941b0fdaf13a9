// LAS 1.0 to 1.4 (ASPRS), all point formats and packings (LAZ).
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// True when the bytes bear the signature of LAS and LAZ.
[[nodiscard]] bool is_las(const ScanFile& file);
void read_las(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
