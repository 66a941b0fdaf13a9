// Cells as wide as the reach: a point is asked about the places of its own and the neighbouring ones.
#include "pipeline/scan/surroundings.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/numbers/statistics.h"

namespace sparsha::pipeline {

Surroundings::Surroundings(std::vector<Eigen::Vector3d> places, double reach)
    : places_(std::move(places)), around_(places_.size()), reach_(reach) {
  for (std::uint32_t n = 0; n < places_.size(); ++n) {
    const Cell home = cell_of(places_[n]);
    for (std::int64_t x = -1; x <= 1; ++x)
      for (std::int64_t y = -1; y <= 1; ++y)
        for (std::int64_t z = -1; z <= 1; ++z) near_[{home[0] + x, home[1] + y, home[2] + z}].push_back(n);
  }
}

Surroundings::Cell Surroundings::cell_of(const Eigen::Vector3d& p) const {
  const auto whole = [&](double v) {
    return static_cast<std::int64_t>(std::floor(std::clamp(v / reach_, -1e15, 1e15)));
  };
  return {whole(p.x()), whole(p.y()), whole(p.z())};
}

void Surroundings::add(const Eigen::Vector3d& point) {
  const auto found = near_.find(cell_of(point));
  if (found == near_.end()) return;
  for (const std::uint32_t n : found->second) {
    const Eigen::Vector3d away = point - places_[n];
    if (away.squaredNorm() > reach_ * reach_) continue;
    Around& around = around_[n];
    if (++around.count <= kMostKept) around.away.push_back(away);
  }
}

double Surroundings::apart() const {
  constexpr double kPi = 3.14159265358979323846;
  std::vector<double> distances;
  for (const Around& around : around_) {
    distances.push_back(reach_ * std::sqrt(kPi / static_cast<double>(std::max<std::uint64_t>(1, around.count))));
  }
  return median(distances);
}

}  // namespace sparsha::pipeline
