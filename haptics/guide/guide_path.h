// A line on the stone that a hand can be led along.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace sparsha::haptics {

/// Corners across the stone, grid frame, metres, straight between them. Immutable once made; made off the servo
/// thread, read by it.
class GuidePath {
 public:
  /// Corners that repeat the one before are left out; a line whose last corner is its first is closed. Throws
  /// Error{failure} for fewer than two different corners and for places that are not numbers.
  explicit GuidePath(const std::vector<Eigen::Vector2d>& corners_m);

  [[nodiscard]] bool closed() const noexcept { return closed_; }
  [[nodiscard]] double length_m() const noexcept { return along_m_.back(); }
  /// Straight pieces; piece k lies between corner(k) and corner(k + 1).
  [[nodiscard]] std::size_t pieces() const noexcept { return corners_m_.size() - 1; }
  /// Of a closed line the last corner is the first once more.
  [[nodiscard]] const Eigen::Vector2d& corner(std::size_t k) const noexcept { return corners_m_[k]; }
  /// Length of the line up to corner k.
  [[nodiscard]] double along_m(std::size_t k) const noexcept { return along_m_[k]; }

  /// A place of the line: a piece and a share of it, 0 to 1.
  struct Place {
    std::size_t piece = 0;
    double share = 0.0;
  };
  /// The place of a piece that is nearest to a point.
  [[nodiscard]] Place nearest_on(std::size_t piece, const Eigen::Vector2d& point_m) const noexcept;
  /// The same among `count` pieces from `first` on.
  [[nodiscard]] Place nearest_among(std::size_t first, std::size_t count,
                                    const Eigen::Vector2d& point_m) const noexcept;
  [[nodiscard]] Eigen::Vector2d point_m(const Place& place) const noexcept;
  [[nodiscard]] double along_m(const Place& place) const noexcept;
  /// Unit, towards the end of the line.
  [[nodiscard]] Eigen::Vector2d direction(std::size_t piece) const noexcept;

 private:
  std::vector<Eigen::Vector2d> corners_m_;
  std::vector<double> along_m_;
  bool closed_ = false;
};

/// A line, and how a hand is led along it; both limits are at the hand.
struct Guide {
  GuidePath path;
  double force_n = 1.0;
  double speed_m_per_s = 0.04;
};

}  // namespace sparsha::haptics
