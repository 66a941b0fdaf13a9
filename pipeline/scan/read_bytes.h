// Reading a scan that is in memory already: for tests and fuzzing.
#pragma once

#include <string>
#include <string_view>

#include "pipeline/scan/reader.h"

namespace sparsha::pipeline {

/// As read_scan of a file called `name` with these bytes.
[[nodiscard]] RawScan read_scan_bytes(std::string_view bytes, const std::string& name);

}  // namespace sparsha::pipeline
