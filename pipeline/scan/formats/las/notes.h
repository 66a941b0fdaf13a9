// What a LAS file says of itself beside its points.
#pragma once

#include <string>
#include <vector>

#include "pipeline/scan/file.h"
#include "pipeline/scan/formats/las/header.h"

namespace sparsha::pipeline::las {

/// Software, system and the name of the coordinates' reference, as far as they are there, and rules of LAS 1.4 for its
/// own point formats that the header breaks (they change nothing of what is read).
[[nodiscard]] std::vector<std::string> notes_of(const ScanFile& file, const Header& header);

}  // namespace sparsha::pipeline::las
