// Wavefront OBJ: vertices, their colours and faces. Other elements are counted and said, and a remark
// may give the unit.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// True when the text's first statements are those of an OBJ file.
[[nodiscard]] bool is_obj(const ScanFile& file);
void read_obj(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
