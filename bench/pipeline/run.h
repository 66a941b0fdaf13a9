// The parts of the benchmark; each prints its table and leaves a CSV file in `folder`.
#pragma once

#include <filesystem>
#include <string>

namespace sparsha::bench {

struct RunOptions {
  std::filesystem::path out = ".";  ///< for CSV files
  std::filesystem::path program;    ///< `sparsha`, for whole builds
  std::filesystem::path work;       ///< scratch, removed at the end
  std::string scenes;               ///< only scenes whose name contains this
  bool quick = false;
  bool cloudcompare = true;  ///< when installed
  bool every = false;        ///< closed objects: every count, noise and grid, which takes hours; normals: 1 M points
  double huge_points = 0.0;  ///< of the out-of-core run; 0 leaves it out
};

/// Accuracy of every scene, the peer's beside it: pipeline_accuracy.csv. False when a bound is broken.
bool run_accuracy(const RunOptions& options);
/// Time beside error: pipeline_speed.csv.
void run_speed(const RunOptions& options);
/// Gain and coherence of the heights by wavelength: pipeline_mtf.csv.
void run_mtf(const RunOptions& options);
/// Our cross-check against CloudCompare's C2M distances: pipeline_c2m.csv. False when they differ by more than 5 %.
bool run_cross_check(const RunOptions& options);
/// Raw clouds of whole objects, CloudCompare's raster beside: pipeline_closed.csv. False when a bound is broken.
bool run_closed(const RunOptions& options);
/// Tangent discs beside pcl::NormalEstimationOMP, errors and times: pipeline_normals.csv.
void run_normals(const RunOptions& options);
/// The filters beside PCL's, times and agreement: pipeline_filters.csv.
void run_filters(const RunOptions& options);
/// Registration beside PCL's plain ICP, times and errors: pipeline_registration.csv.
void run_registration(const RunOptions& options);
/// Ours beside rasters, PCL's moving least squares and CloudCompare against density, noise and spacing:
/// pipeline_open_peers.csv, pipeline_closed_peers.csv.
void run_peers(const RunOptions& options);
/// Stages of a build against points and nodes: pipeline_scaling.csv.
void run_scaling(const RunOptions& options);
/// Whole programs against the points: time, memory, bytes read and written: pipeline_sites.csv.
void run_sites(const RunOptions& options);
/// Points a second of each reader beside the speed of reading the file's bytes: pipeline_formats.csv.
void run_formats(const RunOptions& options);
/// Scans that do not fit their --memory, a tenth of the points and all of them, beside the same builds in memory:
/// pipeline_huge.csv. False when a limit is broken or a byte differs.
bool run_huge(const RunOptions& options);

}  // namespace sparsha::bench
