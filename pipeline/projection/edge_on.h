// Points of surfaces that a view shows edge-on: a floor under a statue, the side of a box. A height field has no place
// for them, so that they say nothing against it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "base/numbers/hash.h"
#include "base/numbers/key_table.h"
#include "base/threads/thread_pool.h"
#include "pipeline/projection/bins.h"
#include "pipeline/projection/points.h"
#include "pipeline/projection/projection.h"

namespace sparsha::pipeline {

/// Space in cubes a few distances between points wide; each keeps the moments of the outliers in it, as integers, so
/// that neither the order of the points nor how they are cut into pieces changes a result. Where the outliers of three
/// by three by three cubes are many and lie on a plane (principal axes of their covariance) along the line of sight,
/// they are a surface seen edge-on; scattered ones are neither so many nor so thin. For one thread at a time.
class EdgeOnSurfaces {
 public:
  EdgeOnSurfaces(const BinLattice& lattice, double point_spacing_m);

  /// Adds the outliers among the points.
  void add(const OrientedPoints& points, const PointClass* point_class);

  /// Outliers on a surface seen edge-on become occluded; returns how many. All outliers within rows_needed() of the
  /// points' rows of bins must have been added.
  [[nodiscard]] std::uint64_t take_out(const OrientedPoints& points, PointClass* point_class, ThreadPool& pool);

  /// Of the direction in which most points of such surfaces lie, so far: unit normal, grid frame, towards the middle of
  /// the lattice; zero when there are none, or no direction has many of them, as on the rim of a dome.
  [[nodiscard]] Eigen::Vector3d main_normal() const;

  /// Rows of bins, to each side, on which the answer for a point depends.
  [[nodiscard]] int rows_needed() const { return 3 * bins_per_cube_; }
  /// Rows of bins before this will not be needed any more.
  void forget_before(int bin_row);

 private:
  using Key = std::array<std::int64_t, 3>;
  struct KeyHash {
    std::uint64_t operator()(const Key& key) const { return hash_cell(key); }
  };
  /// About the cube's lower corner, in steps of a cube / kSteps.
  struct Moments {
    std::int64_t count = 0;
    std::array<std::int64_t, 3> first{};
    std::array<std::int64_t, 6> second{};  ///< xx xy xz yy yz zz
  };
  struct Cube {
    Key key{};
    Moments moments;
    /// In cubes from its lower corner: |normal . p - offset| <= within; within 0 when it is no surface seen edge-on.
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double offset = 0.0;
    double within = 0.0;
  };
  struct Row {
    KeyTable<Cube, KeyHash> cubes;
    bool decided = false;
  };
  struct Place {
    Key key;
    Eigen::Vector3d inside;  ///< 0 to 1, from the cube's lower corner
  };

  [[nodiscard]] bool find_place(const OrientedPoints& points, std::size_t k, Place& place) const;
  [[nodiscard]] const Cube* cube(const Key& key) const;
  [[nodiscard]] Moments around(const Key& key) const;
  void decide(Cube& cube) const;
  void decide_rows(std::int64_t first, std::int64_t last, ThreadPool& pool);
  void count_direction(const Cube& cube);
  [[nodiscard]] bool on_a_surface(const Place& place) const;

  BinLocator locator_;
  int bins_per_cube_;
  float per_cube_m_;
  Eigen::Vector2d middle_;            ///< of the lattice, cubes
  std::map<std::int64_t, Row> rows_;  ///< by the second component of the keys

  static constexpr std::size_t kDirections = 36;  ///< of normals along the picture, over half a turn
  /// Integers: weighted sums of normals, and of places from the middle of the lattice along them.
  struct Direction {
    std::int64_t points = 0;
    std::array<std::int64_t, 3> normal{};
    std::int64_t place = 0;
  };
  std::array<Direction, kDirections> directions_{};
};

/// Writes what was found so far into the projection; `points` were taken out.
void add_edge_on(std::uint64_t points, const Eigen::Vector3d& normal, const Eigen::Matrix4d& scan_to_grid,
                 Projection& projection);

}  // namespace sparsha::pipeline
