// A cloud of PCL's, seen from one side: z = f(x, y) on a regular lattice.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <pcl/pcl_base.h>
#include <Eigen/Geometry>

#include "scene/depth_grid.h"

namespace sparsha {

/// What became of a point: `invalid` are those that are not finite or that setIndices left out.
enum class ProjectedPoint : std::uint8_t { used, occluded, outlier, outside, invalid };

/// Projects the front of a cloud, as seen along -z of the grid frame, onto a depth grid. Front and back are told apart,
/// outliers left out, nodes without enough points stay unknown: as `sparsha build` does it, with the same heights.
/// Lengths are metres. The result depends neither on threads nor on the order of the points. One thread at a time.
/// Instantiated for the types that conversions.h names; for others include impl/monge_projection.hpp.
template <typename PointT>
class MongeProjection : public ::pcl::PCLBase<PointT> {
 public:
  using Base = ::pcl::PCLBase<PointT>;

  /// grid = orientation * cloud; invertible, affine. The viewer looks along -z with +y up. Default: identity.
  void setOrientation(const Eigen::Affine3d& orientation) { orientation_ = orientation; }
  [[nodiscard]] const Eigen::Affine3d& getOrientation() const { return orientation_; }

  /// Distance of nodes; 0, the default: chosen by how dense the points are, but see setSize.
  void setSpacing(double spacing_m) { spacing_m_ = spacing_m; }
  [[nodiscard]] double getSpacing() const { return spacing_m_; }
  /// Nodes along the longer side, instead of a spacing; 0: not given.
  void setSize(int nodes) { size_ = nodes; }
  [[nodiscard]] int getSize() const { return size_; }
  /// xmin, ymin, xmax, ymax in the grid frame. Default: what encloses the front.
  void setBounds(const std::array<double, 4>& bounds_m) { bounds_m_ = {bounds_m.begin(), bounds_m.end()}; }
  void resetBounds() { bounds_m_.clear(); }

  /// Standard deviation of the points across the surface; 0, the default: estimated.
  void setNoise(double noise_m) { noise_m_ = noise_m; }
  /// What was subtracted from the coordinates before they became float32. Default: zero.
  void setOrigin(const Eigen::Vector3d& origin_m) { origin_m_ = origin_m; }
  [[nodiscard]] const Eigen::Vector3d& getOrigin() const { return origin_m_; }
  /// 0, the default: one per core.
  void setNumberOfThreads(unsigned threads) { threads_ = threads; }

  /// Throws sparsha::Error: of kind usage on impossible settings, of kind input without a cloud, without a finite point
  /// or where no node can be measured. `output` is then unchanged.
  void compute(scene::DepthGrid& output);

  // Of the last compute().
  [[nodiscard]] double getEstimatedNoise() const { return found_noise_m_; }  ///< standard deviation about the fits
  [[nodiscard]] double getPointSpacing() const { return point_spacing_m_; }  ///< median, of front points
  [[nodiscard]] const std::vector<ProjectedPoint>& getPoints() const {
    return points_;
  }  ///< one per point of the cloud

 private:
  Eigen::Affine3d orientation_ = Eigen::Affine3d::Identity();
  double spacing_m_ = 0.0;
  int size_ = 0;
  std::vector<double> bounds_m_;
  double noise_m_ = 0.0;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
  unsigned threads_ = 0;
  double found_noise_m_ = 0.0;
  double point_spacing_m_ = 0.0;
  std::vector<ProjectedPoint> points_;
};

}  // namespace sparsha
