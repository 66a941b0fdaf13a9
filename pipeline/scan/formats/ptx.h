// PTX: Leica's text format, several scans in grids, each with its matrix.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// True when the text begins with a PTX header: columns, rows, four vectors of three, four of four numbers.
[[nodiscard]] bool is_ptx(const ScanFile& file);
void read_ptx(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
