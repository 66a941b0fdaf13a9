// A coarse lattice in space: cells that hold something, joined with their neighbours.
#include "pipeline/scan/pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "pipeline/scan/origin.h"

namespace sparsha::pipeline {
namespace {

constexpr int kMeshCells = 64;   // along the longest side
constexpr int kPointCells = 32;  // the same, at most
constexpr std::uint32_t kEmpty = ~std::uint32_t{0};
constexpr std::uint32_t kOpen = kEmpty - 1;

class Cells {
 public:
  Cells(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double size) : low_(low), size_(size) {
    for (int axis = 0; axis < 3; ++axis) count_[axis] = static_cast<int>((high - low)[axis] / size) + 1;
    label_.assign(static_cast<std::size_t>(count_.x()) * static_cast<std::size_t>(count_.y()) *
                      static_cast<std::size_t>(count_.z()),
                  kEmpty);
  }
  [[nodiscard]] double size() const { return size_; }
  [[nodiscard]] Eigen::Vector3i cell_of(const Eigen::Vector3d& p) const {
    Eigen::Vector3i cell;
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = std::clamp(static_cast<int>((p[axis] - low_[axis]) / size_), 0, count_[axis] - 1);
    return cell;
  }
  void mark(const Eigen::Vector3i& cell) { label_[index(cell)] = kOpen; }
  [[nodiscard]] std::uint32_t group_of(const Eigen::Vector3d& p) const { return label_[index(cell_of(p))]; }

  /// Cells that the triangle may pass; returns how many were looked at.
  std::uint64_t mark_triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    const Eigen::Vector3i from = cell_of(a.cwiseMin(b).cwiseMin(c));
    const Eigen::Vector3i to = cell_of(a.cwiseMax(b).cwiseMax(c));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const double half = 0.5 * size_ * normal.cwiseAbs().sum();
    const bool small = (to - from).maxCoeff() <= 1;
    for (int z = from.z(); z <= to.z(); ++z)
      for (int y = from.y(); y <= to.y(); ++y)
        for (int x = from.x(); x <= to.x(); ++x) {
          const Eigen::Vector3d middle = low_ + size_ * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5);
          if (small || std::abs(normal.dot(middle - a)) <= 1.001 * half) mark({x, y, z});
        }
    return static_cast<std::uint64_t>((to - from + Eigen::Vector3i::Ones()).cast<std::int64_t>().prod());
  }

  /// Numbers the groups of marked cells that touch; returns how many.
  std::uint32_t label_groups() {
    std::uint32_t groups = 0;
    std::vector<Eigen::Vector3i> open;
    for (std::size_t n = 0; n < label_.size(); ++n) {
      if (label_[n] != kOpen) continue;
      label_[n] = groups;
      open.assign(1, place(n));
      while (!open.empty()) {
        const Eigen::Vector3i here = open.back();
        open.pop_back();
        each_neighbour(here, [&](const Eigen::Vector3i& cell) {
          if (label_[index(cell)] != kOpen) return;
          label_[index(cell)] = groups;
          open.push_back(cell);
        });
      }
      ++groups;
    }
    return groups;
  }

  /// Cells between a group and the nearest of the others that count.
  [[nodiscard]] int cells_between(std::uint32_t group, const std::vector<bool>& counts) const {
    std::vector<bool> seen(label_.size(), false);
    std::vector<Eigen::Vector3i> front;
    for (std::size_t n = 0; n < label_.size(); ++n) {
      if (label_[n] != group) continue;
      seen[n] = true;
      front.push_back(place(n));
    }
    std::vector<Eigen::Vector3i> next;
    for (int away = 0; !front.empty(); ++away) {
      bool reached = false;
      next.clear();
      for (const Eigen::Vector3i& here : front)
        each_neighbour(here, [&](const Eigen::Vector3i& cell) {
          const std::size_t n = index(cell);
          if (seen[n]) return;
          seen[n] = true;
          reached = reached || (label_[n] < counts.size() && counts[label_[n]]);
          next.push_back(cell);
        });
      if (reached) return away;
      front.swap(next);
    }
    return 0;
  }

