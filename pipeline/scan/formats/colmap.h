// COLMAP's sparse points in binary (points3D.bin): a number, and for each point its place, colour, error and the
// pictures that show it.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// What a sparse model is and lacks, in text and binary.
inline constexpr const char* kColmapNote =
    "COLMAP: sparse points of a model whose cameras and images are not read; its dense fused.ply has the surface";

/// By its records, which must follow one another: nothing else in such a file tells.
[[nodiscard]] bool is_colmap(const ScanFile& file);
void read_colmap(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
