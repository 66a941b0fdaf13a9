// charts.bin of a scene folder: the sheets of a whole object (docs/formats.md).
#pragma once

#include <filesystem>
#include <vector>

#include "scene/charts.h"

namespace sparsha::scene {

/// The same sheets give the same bytes. Throws Error{failure}.
void write_sheets(const std::filesystem::path& file, const std::vector<Sheet>& sheets);

/// Throws Error{input} when the file is not such a file, is longer or shorter than its sheets, or a sheet contradicts
/// itself; memory is taken for no more than the file holds.
[[nodiscard]] std::vector<Sheet> read_sheets(const std::filesystem::path& file);

}  // namespace sparsha::scene
