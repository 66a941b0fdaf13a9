#include "pipeline/scan/formats/threemf/unit.h"

#include "pipeline/scan/text.h"

namespace sparsha::pipeline::threemf {

Unit unit_of(const ScanFile& file, const std::string& name) {
  using enum scene::LengthUnit;
  if (name == "millimeter") return {mm, 1.0, 1.0};
  if (name == "micron") return {mm, 0.001, 0.001};
  if (name == "centimeter") return {cm, 1.0, 10.0};
  if (name == "inch") return {mm, 25.4, 25.4};
  if (name == "foot") return {ft, 1.0, 304.8};
  if (name == "meter") return {m, 1.0, 1000.0};
  throw file.error("the 3MF model's unit is " + in_quotes(name), "micron, millimeter, centimeter, inch, foot or meter");
}

}  // namespace sparsha::pipeline::threemf
