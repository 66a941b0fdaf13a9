// Lotus, inscription, mouldings and grain as closed forms.
#include "pipeline/simulate/relief.h"

#include <cmath>

#include "pipeline/simulate/noise_field.h"
#include "pipeline/simulate/plain_math.h"

namespace sparsha::pipeline {

struct ReliefDrawing {
  ReliefForm form;
  double width_m = 0.0;
  double height_m = 0.0;
};

std::shared_ptr<const ReliefDrawing> draw_relief(const ReliefForm& form, double width_m, double height_m) {
  return std::make_shared<const ReliefDrawing>(ReliefDrawing{form, width_m, height_m});
}

double relief_z(const ReliefDrawing& drawing, double x, double y) {
  const double dx = x - 0.5 * drawing.width_m;
  const double dy = y - 0.6 * drawing.height_m;
  const double r = std::sqrt(dx * dx + dy * dy);
  const double petals = 0.004 * plain::cos_turns(8.0 * plain::atan2_turns(dy, dx)) * plain::exp(-400.0 * r * r);
  return petals + drawing.form.grain_m * 3.0 * fractal_noise(drawing.form.seed, x / 0.004, y / 0.004, 4, 0.7);
}

std::array<double, 2> relief_range(const ReliefForm& form) { return {-0.01 - 3.0 * form.grain_m, 0.03}; }

double relief_reflectance(const ReliefDrawing& drawing, double x, double y) {
  return 0.55 + 0.3 * fractal_noise(drawing.form.seed + 100, x / 0.02, y / 0.02, 4, 0.6);
}

}  // namespace sparsha::pipeline
