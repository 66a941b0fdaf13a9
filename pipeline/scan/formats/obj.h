// Wavefront OBJ: vertices, their colours and faces; everything else is passed over.
#pragma once

#include "pipeline/scan/scan_file.h"
#include "pipeline/scan/scan_writer.h"

namespace sparsha::pipeline {

/// True when the text's first statements are those of an OBJ file.
[[nodiscard]] bool is_obj(const ScanFile& file);
void read_obj(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
