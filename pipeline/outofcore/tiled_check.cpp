// Buckets are rows of bins, so rows of nodes are a few of them.
#include "pipeline/outofcore/tiled_check.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/check/points.h"
#include "pipeline/projection/bins.h"

namespace sparsha::pipeline {
namespace {

// Several threads read strips of rows at once.
constexpr std::size_t kStripPiece = 1U << 16U;

void read_counted(const BucketedPoints& points, std::size_t bucket, std::size_t piece, const ToLattice& to_lattice,
                  const Progress& progress, const CountedPoints::Use& use) {
  std::vector<float> xyz;
  points.file->read(bucket, piece, [&](const PointRecords& records) {
    progress.throw_if_cancelled();
    xyz.resize(3 * records.count);
    std::size_t count = 0;
    for (std::size_t k = 0; k < records.count; ++k) {
      if (points.counts(bucket, records.first + k)) to_lattice(records.xyz(k), xyz.data() + 3 * count++);
    }
    use({xyz.data(), 3 * count});
  });
}

}  // namespace

CountedPoints counted_points(const BucketedPoints& points, const Eigen::Matrix4d& scan_to_grid,
                             const scene::Lattice& lattice, const Progress& progress) {
  const ToLattice to_lattice(scan_to_grid, points.origin_m, lattice);
  CountedPoints counted;
  counted.size = points.counted;
  counted.each = [&points, &progress, to_lattice](const CountedPoints::Use& use) {
    for (std::size_t bucket = 0; bucket < points.file->buckets(); ++bucket) {
      read_counted(points, bucket, PointFile::kPiece, to_lattice, progress, use);
    }
  };
  counted.in_rows = [&points, &progress, to_lattice](double first_row, double last_row, const CountedPoints::Use& use) {
    // A bin is a node's; one more to each side, for the rounding.
    const auto bucket_of = [&](double row) {
      const double bucket = (row + BinLattice::kMargin) / points.rows_per_bucket;
      return static_cast<std::size_t>(
          std::clamp(std::floor(bucket), 0.0, static_cast<double>(points.file->buckets() - 1)));
    };
    for (std::size_t bucket = bucket_of(first_row - 1.0); bucket <= bucket_of(last_row + 2.0); ++bucket) {
      read_counted(points, bucket, kStripPiece, to_lattice, progress, use);
    }
  };
  return counted;
}

}  // namespace sparsha::pipeline
