#include "pipeline/check/chart_nodes.h"

#include <bit>

namespace sparsha::pipeline {

ChartNodes::ChartNodes(const scene::Charts& charts) : per_m_(1.0 / charts.spacing_m) {
  nodes_.reserve(charts.measured_nodes());
  std::uint32_t number = 0;
  for (const scene::Sheet& sheet : charts.sheets) {
    for (int j = 0; j < sheet.ny; ++j) {
      for (int i = 0; i < sheet.nx; ++i) {
        if (!sheet.measured(sheet.index(i, j))) continue;
        nodes_.push_back({charts.place_m(sheet, i, j).cast<float>(), scene::Charts::normal(sheet, i, j).cast<float>(),
                          sheet.side, number});
      }
    }
    ++number;
  }
  // Cells chain their nodes in a table of twice as many places.
  table_.assign(std::bit_ceil(2 * nodes_.size() + 1), kNone);
  next_.resize(nodes_.size());
  for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
    std::uint32_t& first = table_[slot(cell_of(nodes_[n].place_m.cast<double>()))];
    next_[n] = first;
    first = n;
  }
}

std::array<std::int64_t, 3> ChartNodes::cell_of(const Eigen::Vector3d& place_m) const {
  constexpr double kMost = 1e15;  // cells; what is farther away is near nothing
  std::array<std::int64_t, 3> cell{};
  for (int axis = 0; axis < 3; ++axis) {
    cell[static_cast<std::size_t>(axis)] =
        static_cast<std::int64_t>(std::clamp(std::floor(place_m[axis] * per_m_), -kMost, kMost));
  }
  return cell;
}

}  // namespace sparsha::pipeline
