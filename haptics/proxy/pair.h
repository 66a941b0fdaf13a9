// Two doubles that are computed with together: a cell's s and t. One vector register where the compiler has them; the
// arithmetic, lane by lane, is that of doubles either way.
#pragma once

#include <algorithm>

namespace sparsha::haptics {

#if defined(__GNUC__)
using Pair = double __attribute__((vector_size(16)));
#else
struct Pair {
  double lane[2];
  [[nodiscard]] double operator[](int k) const noexcept { return lane[k]; }
};
[[nodiscard]] inline Pair operator+(Pair a, Pair b) noexcept { return {a[0] + b[0], a[1] + b[1]}; }
[[nodiscard]] inline Pair operator-(Pair a, Pair b) noexcept { return {a[0] - b[0], a[1] - b[1]}; }
[[nodiscard]] inline Pair operator*(Pair a, Pair b) noexcept { return {a[0] * b[0], a[1] * b[1]}; }
[[nodiscard]] inline Pair operator/(Pair a, Pair b) noexcept { return {a[0] / b[0], a[1] / b[1]}; }
#endif

[[nodiscard]] inline Pair both(double x) noexcept { return Pair{x, x}; }
[[nodiscard]] inline Pair swapped(Pair a) noexcept { return Pair{a[1], a[0]}; }
[[nodiscard]] inline double dot(Pair a, Pair b) noexcept {
  const Pair product = a * b;
  return product[0] + product[1];
}
[[nodiscard]] inline double cross(Pair a, Pair b) noexcept {
  const Pair product = a * swapped(b);
  return product[0] - product[1];
}
[[nodiscard]] inline double lowest(Pair a) noexcept { return std::min(a[0], a[1]); }
[[nodiscard]] inline double highest(Pair a) noexcept { return std::max(a[0], a[1]); }

}  // namespace sparsha::haptics
