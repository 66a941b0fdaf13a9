// Units of 3MF models (core specification, 3.4).
#pragma once

#include <string>

#include "pipeline/scan/file.h"
#include "scene/config/scans.h"

namespace sparsha::pipeline::threemf {

struct Unit {
  scene::LengthUnit unit;  ///< one that scans have
  double factor;           ///< a number of the model in it
  double millimetres;      ///< a number of the model in mm
};

/// Throws Error{input} for a name that 3MF does not know.
[[nodiscard]] Unit unit_of(const ScanFile& file, const std::string& name);

}  // namespace sparsha::pipeline::threemf
