// What a LAS file says of itself beside its points.
#pragma once

#include <string>
#include <vector>

#include "pipeline/scan/file.h"
#include "pipeline/scan/formats/las/header.h"

namespace sparsha::pipeline::las {

/// Software, system and the name of the coordinates' reference, as far as they are there.
[[nodiscard]] std::vector<std::string> notes_of(const ScanFile& file, const Header& header);

}  // namespace sparsha::pipeline::las
