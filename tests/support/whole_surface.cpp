// Nearest points by cells; errors along the nearest true point's normal, so that the distance of true points does not
// count.
#include "tests/support/whole_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sparsha::test {
namespace {

using Eigen::Vector3d;

double quantile_of(std::vector<double>& values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

double share_of(std::size_t some, std::size_t all) {
  return static_cast<double>(some) / static_cast<double>(std::max<std::size_t>(1, all));
}

}  // namespace

WholeSurface::WholeSurface(const ClosedObject& object, std::size_t points, double cell_m, std::uint64_t seed)
    : cell_m_(cell_m) {
  std::mt19937_64 random(seed);
  points_.reserve(points);
  for (std::size_t k = 0; k < points; ++k) {
    points_.push_back(object.sample(random));
    cells_[key((points_.back().position_m / cell_m_).array().floor().cast<int>())].push_back(
        static_cast<std::uint32_t>(k));
  }
}

std::uint64_t WholeSurface::key(const Eigen::Array3i& cell) const {
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis)
    key = (key << 21U) | (static_cast<std::uint64_t>(cell[axis] + (1 << 20)) & 0x1fffffU);
  return key;
}

template <typename Use>
void WholeSurface::around(const Vector3d& place_m, double reach_m, const Use& use) const {
  const Eigen::Array3i low = ((place_m.array() - reach_m) / cell_m_).floor().cast<int>();
  const Eigen::Array3i high = ((place_m.array() + reach_m) / cell_m_).floor().cast<int>();
  for (int i = low.x(); i <= high.x(); ++i) {
    for (int j = low.y(); j <= high.y(); ++j) {
      for (int k = low.z(); k <= high.z(); ++k) {
        const auto found = cells_.find(key({i, j, k}));
        if (found == cells_.end()) continue;
        for (const std::uint32_t p : found->second) use(points_[p]);
      }
    }
  }
}

const SurfacePoint* WholeSurface::nearest(const Vector3d& place_m, double reach_m) const {
  for (double reach = cell_m_;; reach = std::min(reach_m, 2.0 * reach)) {
    const SurfacePoint* best = nullptr;
    double least = reach * reach;
    around(place_m, reach, [&](const SurfacePoint& p) {
      const double here = (p.position_m - place_m).squaredNorm();
      if (here <= least) {
        least = here;
        best = &p;
      }
    });
    if (best != nullptr || reach >= reach_m) return best;
  }
}

bool WholeSurface::smooth(const Vector3d& place_m, const Vector3d& normal, double radius_m, double cosine) const {
  bool all = true;
  around(place_m, radius_m, [&](const SurfacePoint& p) {
    if ((p.position_m - place_m).squaredNorm() <= radius_m * radius_m && p.normal.dot(normal) < cosine) all = false;
  });
  return all;
}

ChartJudgement judge_charts(const scene::Charts& charts, const WholeSurface& truth, double spacing_m,
                            std::size_t places) {
  constexpr double kLimit = 0.86602540378;  // cosine of 30 degrees
  ChartJudgement result;
  result.sheets = charts.sheets.size();
  struct Node {
    Vector3d place, normal;
    scene::Side side;
  };
  const double cell = 1.5 * spacing_m;
  std::unordered_map<std::uint64_t, std::vector<Node>> nodes;
  const auto key = [&](const Eigen::Array3i& c) {
    return (static_cast<std::uint64_t>(c.x() + 1048576) << 42U) | (static_cast<std::uint64_t>(c.y() + 1048576) << 21U) |
           static_cast<std::uint64_t>(c.z() + 1048576);
  };
  std::vector<double> errors;
  std::size_t wrong = 0, turned = 0, wrong_any = 0, turned_any = 0, near = 0;
  for (const scene::Sheet& sheet : charts.sheets) {
    for (int j = 0; j < sheet.ny; ++j) {
      for (int i = 0; i < sheet.nx; ++i) {
        if (!sheet.measured(sheet.index(i, j))) continue;
        ++result.nodes;
        const Node node{charts.place_m(sheet, i, j) + charts.origin_m, scene::Charts::normal(sheet, i, j), sheet.side};
        nodes[key((node.place / cell).array().floor().cast<int>())].push_back(node);
        const SurfacePoint* nearest = truth.nearest(node.place, 4.0 * spacing_m);
        const double error =
            nearest == nullptr ? 4.0 : std::abs((node.place - nearest->position_m).dot(nearest->normal)) / spacing_m;
        const bool far = nearest == nullptr || (node.place - nearest->position_m).norm() > 3.0 * spacing_m;
        wrong_any += far ? 1 : 0;
        if (!far) ++near;
        const bool away = !far && node.normal.dot(nearest->normal) < 0.0;
        turned_any += away ? 1 : 0;
        if (nearest != nullptr && !truth.smooth(nearest->position_m, nearest->normal, 1.5 * spacing_m, kLimit))
          continue;
        ++result.smooth;
        wrong += far ? 1 : 0;
        turned += away ? 1 : 0;
        errors.push_back(error);
      }
    }
  }
  result.wrong = share_of(wrong, result.smooth);
  result.turned = share_of(turned, result.smooth);
  result.wrong_any = share_of(wrong_any, result.nodes);
  result.turned_any = share_of(turned_any, near);
  result.median = quantile_of(errors, 0.5);
  result.p99 = quantile_of(errors, 0.99);

  std::size_t covered = 0, in_two = 0;
  const std::size_t step = std::max<std::size_t>(1, truth.points().size() / places);
  constexpr double kProbe = 3.0;
  for (std::size_t k = 0; k < truth.points().size(); k += step) {
    const SurfacePoint& p = truth.points()[k];
    const Vector3d centre = p.position_m + kProbe * spacing_m * p.normal;
    if (truth.nearest(centre, 0.98 * kProbe * spacing_m) != nullptr) continue;
    ++result.reachable;
    unsigned sides = 0;
    const Eigen::Array3i at = (p.position_m / cell).array().floor().cast<int>();
    for (int a = -1; a <= 1; ++a) {
      for (int b = -1; b <= 1; ++b) {
        for (int c = -1; c <= 1; ++c) {
          const auto found = nodes.find(key(at + Eigen::Array3i(a, b, c)));
          if (found == nodes.end()) continue;
          for (const Node& node : found->second) {
            if ((node.place - p.position_m).norm() > cell || node.normal.dot(p.normal) < kLimit) continue;
            sides |= 1U << static_cast<unsigned>(node.side);
          }
        }
      }
    }
    covered += sides != 0 ? 1 : 0;
    in_two += (sides & (sides - 1U)) != 0 ? 1 : 0;
  }
  result.covered = share_of(covered, result.reachable);
  result.in_two = share_of(in_two, result.reachable);
  return result;
}

}  // namespace sparsha::test
