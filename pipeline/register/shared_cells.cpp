// A hash of cells, each with the scans that have elements there.
#include "pipeline/register/shared_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "base/numbers/hash.h"
#include "pipeline/register/graph.h"

namespace sparsha::pipeline {
namespace {

using Cell = std::array<std::int64_t, 3>;
struct Hash {
  std::size_t operator()(const Cell& cell) const noexcept { return static_cast<std::size_t>(hash_cell(cell)); }
};
using ScansOfCells = std::unordered_map<Cell, std::vector<std::size_t>, Hash>;

Cell cell_of(const Eigen::Vector3d& point, double cell_m) {
  Cell cell;
  for (int axis = 0; axis < 3; ++axis)
    cell.at(static_cast<std::size_t>(axis)) = static_cast<std::int64_t>(std::floor(point[axis] / cell_m));
  return cell;
}

// The scans of the cell and of the 26 around it, each once.
void scans_about(const ScansOfCells& cells, const Cell& middle, std::vector<std::size_t>& scans) {
  scans.clear();
  for (std::int64_t x = -1; x <= 1; ++x) {
    for (std::int64_t y = -1; y <= 1; ++y) {
      for (std::int64_t z = -1; z <= 1; ++z) {
        const auto found = cells.find({middle[0] + x, middle[1] + y, middle[2] + z});
        if (found != cells.end()) scans.insert(scans.end(), found->second.begin(), found->second.end());
      }
    }
  }
  std::ranges::sort(scans);
  scans.erase(std::unique(scans.begin(), scans.end()), scans.end());
}

}  // namespace

SharedCells::SharedCells(const std::vector<PosedScan>& scans, double cell_m)
    : scans_(scans.size()), shares_(scans.size() * scans.size(), 0.0) {
  ScansOfCells cells;
  for (std::size_t s = 0; s < scans_; ++s) {
    for (const StationSurface::Element& element : scans[s].coarse->elements()) {
      std::vector<std::size_t>& here = cells[cell_of(scans[s].pose * element.point, cell_m)];
      if (here.empty() || here.back() != s) here.push_back(s);
    }
  }
  std::vector<std::size_t> others;
  for (std::size_t s = 0; s < scans_; ++s) {
    const auto& elements = scans[s].coarse->elements();
    for (const StationSurface::Element& element : elements) {
      scans_about(cells, cell_of(scans[s].pose * element.point, cell_m), others);
      for (const std::size_t other : others) shares_[s * scans_ + other] += 1.0 / static_cast<double>(elements.size());
    }
  }
}

double SharedCells::share(std::size_t a, std::size_t b) const {
  return std::max(shares_[a * scans_ + b], shares_[b * scans_ + a]);
}

std::vector<Edge> SharedCells::best_pairs(std::size_t most) const {
  std::vector<WeighedEdge> edges;
  for (std::size_t a = 0; a < scans_; ++a)
    for (std::size_t b = a + 1; b < scans_; ++b)
      if (share(a, b) > 0.0) edges.push_back({{a, b}, share(a, b)});
  std::vector<bool> chosen(edges.size(), false);
  std::size_t count = 0;
  const auto choose = [&](std::size_t k) {
    if (chosen[k] || count >= most) return;
    chosen[k] = true;
    ++count;
  };
  for (const std::size_t k : heaviest_tree(scans_, edges).edges) choose(k);
  std::vector<std::size_t> by_weight(edges.size());
  for (std::size_t k = 0; k < edges.size(); ++k) by_weight[k] = k;
  std::ranges::stable_sort(by_weight, [&](std::size_t a, std::size_t b) { return edges[a].weight > edges[b].weight; });
  std::vector<std::vector<std::size_t>> of_scan(scans_);
  for (const std::size_t k : by_weight) {
    of_scan[edges[k].edge.a].push_back(k);
    of_scan[edges[k].edge.b].push_back(k);
  }
  for (std::size_t rank = 0; rank + 1 < scans_ && count < most; ++rank)
    for (const std::vector<std::size_t>& own : of_scan)
      if (rank < own.size()) choose(own[rank]);
  std::vector<Edge> result;
  for (std::size_t k = 0; k < edges.size(); ++k)
    if (chosen[k]) result.push_back(edges[k].edge);
  return result;
}

}  // namespace sparsha::pipeline
