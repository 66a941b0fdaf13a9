// STL, binary and ASCII; its points are the distinct vertices.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// True when the size is exactly what a binary STL file's triangle count says, whatever its header says.
[[nodiscard]] bool is_binary_stl(const ScanFile& file);
/// True when the text is that of an ASCII STL file.
[[nodiscard]] bool is_ascii_stl(const ScanFile& file);
void read_stl(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
