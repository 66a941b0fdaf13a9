// ESRI's ASCII grid (.asc, Arc/Info ASCII, GDAL's AAIGrid): a header of keys, then rows of heights from north to south.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// True when the first word is a key of the header.
[[nodiscard]] bool is_esri_grid(const ScanFile& file);
void read_esri_grid(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
