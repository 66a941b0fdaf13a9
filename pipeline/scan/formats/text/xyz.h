// Columns of numbers in text: XYZ, TXT, ASC, CSV and PTS, with or without header, counts, colours and intensity.
#pragma once

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// Reads any text whose rows begin with three numbers, or whose header names x, y and z.
void read_xyz(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline
