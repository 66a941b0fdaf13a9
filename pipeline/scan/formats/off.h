// OFF, Geomview's object file format, in text: [ST][C][N][4]OFF, vertices with or without normals and colours, faces.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// True when the first word is one of OFF's, in any case, or the file's name ends with .off.
[[nodiscard]] bool is_off(const ScanFile& file);
void read_off(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
