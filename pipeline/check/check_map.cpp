// Sums over blocks of nodes, then over squares of blocks by prefix sums.
#include "pipeline/check/check_map.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace sparsha::pipeline {
namespace {

constexpr double kSamplesPerSpot = 4.0;
constexpr int kWidestSpot = 64;  // blocks to each side

/// Sums over rectangles of blocks.
class Prefix {
 public:
  Prefix(int nx, int ny)
      : nx_(nx), ny_(ny), sum_((static_cast<std::size_t>(nx) + 1) * (static_cast<std::size_t>(ny) + 1), 0.0) {}
  [[nodiscard]] double& value(int i, int j) { return sum_[at(i + 1, j + 1)]; }
  void integrate() {
    for (int j = 1; j <= ny_; ++j)
      for (int i = 1; i <= nx_; ++i) sum_[at(i, j)] += sum_[at(i - 1, j)] + sum_[at(i, j - 1)] - sum_[at(i - 1, j - 1)];
  }
  [[nodiscard]] double over(int i0, int j0, int i1, int j1) const {
    i0 = std::max(i0, 0);
    j0 = std::max(j0, 0);
    i1 = std::min(i1, nx_ - 1);
    j1 = std::min(j1, ny_ - 1);
    return sum_[at(i1 + 1, j1 + 1)] - sum_[at(i0, j1 + 1)] - sum_[at(i1 + 1, j0)] + sum_[at(i0, j0)];
  }

 private:
  [[nodiscard]] std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(j) * (static_cast<std::size_t>(nx_) + 1) + static_cast<std::size_t>(i);
  }
  int nx_, ny_;
  std::vector<double> sum_;
};

}  // namespace

std::shared_ptr<const scene::CheckMap> check_map_of(const scene::DepthGrid& grid, const CheckResult& check) {
  const scene::Lattice& fine = grid.lattice;
  if (check.cloud_to_surface.samples == 0) return nullptr;
  const int factor =
      std::max(1, (std::max(fine.nx, fine.ny) + scene::CheckMap::kMostNodes - 1) / scene::CheckMap::kMostNodes);
  auto map = std::make_shared<scene::CheckMap>();
  scene::Lattice& lattice = map->lattice;
  lattice = fine;
  lattice.nx = (fine.nx + factor - 1) / factor;
  lattice.ny = (fine.ny + factor - 1) / factor;
  lattice.spacing_m = factor * fine.spacing_m;
  lattice.origin_m.head<2>().array() += 0.5 * (factor - 1) * fine.spacing_m;  // the middle of a block
  map->high_m = check.cloud_to_surface.p95_m;

  Prefix sums(lattice.nx, lattice.ny), counts(lattice.nx, lattice.ny);
  std::vector<std::uint8_t> known(lattice.count(), 0);
  for (int j = 0; j < fine.ny; ++j)
    for (int i = 0; i < fine.nx; ++i) {
      if (grid.state[fine.index(i, j)] == scene::NodeState::unknown) continue;
      known[lattice.index(i / factor, j / factor)] = 1;
    }
  const NodeErrors& errors = check.node_errors;
  const auto judged = static_cast<double>(errors.node.size());
  for (std::size_t k = 0; k < errors.node.size(); ++k) {
    const auto nx = static_cast<std::uint64_t>(fine.nx);
    const int i = static_cast<int>(errors.node[k] % nx) / factor, j = static_cast<int>(errors.node[k] / nx) / factor;
    sums.value(i, j) += static_cast<double>(errors.error_m[k]);
    counts.value(i, j) += 1.0;
  }
  sums.integrate();
  counts.integrate();
  const double places = static_cast<double>(std::count(known.begin(), known.end(), 1));
  const int reach =
      std::clamp(static_cast<int>(std::ceil((std::sqrt(kSamplesPerSpot * places / std::max(judged, 1.0)) - 1.0) / 2.0)),
                 0, kWidestSpot);
  map->error_m.assign(lattice.count(), scene::kUnknownHeight);
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const double count = counts.over(i - reach, j - reach, i + reach, j + reach);
      if (known[lattice.index(i, j)] == 0 || count <= 0.5) continue;
      map->error_m[lattice.index(i, j)] =
          static_cast<float>(sums.over(i - reach, j - reach, i + reach, j + reach) / count);
    }
  return map;
}

}  // namespace sparsha::pipeline
