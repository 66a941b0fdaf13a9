// A scan in memory: a PCL cloud with its double origin and what else the file had.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace pcl {
struct PointXYZ;
template <typename PointT>
class PointCloud;
}  // namespace pcl

namespace sparsha {
class Progress;
class ThreadPool;
}  // namespace sparsha

namespace sparsha::pipeline {

/// What tells the outer side of a surface: where a scanner stood and a sample of what it saw from there; or the normals
/// that a file states, at a sample of its points. Scan frame, metres.
struct Station {
  std::string scan;       ///< file
  bool declared = false;  ///< by the file; else the scan's pose moved its origin there
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> seen_m;   ///< chosen by a hash of the coordinates
  std::vector<Eigen::Vector3f> normals;  ///< as the file states them, one per seen_m; then place_m says nothing
  bool proved = false;                   ///< that a scanner stood there, by the order of its points; see RasterSteps
};

/// Of a point that has none among points that have: scans differ, and blocks of one file.
inline constexpr std::uint32_t kNoColour = 0;  // transparent black
inline constexpr float kNoIntensity = std::numeric_limits<float>::quiet_NaN();

/// What a file says of its points beside their places, e.g. "confidence"; as the file has it.
struct PointField {
  static constexpr const char* kClass = "classification";
  std::string name;
  std::vector<float> values;  ///< one per point; NaN where the file says none, or a scan of several has no such field
};

/// Points are float32, relative to a double origin, so that a georeferenced scan keeps 0.1 mm. Points are finite;
/// what was not is counted in `invalid`.
struct Cloud {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  std::shared_ptr<pcl::PointCloud<pcl::PointXYZ>> points;
  std::vector<std::uint32_t> rgba;                  ///< 0xAABBGGRR or kNoColour; empty or one per point
  std::vector<float> intensity;                     ///< kNoIntensity where unknown; empty or one per point
  std::vector<Eigen::Vector3f> normals;             ///< as PCL's users give them; empty or one per point
  std::vector<Eigen::Vector3f> measured;            ///< empty, or where each point was before a filter moved it
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< triangles, indices into points
  std::vector<PointField> fields;                   ///< those that were asked for, see pipeline/scan/fields.h
  std::uint64_t invalid = 0;                        ///< records of the file that were not finite or flagged invalid
  std::vector<Station> stations;                    ///< of the scans that say where they were made from

  /// An empty cloud; `points` is never null.
  Cloud();
  [[nodiscard]] std::size_t size() const;

  /// The points as PCL stores them, four floats each: x, y, z in metres relative to origin_m, then 1. For files that
  /// need no more of PCL than its numbers.
  [[nodiscard]] const float* xyz1() const;
  [[nodiscard]] float* xyz1();
  /// Makes room for `count` points (width = count, height = 1); new points are (0, 0, 0, 1).
  void resize_points(std::size_t count);
};

}  // namespace sparsha::pipeline
