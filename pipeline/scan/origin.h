// One origin for all scans of a scene, chosen from the set of points alone.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/files/message.h"
#include "base/numbers/hash.h"

namespace sparsha::pipeline {

/// Keeps the points with the smallest hashes of their coordinates: a uniform sample that depends on the set of points
/// only, not on their order, and that merges. Constant memory.
class PointSample {
 public:
  explicit PointSample(std::size_t size = 4096) : size_(size) {}

  /// `normal`: what goes with the point, see normals().
  void add(const Eigen::Vector3d& point, const Eigen::Vector3f& normal = Eigen::Vector3f::Zero()) {
    const std::uint64_t h = hash(point);
    if (h < threshold_) keep({h, point, normal});
  }
  /// Adds another sample's points, moved by `place`; they keep their hashes, so that scans merge in any order.
  template <typename Place>
  void merge(const PointSample& other, const Place& place) {
    for (const Entry& entry : other.smallest()) {
      if (entry.hash < threshold_) keep({entry.hash, place(entry.point), entry.normal});
    }
  }
  /// For another process, whose sample of other points merges what it is told.
  void write(MessageWriter& message) const;
  void add(MessageReader& message);
  [[nodiscard]] bool empty() const { return kept_.empty(); }
  [[nodiscard]] std::vector<Eigen::Vector3d> points() const;
  /// As they were given, in the order of points().
  [[nodiscard]] std::vector<Eigen::Vector3f> normals() const;

 private:
  struct Entry {
    std::uint64_t hash;
    Eigen::Vector3d point;
    Eigen::Vector3f normal;
  };
  static bool before(const Entry& a, const Entry& b);
  static std::uint64_t hash(const Eigen::Vector3d& point) {
    // -0.0 and 0.0 are the same point.
    const auto x = std::bit_cast<std::uint64_t>(point.x() + 0.0);
    const auto y = std::bit_cast<std::uint64_t>(point.y() + 0.0);
    const auto z = std::bit_cast<std::uint64_t>(point.z() + 0.0);
    return hash_words(std::array<std::uint64_t, 3>{x, y, z});
  }
  void keep(const Entry& entry);
  [[nodiscard]] std::vector<Entry> smallest() const;

  std::size_t size_;
  std::vector<Entry> kept_;
  std::uint64_t threshold_ = ~std::uint64_t{0};
};

/// Coordinate of that rank (0 to 1) along an axis. There must be points.
[[nodiscard]] double coordinate_quantile(const std::vector<Eigen::Vector3d>& points, int axis, double rank);

/// Distance of `points` points that lie evenly on a surface as large as the sample's box without its outliers. There
/// must be a sample.
[[nodiscard]] double distance_by_extent(const std::vector<Eigen::Vector3d>& sample, std::uint64_t points);

/// The median of the sample in whole metres.
[[nodiscard]] Eigen::Vector3d common_origin(const PointSample& sample);

}  // namespace sparsha::pipeline
