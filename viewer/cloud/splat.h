// Points to pixels on the processor: a z-buffer of 64-bit words, several threads, any number of points. The picture
// depends neither on the number of threads nor on the graphics driver.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "base/threads/thread_pool.h"
#include "viewer/cloud/point_view.h"

namespace sparsha::viewer {

/// Parallel projection along the grid's z: what the depth scan sees.
struct SplatView {
  Eigen::Matrix3d scan_to_view = Eigen::Matrix3d::Identity();  ///< the orientation's linear part
  Eigen::Vector3d target_m = Eigen::Vector3d::Zero();          ///< in the middle of the picture; as PointView::points
  double pixels_per_m = 1.0;                                   ///< of the grid frame
  int width = 1;
  int height = 1;

  /// From the top left, and height in pixels above the target.
  [[nodiscard]] Eigen::Vector3d to_pixel(const Eigen::Vector3d& point_m) const;
  /// Whether points in this box may be in the picture; as PointView::points.
  [[nodiscard]] bool sees(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m) const;
  friend bool operator==(const SplatView& a, const SplatView& b) {
    return a.scan_to_view == b.scan_to_view && a.target_m == b.target_m && a.pixels_per_m == b.pixels_per_m &&
           a.width == b.width && a.height == b.height;
  }
};

/// How colours come to points.
struct SplatColours {
  std::span<const std::uint32_t> point;    ///< 0xAABBGGRR, one per point; empty: by height
  std::span<const std::uint32_t> heights;  ///< with an empty `point`: a map for heights from low_m to high_m
  double low_m = 0.0;                      ///< grid frame, relative to the target
  double high_m = 1.0;
};

/// Points outside are left out.
struct SplatCrop {
  Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::lowest());
  Eigen::Vector3f high = Eigen::Vector3f::Constant(std::numeric_limits<float>::max());
};

class Splatter {
 public:
  explicit Splatter(ThreadPool& pool) : pool_(pool) {}

  /// An empty picture.
  void clear(const SplatView& view);
  /// Adds the points [from, to) of every block that the view sees, as shares of it (0 to 1), each as a square of
  /// `size` pixels. Returns how many points were gone through.
  std::uint64_t add(const PointView& points, const SplatColours& colours, const SplatCrop& crop, double from, double to,
                    int size);
  /// Points in blocks that the view sees.
  [[nodiscard]] std::uint64_t visible(const PointView& points) const;

  /// First row at the bottom. Heights in pixels above the target; empty pixels are kEmpty.
  static constexpr float kEmpty = -1e30F;
  void read(std::vector<std::uint32_t>& rgba, std::vector<float>& heights) const;

 private:
  ThreadPool& pool_;
  SplatView view_;
  std::vector<std::vector<std::uint64_t>> layers_;  ///< one a thread; the larger word wins
};

}  // namespace sparsha::viewer
