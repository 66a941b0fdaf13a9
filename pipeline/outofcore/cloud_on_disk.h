// All scans of a configuration as one cloud on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "base/threads/progress.h"
#include "base/threads/thread_pool.h"
#include "pipeline/filter/streamed.h"
#include "pipeline/outofcore/point_file.h"
#include "pipeline/projection/points.h"
#include "pipeline/scan/set.h"

namespace sparsha::pipeline {

struct CloudOnDisk {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  std::unique_ptr<PointFile> file;  ///< one bucket: all points, or the share of a rank
  std::uint64_t all = 0;            ///< points of all ranks
  std::uint64_t invalid = 0;
  FilterSteps filters;  ///< what they took away
  float largest_intensity = 0.0F;
  std::vector<Station> stations;

  [[nodiscard]] std::uint64_t size() const { return file->size(0); }
};

/// Streams the scans once more, rounds every point as a Cloud holds it, and keeps those that the filters keep.
/// Attributes that are asked for are kept too. Throws Error{input} when nothing is left, Error{failure} when the disk
/// is full. Of scans that several ranks read each keeps the points of its share, and knows the same of all of them.
[[nodiscard]] CloudOnDisk write_to_disk(const ScanSet& scans, StreamedFilters filters, bool colour, bool intensity,
                                        const std::filesystem::path& folder, Progress& progress);

/// The raw points of some records; valid as long as the records are.
[[nodiscard]] inline RawPoints raw_points(const PointRecords& records) {
  return {records.words, records.layout.words(), records.count};
}

}  // namespace sparsha::pipeline
