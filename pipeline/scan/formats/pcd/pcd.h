// PCD, the Point Cloud Library's format: ascii, binary and binary_compressed, versions .5 to .7.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// True when the bytes begin as a PCD header does.
[[nodiscard]] bool is_pcd(const ScanFile& file);
void read_pcd(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
