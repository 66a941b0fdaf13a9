#include "scene/solid/surface_nodes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace sparsha::scene {

std::uint64_t SurfaceNodes::key_of(const Eigen::Vector3i& cube) {
  constexpr std::int64_t kHalf = 1 << 20;
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis)
    key = key << 21U | static_cast<std::uint64_t>(std::clamp<std::int64_t>(cube[axis] + kHalf, 0, 2 * kHalf - 1));
  return key;
}

int SurfaceNodes::stride_within(double reach_m, double spacing_m) {
  constexpr int kMostNodes = 8;
  return std::max(1, static_cast<int>(std::floor(reach_m / (kMostNodes * spacing_m))));
}

// No other side faces the place better where both slopes are at most one.
bool SurfaceNodes::counts(const Sheet& sheet, int i, int j, int stride) {
  const std::size_t node = sheet.index(i, j);
  const auto on_stride = [stride](int at) { return ((at % stride) + stride) % stride == 0; };
  return sheet.measured(node) && std::abs(sheet.slope_u[node]) <= 1.0F && std::abs(sheet.slope_v[node]) <= 1.0F &&
         on_stride(sheet.first_u + i) && on_stride(sheet.first_v + j);
}

double SurfaceNodes::area_of(const Sheet& sheet, std::size_t node) {
  return std::hypot(1.0, static_cast<double>(sheet.slope_u[node]), static_cast<double>(sheet.slope_v[node]));
}

void SurfaceNodes::sort() {
  std::vector<std::pair<std::uint64_t, std::size_t>> order(nodes_.size());
  for (std::size_t n = 0; n < nodes_.size(); ++n) order[n] = {key_of(cube_of(nodes_[n].place_m)), n};
  std::sort(order.begin(), order.end());
  std::vector<SurfaceNode> sorted;
  sorted.reserve(nodes_.size());
  for (const auto& [key, n] : order) {
    if (keys_.empty() || keys_.back() != key) {
      keys_.push_back(key);
      begins_.push_back(sorted.size());
    }
    sorted.push_back(nodes_[n]);
  }
  begins_.push_back(sorted.size());
  nodes_ = std::move(sorted);
}

void SurfaceNodes::near(const Eigen::Vector3i& cube, std::vector<SurfaceNode>& found) const {
  found.clear();
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        const std::uint64_t key = key_of(cube + Eigen::Vector3i(x, y, z));
        const auto at = std::lower_bound(keys_.begin(), keys_.end(), key);
        if (at == keys_.end() || *at != key) continue;
        const auto number = static_cast<std::size_t>(at - keys_.begin());
        found.insert(found.end(), nodes_.begin() + static_cast<std::ptrdiff_t>(begins_[number]),
                     nodes_.begin() + static_cast<std::ptrdiff_t>(begins_[number + 1]));
      }
}

}  // namespace sparsha::scene
