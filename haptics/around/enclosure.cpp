#include "haptics/around/enclosure.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sparsha::haptics {
namespace {

/// The surface of a room as seen from within winds about the air once, the other way: -1. Else 0, also for what is open
/// by halves and winds about neither side.
double winding_of_air(const scene::Charts& charts, const scene::WindingNumber& winding) {
  constexpr std::uint64_t kAsked = 256;
  constexpr double kBefore = 2.0;  // spacings
  constexpr double kRoom = -0.75;
  const std::uint64_t every = charts.measured_nodes() / kAsked + 1;
  std::vector<double> numbers;
  std::uint64_t count = 0;
  for (const scene::Sheet& sheet : charts.sheets)
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i) {
        if (!sheet.measured(sheet.index(i, j)) || count++ % every != 0) continue;
        const Eigen::Vector3d before =
            charts.place_m(sheet, i, j) / charts.spacing_m + kBefore * scene::Charts::normal(sheet, i, j);
        numbers.push_back(winding.at(before.cast<float>()));
      }
  if (numbers.empty()) return 0.0;
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle < kRoom ? -1.0 : 0.0;
}

}  // namespace

Enclosure::Enclosure(const scene::Charts& charts)
    : winding_(charts), spacing_m_(charts.spacing_m), of_air_(winding_of_air(charts, winding_)) {}

double Enclosure::at(const Eigen::Vector3d& place_m) const noexcept {
  return winding_.at((place_m / spacing_m_).cast<float>()) - of_air_;
}

bool Enclosure::holds(const Eigen::Vector3d& place_m) const noexcept {
  constexpr double kHolds = 0.5;
  return at(place_m) > kHolds;
}

}  // namespace sparsha::haptics
