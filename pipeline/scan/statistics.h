// What a first configuration needs to know of a scan, without its points in memory when there are many.
#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "base/threads/progress.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/runs.h"
#include "pipeline/scan/seen_stations.h"
#include "pipeline/scan/worth.h"

namespace sparsha::pipeline {

struct ScanStatistics {
  /// The scan without attributes. Of more than 100 000 points without faces `points` are so many, chosen by a hash.
  RawScan scan;
  PointRuns runs;
  /// What the scan says of its points' worth. Those that its filters refuse are not in `scan`, nor in its records.
  std::vector<Worth> worth;
  std::uint64_t empty_returns = 0;  ///< points at 0 0 0 that were left out
  /// Mean direction of the normals that points without faces state, of length 1 where all agree; zero without any.
  Eigen::Vector3d stated_facing = Eigen::Vector3d::Zero();
  /// Where scanners stood, file units, of which the points' order is proof.
  std::vector<SeenStation> stations;
  bool has_colours = false;  ///< more than one
  double spacing = 0.0;      ///< median nearest-neighbour distance of a sample, file units; 0 when unknown
};

/// The same whatever is kept in memory: of a scan without faces with more than `kept_points` the file is gone through
/// again for each question. A mesh is read whole unless it is refused. `whole_chunks_only`: see ReadOptions. Throws as
/// read_scan; Cancelled.
[[nodiscard]] ScanStatistics scan_statistics(const std::filesystem::path& file, Progress& progress,
                                             std::uint64_t kept_points = 4'000'000,
                                             const MeshRefusal& mesh_refusal = {}, bool whole_chunks_only = false);

/// Median distance of sampled points to the nearest one that is not at the same place; 0 without any.
[[nodiscard]] double median_spacing(const std::vector<Eigen::Vector3d>& points);

}  // namespace sparsha::pipeline