 private:
  [[nodiscard]] std::size_t index(const Eigen::Vector3i& cell) const {
    return (static_cast<std::size_t>(cell.z()) * static_cast<std::size_t>(count_.y()) +
            static_cast<std::size_t>(cell.y())) *
               static_cast<std::size_t>(count_.x()) +
           static_cast<std::size_t>(cell.x());
  }
  [[nodiscard]] Eigen::Vector3i place(std::size_t n) const {
    const auto nx = static_cast<std::size_t>(count_.x());
    const auto ny = static_cast<std::size_t>(count_.y());
    return {static_cast<int>(n % nx), static_cast<int>(n / nx % ny), static_cast<int>(n / nx / ny)};
  }
  template <typename Use>
  void each_neighbour(const Eigen::Vector3i& cell, const Use& use) const {
    for (int n = 0; n < 27; ++n) {
      const Eigen::Vector3i other = cell + Eigen::Vector3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
      if (n != 13 && (other.array() >= 0).all() && (other.array() < count_.array()).all()) use(other);
    }
  }

  Eigen::Vector3d low_;
  double size_;
  Eigen::Vector3i count_;
  std::vector<std::uint32_t> label_;
};

struct Box {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;

  void add(const Eigen::Vector3d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  [[nodiscard]] double longest() const { return (high - low).maxCoeff(); }
};

/// Groups of the marked cells with at least `least` of the points, apart by at least `between` cells.
template <typename Points>
std::optional<Pieces> pieces_of(Cells& cells, const Points& points, double least, int between) {
  const std::uint32_t groups = cells.label_groups();
  if (groups < 2) return std::nullopt;
  std::vector<std::uint64_t> held(groups, 0);
  for (const Eigen::Vector3d& p : points) {
    if (const std::uint32_t group = cells.group_of(p); group < groups) ++held[group];
  }
  const auto all = static_cast<double>(points.size());
  std::vector<bool> counts(groups);
  Pieces pieces;
  std::uint32_t largest = 0;
  for (std::uint32_t g = 0; g < groups; ++g) {
    counts[g] = static_cast<double>(held[g]) >= least * all;
    pieces.count += counts[g] ? 1 : 0;
    if (held[g] > held[largest]) largest = g;
  }
  if (pieces.count < 2) return std::nullopt;
  counts[largest] = false;
  const int away = cells.cells_between(largest, counts);
  if (away < between) return std::nullopt;
  pieces.apart = away * cells.size();
  pieces.largest_share = static_cast<double>(held[largest]) / all;
  return pieces;
}

bool is_usable(const Box& box) { return box.longest() > 0.0 && box.longest() < 1e300; }

}  // namespace

std::optional<Pieces> pieces_of_mesh(const RawScan& scan) {
  Box box;
  for (const auto& face : scan.faces)
    for (const std::uint32_t v : face) box.add(scan.points[v]);
  if (!is_usable(box)) return std::nullopt;
  Cells cells(box.low, box.high, box.longest() / kMeshCells);
  // A surface fills some tens of thousands of cells. Millions of triangles across all of them, one on another, are no
  // surface, and would take minutes.
  constexpr std::uint64_t kMostVisits = 200'000'000;
  std::uint64_t visits = 0;
  for (const auto& [a, b, c] : scan.faces) {
    visits += cells.mark_triangle(scan.points[a], scan.points[b], scan.points[c]);
    if (visits > kMostVisits) return std::nullopt;
  }
  return pieces_of(cells, scan.points, 0.0, 1);
}

std::optional<Pieces> pieces_of_points(const std::vector<Eigen::Vector3d>& sample) {
  constexpr std::size_t kFewest = 100;
  constexpr double kLeast = 0.01;
  constexpr double kDistances = 4.0;
  if (sample.size() < kFewest) return std::nullopt;
  Box box;
  for (const Eigen::Vector3d& p : sample) box.add(p);
  const double apart = distance_by_extent(sample, sample.size());
  if (!is_usable(box) || !(apart > 0.0)) return std::nullopt;
  // Far outliers make cells wide, and so hide pieces rather than invent them.
  Cells cells(box.low, box.high, std::max(box.longest() / kPointCells, kDistances * apart));
  for (const Eigen::Vector3d& p : sample) cells.mark(cells.cell_of(p));
  return pieces_of(cells, sample, kLeast, 2);
}

bool apart_together(std::size_t scans, const std::vector<Eigen::Vector3d>& sample) {
  return scans == 1 || pieces_of_points(sample).has_value();
}

}  // namespace sparsha::pipeline
