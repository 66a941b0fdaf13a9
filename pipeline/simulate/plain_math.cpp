// Taylor series after exact range reduction; the orders make the truncation smaller than the rounding.
#include "pipeline/simulate/plain_math.h"

#include <cmath>
#include <cstdint>
#include <numbers>

#include "pipeline/simulate/random.h"

namespace sparsha::pipeline {
namespace plain {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kLn2High = 6.93147180369123816490e-01;  // 32 leading bits, so that k * kLn2High is exact
constexpr double kLn2Low = 1.90821492927058770002e-10;

/// |x| <= pi/4.
double sine_series(double x) {
  const double s = x * x;
  double sum = -1.0 / 1307674368000.0;
  sum = sum * s + 1.0 / 6227020800.0;
  sum = sum * s - 1.0 / 39916800.0;
  sum = sum * s + 1.0 / 362880.0;
  sum = sum * s - 1.0 / 5040.0;
  sum = sum * s + 1.0 / 120.0;
  sum = sum * s - 1.0 / 6.0;
  return x + x * s * sum;
}

/// |x| <= pi/4.
double cosine_series(double x) {
  const double s = x * x;
  double sum = 1.0 / 20922789888000.0;
  sum = sum * s - 1.0 / 87178291200.0;
  sum = sum * s + 1.0 / 479001600.0;
  sum = sum * s - 1.0 / 3628800.0;
  sum = sum * s + 1.0 / 40320.0;
  sum = sum * s - 1.0 / 720.0;
  sum = sum * s + 1.0 / 24.0;
  return 1.0 - 0.5 * s + s * s * sum;
}

/// Sine of `turns` plus `quarters` quarter turns.
double sine_of(double turns, int quarters) {
  const double fraction = turns - std::floor(turns + 0.5);
  const double quarter = std::floor(4.0 * fraction + 0.5);
  const double x = kTwoPi * (fraction - 0.25 * quarter);
  const int phase = (static_cast<int>(quarter) + quarters) & 3;
  const double value = (phase & 1) != 0 ? cosine_series(x) : sine_series(x);
  return (phase & 2) != 0 ? -value : value;
}

/// Arc tangent for 0 <= x <= tan(pi/8), radians.
double arctangent_series(double x) {
  const double s = x * x;
  double sum = 0.0;
  for (int n = 43; n >= 3; n -= 2) sum = ((n & 2) != 0 ? -1.0 : 1.0) / n + s * sum;
  return x + x * s * sum;
}

}  // namespace

double sin_turns(double turns) { return sine_of(turns, 0); }
double cos_turns(double turns) { return sine_of(turns, 1); }

double exp(double x) {
  if (x < -708.0) return 0.0;
  const double k = std::floor(x * std::numbers::log2e + 0.5);
  const double r = (x - k * kLn2High) - k * kLn2Low;
  double sum = 1.0;
  for (int n = 14; n >= 1; --n) sum = 1.0 + sum * r / n;
  return std::ldexp(sum, static_cast<int>(k));
}

double log(double x) {
  int k = 0;
  double m = std::frexp(x, &k);
  if (m < 0.5 * std::numbers::sqrt2) {
    m *= 2.0;
    --k;
  }
  const double s = (m - 1.0) / (m + 1.0);
  const double square = s * s;
  double sum = 0.0;
  for (int n = 23; n >= 3; n -= 2) sum = 1.0 / n + square * sum;
  return k * kLn2High + (2.0 * (s + s * square * sum) + k * kLn2Low);
}

double atan2_turns(double y, double x) {
  const double ax = std::fabs(x);
  const double ay = std::fabs(y);
  const double large = std::fmax(ax, ay);
  if (large == 0.0) return 0.0;
  const double ratio = std::fmin(ax, ay) / large;  // 0 to 1
  constexpr double kTanEighth = 0.41421356237309503;
  const double angle = ratio <= kTanEighth ? arctangent_series(ratio)
                                           : 0.25 * std::numbers::pi - arctangent_series((1.0 - ratio) / (1.0 + ratio));
  double turns = angle / kTwoPi;
  if (ay > ax) turns = 0.25 - turns;
  if (x < 0.0) turns = 0.5 - turns;
  return y < 0.0 ? -turns : turns;
}

}  // namespace plain

double Random::normal() {
  const double radius = std::sqrt(-2.0 * plain::log(uniform()));
  return radius * plain::cos_turns(uniform());
}

}  // namespace sparsha::pipeline
