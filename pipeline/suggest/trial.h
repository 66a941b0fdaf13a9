// Trials of a first configuration: the surface that a view and a spacing would give, and its own cross-check.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/threads/progress.h"
#include "base/threads/thread_pool.h"
#include "pipeline/build/warnings.h"
#include "pipeline/check/check.h"
#include "pipeline/projection/projector.h"
#include "pipeline/scan/cloud.h"
#include "pipeline/scan/origin.h"
#include "pipeline/scan/statistics.h"
#include "pipeline/suggest/view.h"

namespace sparsha::pipeline {

/// Points for trials: all of them, or of clouds without faces a sample chosen by a hash.
class TrialCloud {
 public:
  void add(const ScanStatistics& statistics, double metres);
  /// Keeps what lies in the box; for clouds without faces.
  void crop(const scene::CropConfig& box);
  /// Takes away what is around the object; for clouds without faces.
  void take_away(const FloorsAndWalls& around);
  /// Points kept over all points, 0 to 1.
  [[nodiscard]] double share() const;
  [[nodiscard]] bool has_faces() const { return !faces_.empty(); }
  /// All scans are grids of heights, whose neighbours are as far apart as the cells are wide.
  [[nodiscard]] bool is_raster() const { return scans_ > 0 && rasters_ == scans_; }
  /// Median distance between neighbouring points, metres: of all where there is one scan, which has told it.
  [[nodiscard]] double neighbour_m() const;
  /// Takes what was added.
  [[nodiscard]] Cloud finish();

 private:
  static constexpr std::size_t kMostPoints = 64'000;

  std::vector<Eigen::Vector3d> corners_m_;  // points of scans with faces
  std::vector<std::array<std::uint32_t, 3>> faces_;
  PointSample loose_m_{kMostPoints};
  std::vector<Station> stations_;
  std::uint64_t kept_ = 0;
  std::uint64_t all_ = 0;
  std::size_t scans_ = 0;
  std::size_t rasters_ = 0;
  double spacing_m_ = 0.0;  // the widest of the scans'
};

struct Trial {
  View view;
  std::string error;                ///< why there is no surface; else the rest is known
  double spacing_m = 0, nodes = 0;  ///< of the grid
  SurfaceDoubts doubts;
  CheckResult::Against against = CheckResult::Against::points;
  double point_spacing_m = 0, noise_m = 0, median_m = 0;  ///< median: of the points' distances to the surface
  double measured = 0, coverage = 0, area_m2 = 0;         ///< measured nodes, as a share and as an area
  double seen = 0;                                        ///< points of the surface that is seen
  bool fits = false;                                      ///< the cross-check passes, with some room

  /// Nothing to complain of that another view might spare.
  [[nodiscard]] bool flawless() const { return fits && noise_m <= point_spacing_m && !doubts.unfacing; }
  /// What is wrong with it, or what a build will warn of; empty when nothing is.
  [[nodiscard]] std::string complaint() const;
};

class Trials {
 public:
  /// `resolution_m`: no automatic spacing is finer.
  Trials(TrialCloud& points, double resolution_m, Progress& progress);

  /// As a build with fill over five spacings would find it.
  [[nodiscard]] Trial run(const View& view, double spacing_m);
  /// With the points' own distance on the surface for spacing, or `least_m` where that is clearly more.
  [[nodiscard]] Trial run_at_own_spacing(const View& view, double least_m);

 private:
  [[nodiscard]] Trial run(const View& view, double spacing_m,
                          const std::function<void(const scene::Lattice&)>& approve);

  ThreadPool pool_;
  double resolution_m_;
  Progress& progress_;
  Cloud cloud_;
  std::optional<Projector> projector_;
};

}  // namespace sparsha::pipeline
