// What an E57 file says of itself beside its points: shows pugixml to the reader's sources alone.
#pragma once

#include <string>
#include <vector>

#include <pugixml.hpp>

namespace sparsha::pipeline::e57 {

/// Software, scanners, scan positions, rows and columns, pictures, as far as they are there. `used`: pictures that
/// colour points.
[[nodiscard]] std::vector<std::string> notes_of(const pugi::xml_node& root, std::size_t used);

}  // namespace sparsha::pipeline::e57
