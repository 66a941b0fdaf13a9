// The unit that a remark of a file gives: "# Units: mm", "comment unit mm", "# File units = millimeters".
#pragma once

#include <string>
#include <string_view>

#include "pipeline/scan/reader.h"

namespace sparsha::pipeline {

/// The word that a remark gives as its unit, in lower case and without the signs around it; empty when it gives none.
/// Behind "unit" or "units" stands '=' or ':', or the unit is the remark's last word ("all units are in mm"). What has
/// a unit of its own, as an accuracy or a pixel, gives none.
[[nodiscard]] std::string unit_in_remark(std::string_view remark);

/// Whether a remark gives a unit that coordinates may have, be it one that no configuration knows.
[[nodiscard]] bool gives_unit(std::string_view remark);

/// Takes the unit of a remark on a line for the scan, unless it has one already, and says so in a note. A unit that no
/// configuration can be is a warning, and nothing is converted. True where the remark gives a unit.
bool take_unit_of_remark(std::string_view remark, int line, RawScan& scan);

}  // namespace sparsha::pipeline
