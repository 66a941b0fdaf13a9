// A line on the stone that a hand can be led along.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace sparsha::haptics {

/// Corners of a line on a whole object, grid frame.
struct PathCorner {
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< outward, unit; where surfaces meet in an edge, between theirs
};

/// Corners in the grid frame, metres, straight between them: across one view, with z = 0, or on the surface of a whole
/// object. Immutable once made; made off the servo thread, read by it.
class GuidePath {
 public:
  /// Across one view. Corners that repeat the one before are left out; a line whose last corner is its first is closed.
  /// Throws Error{failure} for fewer than two different corners and for places that are not numbers.
  explicit GuidePath(const std::vector<Eigen::Vector2d>& corners_m);
  /// The same on a whole object.
  explicit GuidePath(const std::vector<PathCorner>& corners);

  [[nodiscard]] bool closed() const noexcept { return closed_; }
  /// On the surface of a whole object?
  [[nodiscard]] bool in_space() const noexcept { return in_space_; }
  [[nodiscard]] double length_m() const noexcept { return along_m_.back(); }
  /// Straight pieces; piece k lies between corner(k) and corner(k + 1).
  [[nodiscard]] std::size_t pieces() const noexcept { return corners_m_.size() - 1; }
  /// Of a closed line the last corner is the first once more.
  [[nodiscard]] const Eigen::Vector3d& corner(std::size_t k) const noexcept { return corners_m_[k]; }
  /// Length of the line up to corner k.
  [[nodiscard]] double along_m(std::size_t k) const noexcept { return along_m_[k]; }

  /// A place of the line: a piece and a share of it, 0 to 1.
  struct Place {
    std::size_t piece = 0;
    double share = 0.0;
  };
  /// The place of a piece that is nearest to a point.
  [[nodiscard]] Place nearest_on(std::size_t piece, const Eigen::Vector3d& point_m) const noexcept;
  /// The same among `count` pieces from `first` on.
  [[nodiscard]] Place nearest_among(std::size_t first, std::size_t count,
                                    const Eigen::Vector3d& point_m) const noexcept;
  [[nodiscard]] Eigen::Vector3d point_m(const Place& place) const noexcept;
  /// Outward normal of the stone there, unit; across one view +z.
  [[nodiscard]] Eigen::Vector3d normal(const Place& place) const noexcept;
  [[nodiscard]] double along_m(const Place& place) const noexcept;
  /// Unit, towards the end of the line.
  [[nodiscard]] Eigen::Vector3d direction(std::size_t piece) const noexcept;

 private:
  void add(const PathCorner& corner);
  void finish();

  std::vector<Eigen::Vector3d> corners_m_;
  std::vector<Eigen::Vector3d> normals_;  // of a line in space
  std::vector<double> along_m_;
  bool closed_ = false;
  bool in_space_ = false;
};

/// A line, and how a hand is led along it; both limits are at the hand.
struct Guide {
  GuidePath path;
  double force_n = 1.0;
  double speed_m_per_s = 0.04;
};

}  // namespace sparsha::haptics
