// One scan of the set as registration sees it: three thinnings of its points, and its pose about a common origin.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "base/threads/context.h"
#include "pipeline/register/surface.h"
#include "scene/config/scans.h"

namespace sparsha::pipeline {

struct PosedScan {
  std::string name;  ///< file
  /// Of its coordinates (file, units applied), which are kept relative to it.
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  double longest_m = 0.0;  ///< longest side of the box around 98 % of the points in each direction
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();  ///< of that box, relative to the origin
  /// Where the scanner stood, or may have stood, as in origin_m; unknown for a surface that has more than one side.
  std::optional<Eigen::Vector3d> place;
  /// Direction to it, when that had to be guessed from its surface alone; else 0.
  Eigen::Vector3d guessed_view = Eigen::Vector3d::Zero();
  std::unique_ptr<StationSurface> fine, medium, coarse;  ///< of points within a longest side of that box
  /// Scan's coordinates to the common frame: the nearest rigid motion to the given one.
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};

struct PosedScans {
  std::vector<PosedScan> scans;
  std::vector<std::size_t> places;  ///< of each among the given scans: those without a point are left out
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  ///< of the common frame in the scan frame

  [[nodiscard]] double longest_m() const;
  [[nodiscard]] double spacing_m(std::unique_ptr<StationSurface> PosedScan::*level) const;  ///< the coarsest scan's
  /// The pose of a scan as configurations have it.
  [[nodiscard]] Eigen::Matrix4d pose_of(std::size_t scan, const Eigen::Isometry3d& pose) const;
};

/// Reads and thins. `voxel_m` 0: at most kFinePoints a scan. Where the poses are not `trusted`, they say nothing of the
/// scanners' places. Scans without a point are left out with a warning. Throws Error{input}, also on a scan that has no
/// surface; Cancelled.
[[nodiscard]] PosedScans read_posed_scans(const std::vector<scene::ScanConfig>& scans, double voxel_m, bool trusted,
                                          const Context& context);

/// A SHA-256 of all that the result of a pair with this scan depends on: everything but its name, its pose and where
/// its origin lies.
[[nodiscard]] std::string digest_of(const PosedScan& scan);

/// Where the side from which a scan was made was guessed, and the others lie in front of it, it was the other side.
void turn_views(std::vector<PosedScan>& scans);

constexpr std::size_t kFinePoints = 40000;
constexpr std::size_t kMediumPoints = 6000;
constexpr std::size_t kCoarsePoints = 1500;

}  // namespace sparsha::pipeline
