// The points of one scan with local planes and a kd-tree: what alignment compares. Doubles relative to the scan's
// origin.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "base/numbers/hash.h"
#include "base/threads/context.h"

namespace sparsha::pipeline {

/// Points of one thinning. A point whose neighbourhood is no surface (an outlier, a line) has the normal 0 and is not
/// compared. Normals have no sign unless `place` of the scanner is known: then they face it.
class StationSurface {
 public:
  /// `points` in metres. Throws Cancelled.
  StationSurface(std::vector<Eigen::Vector3d> points, const std::optional<Eigen::Vector3d>& place,
                 const Context& context);
  ~StationSurface();
  StationSurface(const StationSurface&) = delete;
  StationSurface& operator=(const StationSurface&) = delete;

  struct Element {
    Eigen::Vector3d point;                             ///< as thinned
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, or 0
    bool border = false;                               ///< where the scan ends: its neighbours lie to one side
  };
  [[nodiscard]] const std::vector<Element>& elements() const { return elements_; }
  [[nodiscard]] double spacing_m() const { return spacing_m_; }  ///< median distance to the nearest neighbour
  /// Standard deviation of points across their local planes, median: noise, and form within a neighbourhood.
  [[nodiscard]] double roughness_m() const { return roughness_m_; }
  [[nodiscard]] bool signed_normals() const { return signed_; }

  /// Makes all normals face the other side.
  void flip();

  struct Nearest {
    std::size_t index = 0;
    double distance2 = 0.0;  ///< metres squared
  };
  /// The nearest element of any kind within a distance; index = elements().size() when there is none. Thread-safe.
  [[nodiscard]] Nearest nearest(const Eigen::Vector3d& point, double within_m) const;

 private:
  struct Tree;
  /// The deviation across the plane; nothing where there is none.
  std::optional<double> fit(std::size_t index, const std::optional<Eigen::Vector3d>& place);

  std::vector<Element> elements_;
  std::unique_ptr<Tree> tree_;
  double spacing_m_ = 0.0;
  double roughness_m_ = 0.0;
  bool signed_ = false;
};

/// Distances of some of the points, evenly chosen, to their nearest neighbour.
[[nodiscard]] std::vector<double> nearest_distances(const std::vector<Eigen::Vector3d>& points);

/// One point a voxel, the mean of those in it. Voxels are multiples of `leaf_m`; memory grows with them only.
class VoxelMeans {
 public:
  explicit VoxelMeans(double leaf_m) : leaf_m_(leaf_m) {}
  void add(const Eigen::Vector3d& point);
  [[nodiscard]] std::size_t size() const { return sums_.size(); }
  /// Ordered by voxel.
  [[nodiscard]] std::vector<Eigen::Vector3d> points() const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Sum {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0.0;
  };
  struct Hash {
    std::size_t operator()(const Cell& cell) const noexcept { return static_cast<std::size_t>(hash_cell(cell)); }
  };
  double leaf_m_;
  std::unordered_map<Cell, Sum, Hash> sums_;
};

[[nodiscard]] std::vector<Eigen::Vector3d> thinned(const std::vector<Eigen::Vector3d>& points, double leaf_m);
/// Thinned so far that at most `most` points are left, by leaves that grow from `least_leaf_m` on.
[[nodiscard]] std::vector<Eigen::Vector3d> thinned_to(const std::vector<Eigen::Vector3d>& points, std::size_t most,
                                                      double least_leaf_m);

}  // namespace sparsha::pipeline
