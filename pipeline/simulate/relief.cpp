// A sandstone slab: frame with mouldings and a row of pearls, lotus medallion in a beaded ring, leaves in the
// spandrels, an inscription below, grain, bedding, chisel marks and the damage of time over all.
#include "pipeline/simulate/relief.h"

#include <algorithm>
#include <cmath>

#include "pipeline/simulate/glyphs.h"
#include "pipeline/simulate/noise_field.h"
#include "pipeline/simulate/ornament.h"
#include "pipeline/simulate/plain_math.h"

namespace sparsha::pipeline {

struct ReliefDrawing {
  ReliefForm form;
  double scale = 1.0;  // drawing units per metre: the drawing is 0.36 m x 0.44 m
  Lettering lettering;
};

namespace {

constexpr double kWidth_m = 0.36, kHeight_m = 0.44;  // of the drawing
constexpr double kCentreX = 0.18, kCentreY = 0.262;  // of the medallion
constexpr double kRadius = 0.130;                    // of the medallion's outer moulding
constexpr double kFrame = 0.027;                     // inner edge of the frame, from the border
constexpr double kPanelTop = 0.1035;                 // middle of the moulding above the inscription
constexpr double kMargin = 0.008;                    // between frame and lettering
constexpr double kSoft = 0.0009;                     // weathered joints

double squared(double x) { return x * x; }

/// Distance inwards from the border of the slab.
double border_distance(double x, double y) { return std::min(std::min(x, kWidth_m - x), std::min(y, kHeight_m - y)); }

/// Pearls along the four sides; `e` is the distance from the border.
double pearls_z(double x, double y, double e) {
  constexpr double kMiddle = 0.0185, kBall = 0.0029, kPitch = 0.0070;
  if (std::fabs(e - kMiddle) > 0.006) return -0.01;
  const bool side = std::min(x, kWidth_m - x) < std::min(y, kHeight_m - y);
  const double along = side ? y - 0.5 * kHeight_m : x - 0.5 * kWidth_m;
  const double step = along / kPitch;
  const double offset = kPitch * (step - std::floor(step + 0.5));
  const double inside = squared(kBall) - squared(e - kMiddle) - squared(offset);
  return inside > 0.0 ? std::sqrt(inside) : -0.01;
}

double frame_z(double x, double y) {
  const double e = border_distance(x, y);
  if (e > kFrame + 0.006) return -0.01;
  constexpr double kTop = 0.0115;
  double z = 0.0;
  if (e < 0.0095) {
    z = kTop - 1.2 * std::max(0.0, 0.0015 - e);                 // flat band with a worn arris
    z -= 0.0009 * plain::exp(-squared((e - 0.0062) / 0.0005));  // a scratched line
  } else if (e < 0.0145) {
    const double t = (e - 0.0095) / 0.005;  // ovolo
    z = kTop - 0.0010 - 0.0062 * (1.0 - std::sqrt(std::max(0.0, 1.0 - t * t)));
  } else if (e < 0.0225) {
    z = 0.0026;  // channel of the pearls
    z = soft_max(z, z + pearls_z(x, y, e), 0.0003);
  } else {
    z = torus_z(0.0048, 0.0022, e - 0.0248);
  }
  return z;
}

/// Leaves that fan out of a corner of the square around the medallion, dx and dy inwards from that corner.
double spandrel_z(double dx, double dy) {
  if (dx + dy > 0.125) return -0.01;
  struct Leaf {
    double turn;  // off the diagonal, of a full turn
    Petal petal;
  };
  static constexpr std::array<Leaf, 3> kLeaves{{{0.0, {0.010, 0.068, 0.0105, 0.0034, 0.0032, 0.0014}},
                                                {0.062, {0.009, 0.058, 0.0088, 0.0020, 0.0026, 0.0010}},
                                                {0.105, {0.008, 0.050, 0.0052, 0.0006, 0.0024, 0.0008}}}};
  constexpr double kDiagonal = 0.70710678118654752;
  const double u = kDiagonal * (dx + dy);
  const double v = std::fabs(kDiagonal * (dx - dy));
  double z = -0.01;
  for (const Leaf& leaf : kLeaves) {
    const double c = plain::cos_turns(leaf.turn);
    const double s = plain::sin_turns(leaf.turn);
    z = soft_max(z, petal_z(leaf.petal, c * u + s * v, c * v - s * u), 0.0004);
  }
  const double ball = squared(0.0115) - squared(u - 0.006) - squared(v);
  return ball > 0.0 ? soft_max(z, 0.60 * std::sqrt(ball), 0.0004) : z;
}

double medallion_z(double x, double y) {
  const double dx = x - kCentreX;
  const double dy = y - kCentreY;
  const double r = std::sqrt(dx * dx + dy * dy);
  if (r > kRadius + 0.008) return -0.01;
  const double angle = plain::atan2_turns(dy, dx);
  const double dome = 0.0022 * (1.0 - squared(r / kRadius));
  double z = -0.0006 * smooth_ramp(kRadius, kRadius - 0.006, r);
  z = soft_max(z, torus_z(0.0062, 0.0038, r - 0.1265), kSoft);
  z = soft_max(z, bead_ring_z(0.0045, 0.1158, 74, r, angle) + 0.0006, 0.0003);
  z = soft_max(z, torus_z(0.0036, 0.0019, r - 0.1075), kSoft);
  if (r < 0.108) {
    constexpr Petal kOuter{0.040, 0.1045, 0.0165, 0.0014, 0.0036, 0.0012};
    constexpr Petal kMiddle{0.030, 0.0845, 0.0138, 0.0048, 0.0036, 0.0016};
    constexpr Petal kInner{0.016, 0.0590, 0.0170, 0.0082, 0.0034, 0.0018};
    z = soft_max(z, petal_ring_z(kOuter, 16, 0.5, r, angle), 0.0004);
    z = soft_max(z, petal_ring_z(kMiddle, 16, 0.0, r, angle), 0.0004);
    z = soft_max(z, petal_ring_z(kInner, 8, 0.5, r, angle), 0.0004);
    z = soft_max(z, pod_z(0.0250, 0.0108, r, angle), 0.0004);
  }
  return z + dome;
}

/// Marks of a flat chisel on the ground: short strokes in a slanting direction.
double chisel_z(const ReliefDrawing& drawing, double x, double y) {
  const double along = 0.8 * x + 0.6 * y;
  const double across = -0.6 * x + 0.8 * y + 0.0012 * gradient_noise(drawing.form.seed + 11, x / 0.02, y / 0.02);
  const double strength = 0.5 + gradient_noise(drawing.form.seed + 12, along / 0.014, across / 0.004);
  return -0.00022 * std::max(0.0, strength) * (1.0 + plain::cos_turns(across / 0.0034));
}

double grain_z(const ReliefDrawing& drawing, double x, double y) {
  const std::uint64_t seed = drawing.form.seed;
  const double grain = fractal_noise(seed + 20, x / 0.0024, y / 0.0024, 3, 0.75);
  const double bedding = gradient_noise(seed + 30, x / 0.080, (y + 0.06 * x) / 0.0045);
  const double wear = gradient_noise(seed + 31, x / 0.030, y / 0.030);
  const double pit = std::max(0.0, gradient_noise(seed + 32, x / 0.0052, y / 0.0052) - 0.36);
  return drawing.form.grain_m * (2.6 * grain + 0.9 * bedding + 1.8 * wear - 22.0 * pit);
}

/// How deep the broken corner and a bruise on the frame reach below `z`.
double damage_z(const ReliefDrawing& drawing, double x, double y) {
  const std::uint64_t seed = drawing.form.seed;
  const double rough = 0.0022 * fractal_noise(seed + 40, x / 0.012, y / 0.012, 4, 0.55);
  const double corner = 0.0300 - 0.9 * (kWidth_m - x) - 0.6 * (kHeight_m - y) + 2.2 * rough;
  const double bruise = 0.0085 - 0.5 * std::sqrt(squared(x - 0.004) + squared(0.6 * (y - 0.150))) + 2.0 * rough;
  const double lowest = 0.0016 + rough;
  double cut = 1.0;
  if (corner > 0.0) cut = std::min(cut, std::max(lowest, 0.0115 - 0.75 * corner));
  if (bruise > 0.0) cut = std::min(cut, std::max(lowest + 0.003, 0.0118 - 1.1 * bruise));
  return cut;
}

}  // namespace

std::shared_ptr<const ReliefDrawing> draw_relief(const ReliefForm& form, double width_m, double height_m) {
  ReliefDrawing drawing{form, 1.0 / std::max(width_m / kWidth_m, height_m / kHeight_m), {}};
  drawing.lettering = set_letters(form.inscription, kFrame + kMargin, 0.0435, kWidth_m - kFrame - kMargin, 0.0885);
  return std::make_shared<const ReliefDrawing>(std::move(drawing));
}

double relief_z(const ReliefDrawing& drawing, double x_m, double y_m) {
  const std::uint64_t seed = drawing.form.seed;
  const double x0 = x_m * drawing.scale;
  const double y0 = y_m * drawing.scale;
  // No line is quite straight under a human hand.
  const double x = x0 + 0.0007 * gradient_noise(seed + 1, x0 / 0.022, y0 / 0.022);
  const double y = y0 + 0.0007 * gradient_noise(seed + 2, x0 / 0.022, y0 / 0.022);

  double carved = -0.01;
  if (y > kPanelTop + 0.001) {
    const double side = std::min(x, kWidth_m - x) - (kFrame + 0.0015);
    const double half = 0.1505;
    const double end = half - std::fabs(y - kCentreY);
    carved = soft_max(medallion_z(x, y), spandrel_z(side, end), kSoft);
  }
  carved = soft_max(carved, torus_z(0.0044, 0.0026, y - kPanelTop), kSoft);
  carved = soft_max(carved, frame_z(x, y), kSoft);
  // The mason dressed the panel more finely, for the letters' sake.
  const double ground = (y < kPanelTop ? 0.35 : 0.7) * chisel_z(drawing, x, y);
  double z = soft_max(ground, carved, kSoft);
  const double letter = drawing.lettering.depth(x, y);
  if (letter > 0.0) z -= 1.15 * letter;
  z = std::min(z, damage_z(drawing, x0, y0));
  return (z + grain_z(drawing, x0, y0)) / drawing.scale;
}

std::array<double, 2> relief_range(const ReliefForm& form) {
  return {-0.006 - 12.0 * form.grain_m, 0.018 + 5.0 * form.grain_m};
}

double relief_reflectance(const ReliefDrawing& drawing, double x, double y) {
  const std::uint64_t seed = drawing.form.seed + 100;
  const double bands = gradient_noise(seed, x / 0.10, (y + 0.06 * x) / 0.012);
  const double grain = fractal_noise(seed + 10, x / 0.004, y / 0.004, 3, 0.8);
  return std::clamp(0.58 + 0.18 * bands + 0.16 * grain, 0.05, 0.95);
}

}  // namespace sparsha::pipeline
