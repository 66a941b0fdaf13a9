#include "scene/frame/length_unit.h"

namespace sparsha::scene {

double metres_in(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::cm:
      return 0.01;
    case LengthUnit::mm:
      return 0.001;
    case LengthUnit::ft:
      return 0.3048;
    case LengthUnit::us_ft:
      return 1200.0 / 3937.0;
    default:
      return 1.0;
  }
}

}  // namespace sparsha::scene
