// The projection of a cloud on disk, tile by tile: the same bits as of the same cloud in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "base/threads/context.h"
#include "base/threads/thread_pool.h"
#include "pipeline/cluster/ranks.h"
#include "pipeline/outofcore/cloud_on_disk.h"
#include "pipeline/outofcore/finished_tiles.h"
#include "pipeline/outofcore/memory.h"
#include "pipeline/outofcore/point_file.h"
#include "pipeline/outofcore/tiles.h"
#include "pipeline/projection/plan.h"
#include "pipeline/projection/projection.h"
#include "scene/config/grid.h"

namespace sparsha::pipeline {

/// Points in buckets of `rows_per_bucket` bin rows, and which of them a cross-check counts.
struct BucketedPoints {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  ///< of the records
  std::unique_ptr<PointFile> file;
  int rows_per_bucket = 1;
  std::uint64_t counted = 0;                            ///< used points and outliers
  std::vector<std::vector<std::uint64_t>> counts_bits;  ///< of each bucket, a bit a record

  [[nodiscard]] bool counts(std::size_t bucket, std::uint64_t record) const {
    return ((counts_bits[bucket][record / 64] >> (record % 64)) & 1U) != 0;
  }
};

/// What the largest tile may be, of what limit that is left, and where tiles are kept that need not be measured again;
/// null when none are.
struct TileRoom {
  std::uint64_t points = 0;
  MemoryLimit limit;
  FinishedTiles* finished = nullptr;
};

class TiledProjection {
 public:
  /// Goes through the cloud a few times for everything that is decided before a node is fitted. Throws as project().
  /// `approve_sides` as in Approval. `ranks`: each has a share of the cloud, and all make the same calls; null alone.
  /// They outlive this object.
  TiledProjection(CloudOnDisk cloud, const Eigen::Matrix4d& scan_to_grid, const scene::GridConfig& grid,
                  double resolution_m, const Ranks* ranks, const std::function<void(std::uint64_t)>& approve_sides,
                  const Context& context);

  [[nodiscard]] const ProjectionPlan& plan() const { return plan_; }
  [[nodiscard]] ProjectionNeeds needs() const { return plan_.needs(cloud_points_); }

  /// Sorts the points into buckets on disk, gives the cloud back, and measures tile by tile, each of at most
  /// `room.points`. The projection's `point_class` stays empty. Once only. Throws Error{failure}, with the memory that
  /// would do, when one node's points are more. Among ranks the root has the whole projection; what the others return
  /// is of no use.
  [[nodiscard]] Projection run(const TileRoom& room, const std::filesystem::path& folder, const Context& context);

  /// What a cross-check needs, after run().
  [[nodiscard]] BucketedPoints take_points() { return std::move(points_); }

 private:
  struct Piece;
  struct BinRows {
    std::size_t first, last;  ///< [first, last)
  };
  void fill_buckets(const std::filesystem::path& folder, const Context& context);
  [[nodiscard]] int halo_of_tiles() const;
  void count_rows(const Context& context);
  void share_rows();
  void exchange_points(const std::function<void(const float* record, std::size_t row)>& use, const Context& context);
  [[nodiscard]] BinRows bin_rows_of(std::size_t rank) const;
  [[nodiscard]] std::vector<Tile> own_tiles(std::vector<Tile> tiles) const;
  void bring_rows_together(Projection& projection, std::vector<std::uint8_t>& of_nodes);
  void each_piece(int first_row, int last_row, ThreadPool& pool, const std::function<void(const Piece&)>& use) const;
  [[nodiscard]] std::vector<std::uint64_t> count_columns(int first_row, int last_row, ThreadPool& pool) const;
  void count_bins(ThreadPool& pool);
  [[nodiscard]] std::uint64_t taken_of(const BinWindow& bins) const;
  [[nodiscard]] std::vector<std::uint64_t> taken_of_columns(int first, int last) const;
  [[nodiscard]] std::uint64_t most_about_a_node(int halo) const;
  [[nodiscard]] std::uint64_t columns_of_row(const MemoryLimit& limit) const;
  [[nodiscard]] std::vector<Tile> cut_rows(const TileRoom& room, int halo, const Context& context) const;
  [[nodiscard]] std::vector<Tile> cut_counted(const TileRoom& room, int halo, const Context& context) const;
  [[nodiscard]] std::vector<Tile> cut(const TileRoom& room, const Context& context);
  [[nodiscard]] OrientedPoints load_tile(const Tile& tile, ThreadPool& pool) const;
  void fit_tile(const Tile& tile, const Context& context, Projection& projection,
                std::vector<std::uint8_t>& of_nodes) const;
  void measure_tile(const Tile& tile, FinishedTiles* finished, const Context& context, Projection& projection,
                    std::vector<std::uint8_t>& of_nodes) const;
  void decide_classes(const Context& context, Projection& projection);
  class OutliersOfBuckets;
  [[nodiscard]] OrientedPoints orient(const PointRecords& records, ThreadPool& pool) const;
  /// Calls `use(k, row)` with the points within the bins, in their order; how many lie beyond.
  template <typename Use>
  static std::uint64_t for_each_in_bins(const BinLocator& locator, const OrientedPoints& points, const Use& use) {
    std::uint64_t beyond = 0;
    for (std::size_t k = 0; k < points.count; ++k) {
      int column = 0;
      int row = 0;
      if (locator.locate(points.x[k], points.y[k], column, row)) {
        use(k, static_cast<std::size_t>(row));
      } else {
        ++beyond;
      }
    }
    return beyond;
  }

  /// What a tile needs, the next one needs again. Not for discs, which take their memory step by step.
  [[nodiscard]] MemoryStore* tile_store() const { return plan_.discs ? nullptr : &tile_memory_; }

  mutable MemoryStore memory_;  ///< of pieces
  mutable MemoryStore tile_memory_;
  CloudOnDisk cloud_;
  const Ranks* ranks_;
  std::vector<int> first_rows_;  ///< of nodes, of each rank and behind the last; empty alone
  Eigen::Matrix4d scan_to_grid_;
  ProjectionPlan plan_;
  std::uint64_t cloud_points_ = 0;
  std::uint64_t beyond_ = 0;               ///< points outside all bins
  std::vector<std::uint64_t> row_points_;  ///< in each row of bins
  /// Of each bin, where a tile takes no more of a bin than decide its nodes; else empty.
  std::vector<std::uint32_t> bin_points_;
  BucketedPoints points_;
};

}  // namespace sparsha::pipeline
