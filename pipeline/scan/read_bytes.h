// What the rooms' own code, tests and fuzzing need of the readers beside their public face.
#pragma once

#include <string>
#include <string_view>

#include "pipeline/scan/reader.h"

namespace sparsha::pipeline {

/// As read_scan of a file called `name` with these bytes.
[[nodiscard]] RawScan read_scan_bytes(std::string_view bytes, const std::string& name, const ReadOptions& options = {});

/// True when a file is decoded so fast (fixed binary records, no faces) that reading it twice costs less than keeping
/// its points in double.
[[nodiscard]] bool is_quick_to_stream(const std::filesystem::path& file);

/// False when a file's format, or its header, says that it has no faces.
[[nodiscard]] bool may_hold_faces(const std::filesystem::path& file);

}  // namespace sparsha::pipeline
