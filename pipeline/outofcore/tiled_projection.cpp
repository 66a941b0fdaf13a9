// Every decision rests on integers or on points sorted by their own coordinates, so it does not matter how they are cut
// into pieces and tiles.
#include "pipeline/outofcore/tiled_projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/system.h"
#include "pipeline/outofcore/memory.h"
#include "pipeline/projection/attributes.h"
#include "pipeline/projection/classification.h"
#include "pipeline/projection/crowded.h"
#include "pipeline/projection/edge_on.h"
#include "pipeline/projection/measure_rows.h"
#include "pipeline/projection/turned_away.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kMostBuckets = 256;

// Shares of the stage, for the time left.
constexpr double kPlanned = 0.3, kBucketed = 0.45, kFitted = 0.85;

// Of all ranks.
PointTotals totals_of(const OrientedPieces& pieces) {
  struct Part {
    std::uint64_t count;
    std::array<float, 3> min_m, max_m;
  };
  PointTotals own;
  pieces([&](const OrientedPoints& points) { own.add(points); });
  std::vector<Part> parts{
      {own.count, {own.min_m.x(), own.min_m.y(), own.min_m.z()}, {own.max_m.x(), own.max_m.y(), own.max_m.z()}}};
  pieces.join(parts);
  PointTotals totals;
  for (const Part& part : parts) {
    totals.count += part.count;
    totals.min_m = totals.min_m.min(Eigen::Array3f(part.min_m[0], part.min_m[1], part.min_m[2]));
    totals.max_m = totals.max_m.max(Eigen::Array3f(part.max_m[0], part.max_m[1], part.max_m[2]));
  }
  return totals;
}

}  // namespace

/// Some records of a bucket, oriented.
struct TiledProjection::Piece {
  std::size_t bucket;
  const PointRecords& records;
  OrientedPoints points;
};

OrientedPoints TiledProjection::orient(const PointRecords& records, ThreadPool& pool) const {
  return orient_points(raw_points(records), cloud_.origin_m, scan_to_grid_, plan_.origin_m, pool, &memory_);
}

TiledProjection::TiledProjection(CloudOnDisk cloud, const Eigen::Matrix4d& scan_to_grid, const scene::GridConfig& grid,
                                 double resolution_m, const Ranks* ranks,
                                 const std::function<void(std::uint64_t)>& approve_sides, const Context& context)
    : cloud_(std::move(cloud)), ranks_(ranks), scan_to_grid_(scan_to_grid) {
  JoinBytes join;
  if (ranks != nullptr) join = [ranks](std::vector<std::byte>& bytes) { ranks->join(bytes); };
  // How often the points are gone through depends on them: each pass is worth half of what is left.
  double begun = 0.0;
  double share = kPlanned / 2;
  const auto each = [&](const std::function<void(const PointRecords&)>& use) {
    cloud_.file->read(0, PointFile::kPiece, [&](const PointRecords& records) {
      const double done = static_cast<double>(records.first) / static_cast<double>(cloud_.size());
      context.progress.at(begun + share * done);
      use(records);
    });
    begun += share;
    share /= 2;
  };
  RawPieces raw = [&](const auto& use) { each([&](const PointRecords& records) { use(raw_points(records)); }); };
  raw.set_join(join);
  plan_.origin_m = robust_origin(cloud_.all, raw, cloud_.origin_m, scan_to_grid, context.pool);
  OrientedPieces pieces = [&](const auto& use) {
    each([&](const PointRecords& records) { use(orient(records, context.pool)); });
  };
  pieces.set_join(join);
  const PointTotals totals = totals_of(pieces);
  const Extent extent = supported_extent(totals, pieces, context.pool);
  plan_ = plan_projection(pieces, totals, extent, {cloud_.stations, scan_to_grid, plan_.origin_m}, false, grid,
                          resolution_m, context.pool, approve_sides);
  cloud_points_ = totals.count;
}

void TiledProjection::fill_buckets(const std::filesystem::path& folder, const Context& context) {
  const BinLocator locator(plan_.bins);
  const auto rows = static_cast<std::size_t>(plan_.bins.bins_y());
  if (ranks_ != nullptr) {
    count_rows(context);
    share_rows();
  }
  row_points_.assign(rows, 0);
  points_.origin_m = cloud_.origin_m;
  points_.rows_per_bucket = static_cast<int>((rows + kMostBuckets - 1) / kMostBuckets);
  const auto per_bucket = static_cast<std::size_t>(points_.rows_per_bucket);
  points_.file = std::make_unique<PointFile>(folder, cloud_.file->layout(), (rows + per_bucket - 1) / per_bucket);
  const auto put = [&](const float* record, std::size_t row) {
    ++row_points_[row];
    points_.file->add(row / per_bucket, record);
  };
  if (ranks_ != nullptr) {
    exchange_points(put, context);
    points_.file->finish();
    cloud_.file.reset();
    return;
  }
  cloud_.file->drain(0, PointFile::kPiece, [&](const PointRecords& records) {
    const double done = static_cast<double>(records.first) / static_cast<double>(cloud_.size());
    context.progress.at(kPlanned + (kBucketed - kPlanned) * done);
    const OrientedPoints points = orient(records, context.pool);
    beyond_ += for_each_in_bins(locator, points, [&](std::size_t k, std::size_t row) { put(records.xyz(k), row); });
  });
  points_.file->finish();
  cloud_.file.reset();
}

/// All buckets that hold points of the bin rows [first_row, last_row), piece by piece.
void TiledProjection::each_piece(int first_row, int last_row, ThreadPool& pool,
                                 const std::function<void(const Piece&)>& use) const {
  const auto first = static_cast<std::size_t>(first_row / points_.rows_per_bucket);
  const auto last = static_cast<std::size_t>((last_row - 1) / points_.rows_per_bucket);
  for (std::size_t bucket = first; bucket <= last; ++bucket) {
    points_.file->read(bucket, PointFile::kPiece, [&](const PointRecords& records) {
      use({bucket, records, orient(records, pool)});
    });
  }
}

std::vector<std::uint64_t> TiledProjection::count_columns(int first_row, int last_row, ThreadPool& pool) const {
  const BinLocator locator(plan_.bins);
  std::vector<std::uint64_t> counts(static_cast<std::size_t>(plan_.bins.bins_x()), 0);
  each_piece(first_row, last_row, pool, [&](const Piece& piece) {
    for (std::size_t k = 0; k < piece.points.count; ++k) {
      int column = 0;
      int row = 0;
      if (!locator.locate(piece.points.x[k], piece.points.y[k], column, row)) continue;
      if (row >= first_row && row < last_row) ++counts[static_cast<std::size_t>(column)];
    }
  });
  return counts;
}

/// Counts the points of each bin. From then on tiles have no more of a bin than decide its nodes.
void TiledProjection::count_bins(ThreadPool& pool) {
  const BinLocator locator(plan_.bins);
  const auto columns = static_cast<std::size_t>(plan_.bins.bins_x());
  bin_points_.assign(plan_.bins.bin_count(), 0);
  each_piece(0, plan_.bins.bins_y(), pool, [&](const Piece& piece) {
    for (std::size_t k = 0; k < piece.points.count; ++k) {
      int column = 0;
      int row = 0;
      if (!locator.locate(piece.points.x[k], piece.points.y[k], column, row)) continue;
      ++bin_points_[static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column)];
    }
  });
  for (std::size_t row = 0; row < row_points_.size(); ++row) {
    const auto at = static_cast<int>(row);
    row_points_[row] = taken_of({at, at + 1, 0, plan_.bins.bins_x()});
  }
}

/// Points that a tile takes of these bins.
std::uint64_t TiledProjection::taken_of(const BinWindow& bins) const {
  const auto columns = static_cast<std::size_t>(plan_.bins.bins_x());
  const std::uint64_t most = plan_.discs ? std::numeric_limits<std::uint32_t>::max() : kMostInBin;
  std::uint64_t sum = 0;
  for (int row = bins.first_row; row < bins.last_row; ++row)
    for (int column = bins.first_column; column < bins.last_column; ++column) {
      const std::size_t bin = static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column);
      sum += std::min<std::uint64_t>(bin_points_[bin], most);
    }
  return sum;
}

/// Points that a tile takes of each column of the bin rows [first, last).
std::vector<std::uint64_t> TiledProjection::taken_of_columns(int first, int last) const {
  std::vector<std::uint64_t> counts;
  for (int column = 0; column < plan_.bins.bins_x(); ++column)
    counts.push_back(taken_of({first, last, column, column + 1}));
  return counts;
}

/// The most points in the bins that any one node needs.
std::uint64_t TiledProjection::most_about_a_node(int halo) const {
  const auto low = [&](int node) { return std::max(0, node + BinLattice::kMargin - halo); };
  const auto high = [&](int node, int bins) { return std::min(bins, node + BinLattice::kMargin + 1 + halo); };
  std::uint64_t most = 0;
  for (int j = 0; j < plan_.lattice.ny; ++j) {
    const std::vector<std::uint64_t> columns = taken_of_columns(low(j), high(j, plan_.bins.bins_y()));
    for (int i = 0; i < plan_.lattice.nx; ++i) {
      const auto first = columns.begin() + low(i);
      const auto last = columns.begin() + high(i, plan_.bins.bins_x());
      most = std::max(most, std::accumulate(first, last, std::uint64_t{0}));
    }
  }
  return most;
}

/// The columns of a row of bins take as much memory as so many points.
std::uint64_t TiledProjection::columns_of_row(const MemoryLimit& limit) const {
  if (limit.bytes == 0) return 0;
  const std::uint64_t bytes = plan_.needs(cloud_points_).column_bytes / row_points_.size();
  return (bytes + plan_.bytes_per_point() - 1) / plan_.bytes_per_point();
}

std::vector<Tile> TiledProjection::cut_rows(const TileRoom& room, int halo, const Context& context) const {
  const auto rows = static_cast<int>(std::min<std::uint64_t>(
      static_cast<std::uint64_t>(plan_.lattice.ny),
      bins_beside(room.limit, room.points, plan_.bytes_per_point()) / static_cast<std::uint64_t>(plan_.bins.bins_x())));
  return cut_into_tiles(
      plan_.bins, halo, room.points, rows, columns_of_row(room.limit), row_points_, [&](int first, int last) {
        return bin_points_.empty() ? count_columns(first, last, context.pool) : taken_of_columns(first, last);
      });
}

/// Bins beyond a tile that decide its nodes: a neighbour's height decides too, and it may look as far.
int TiledProjection::halo_of_tiles() const { return bins_beyond(plan_) + 1; }

std::vector<Tile> TiledProjection::cut(const TileRoom& room, const Context& context) {
  const int halo = halo_of_tiles();
  const std::uint64_t points = std::accumulate(row_points_.begin(), row_points_.end(), std::uint64_t{0});
  // So many to a bin on average: the bins are few beside the points, and many of them crowded.
  constexpr std::size_t kManyPerBin = 64;
  if (!plan_.discs && points / kManyPerBin > plan_.bins.bin_count()) {
    count_bins(context.pool);
    return cut_counted(room, halo, context);
  }
  try {
    return cut_rows(room, halo, context);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {
    count_bins(context.pool);
    const std::uint64_t counters = bin_points_.size() * sizeof(bin_points_[0]) / plan_.bytes_per_point();
    return cut_counted({room.points - std::min(room.points, counters), room.limit, room.finished}, halo, context);
  }
}

std::vector<Tile> TiledProjection::cut_counted(const TileRoom& room, int halo, const Context& context) const {
  try {
    return cut_rows(room, halo, context);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {
    const std::uint64_t most = most_about_a_node(halo);
    const std::uint64_t columns = columns_of_row(room.limit) * static_cast<std::uint64_t>(2 * halo + 1);
    const std::uint64_t bytes =
        enough_of(room.limit, bytes_with_tile(room.limit, most + columns, plan_.bytes_per_point(), plan_.lattice) +
                                  bin_points_.size() * sizeof(bin_points_[0]));
    throw Error(
        ErrorKind::failure, {},
        fmt::format("{} points lie about a single node of the grid, which need about {} MB, more than the limit", most,
                    bytes / 1'000'000U + 1),
        fmt::format("--memory {}MB and more, a finer grid or a voxel filter", bytes / 1'000'000U + 1));
  }
}

OrientedPoints TiledProjection::load_tile(const Tile& tile, ThreadPool& pool) const {
  const BinLocator locator(plan_.bins);
  const BinWindow& window = tile.bins;
  const auto room = static_cast<std::size_t>(tile.points);
  OrientedPoints all;
  all.origin_m = plan_.origin_m;
  for (Buffer<float>* axis : {&all.x, &all.y, &all.z}) *axis = make_buffer<float>(room, tile_store());
  const auto put = [&](float x, float y, float z) {
    all.x[all.count] = x;
    all.y[all.count] = y;
    all.z[all.count] = z;
    ++all.count;
  };
  const auto columns = static_cast<std::size_t>(plan_.bins.bins_x());
  const bool thins = !bin_points_.empty() && !plan_.discs;
  std::map<std::size_t, CrowdedBin> crowded;
  each_piece(window.first_row, window.last_row, pool, [&](const Piece& piece) {
    for (std::size_t k = 0; k < piece.points.count; ++k) {
      int column = 0;
      int row = 0;
      if (!locator.locate(piece.points.x[k], piece.points.y[k], column, row)) continue;
      if (row < window.first_row || row >= window.last_row || column < window.first_column ||
          column >= window.last_column) {
        continue;
      }
      const std::size_t bin = static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column);
      if (thins && bin_points_[bin] > kMostInBin) {
        crowded[bin].add(piece.points.x[k], piece.points.y[k], piece.points.z[k]);
      } else {
        put(piece.points.x[k], piece.points.y[k], piece.points.z[k]);
      }
    }
  });
  for (auto& [bin, some] : crowded) {
    for (const auto& [x, y, z] : some.take()) put(x, y, z);
  }
  return all;
}

void TiledProjection::fit_tile(const Tile& tile, const Context& context, Projection& projection,
                               std::vector<std::uint8_t>& of_nodes) const {
  scene::DepthGrid& grid = projection.grid;
  // One row more to each side: nodes are compared with their neighbours.
  const int first = std::max(0, tile.first_row - 1);
  const int last = std::min(plan_.lattice.ny, tile.last_row + 1);
  scene::Lattice lattice = plan_.lattice;
  lattice.ny = last - first;
  scene::DepthGrid rows(lattice);
  const OrientedPoints points = load_tile(tile, context.pool);
  std::vector<std::uint8_t> skip;
  constexpr int kMargin = BinLattice::kMargin;
  const BinWindow own{tile.first_row + kMargin, tile.last_row + kMargin, tile.first_column + kMargin,
                      tile.last_column + kMargin};
  projection.scattered += flag_scattered(points, plan_.scatter, plan_.bins, own, skip);
  const std::vector<std::uint8_t> verdicts =
      measure_rows(points, skip, plan_, tile.bins, first, context, rows, tile_store());
  for (int j = tile.first_row; j < tile.last_row; ++j) {
    const std::size_t from = lattice.index(tile.first_column, j - first);
    const std::size_t to = plan_.lattice.index(tile.first_column, j);
    const auto count = static_cast<std::size_t>(tile.last_column - tile.first_column);
    std::copy_n(rows.height_m.data() + from, count, grid.height_m.data() + to);
    std::copy_n(rows.state.data() + from, count, grid.state.data() + to);
    if (!verdicts.empty()) std::copy_n(verdicts.data() + from, count, of_nodes.data() + to);
  }
}

/// Takes a tile that is finished, or measures it and keeps it; `finished` may be null.
void TiledProjection::measure_tile(const Tile& tile, FinishedTiles* finished, const Context& context,
                                   Projection& projection, std::vector<std::uint8_t>& of_nodes) const {
  TileNodes nodes;
  if (finished != nullptr && finished->take(tile, nodes) && nodes.verdicts.empty() == of_nodes.empty()) {
    projection.scattered += nodes.scattered;
    put_nodes(tile, nodes, projection.grid, of_nodes);
    return;
  }
  const std::uint64_t before = projection.scattered;
  fit_tile(tile, context, projection, of_nodes);
  if (finished == nullptr) return;
  nodes = take_nodes(tile, projection.grid, of_nodes);
  nodes.scattered = projection.scattered - before;
  finished->add(tile, nodes);
}

/// Takes outliers on surfaces seen edge-on out of what counts, some buckets behind the one that is classified: those of
/// the buckets around decide.
class TiledProjection::OutliersOfBuckets {
 public:
  OutliersOfBuckets(TiledProjection& whole, const Context& context, Projection& projection)
      : whole_(whole),
        context_(context),
        projection_(projection),
        surfaces_(whole.plan_.bins, whole.plan_.point_spacing_m),
        outliers_(whole.points_.file->buckets()) {}

  /// Of one bucket after the other.
  void add(const Piece& piece, const PointClass* point_class) {
    decide_up_to(static_cast<int>(piece.bucket) * whole_.points_.rows_per_bucket - surfaces_.rows_needed());
    outliers_[piece.bucket] +=
        static_cast<std::uint64_t>(std::count(point_class, point_class + piece.points.count, PointClass::outlier));
    surfaces_.add(piece.points, point_class);
  }
  /// After the last.
  void finish() { decide_up_to(whole_.plan_.bins.bins_y() + whole_.points_.rows_per_bucket); }

 private:
  // The buckets that end at that row of bins or before.
  void decide_up_to(int bin_row) {
    const int rows = whole_.points_.rows_per_bucket;
    for (; next_ < outliers_.size() && (static_cast<int>(next_) + 1) * rows <= bin_row; ++next_) {
      surfaces_.forget_before(static_cast<int>(next_) * rows - surfaces_.rows_needed());
      if (outliers_[next_] > 0) decide(next_);
    }
  }
  void decide(std::size_t bucket) {
    std::vector<PointClass> before(PointFile::kPiece);
    std::vector<PointClass> after;
    const int row = static_cast<int>(bucket) * whole_.points_.rows_per_bucket;
    whole_.each_piece(row, row + 1, context_.pool, [&](const Piece& piece) {
      context_.progress.throw_if_cancelled();
      (void)classify_points(piece.points, whole_.plan_.bins, projection_.grid, whole_.plan_.gap_m,
                            whole_.plan_.facing.get(), context_.pool, before.data());
      after = before;
      const std::uint64_t count = surfaces_.take_out(piece.points, after.data(), context_.pool);
      add_edge_on(count, surfaces_.main_normal(), whole_.scan_to_grid_, projection_);
      std::vector<std::uint64_t>& bits = whole_.points_.counts_bits[bucket];
      for (std::size_t k = 0; k < piece.points.count; ++k) {
        const std::uint64_t record = piece.records.first + k;
        if (after[k] != before[k]) bits[record / 64] &= ~(std::uint64_t{1} << (record % 64));
      }
    });
  }

  TiledProjection& whole_;
  const Context& context_;
  Projection& projection_;
  EdgeOnSurfaces surfaces_;
  std::vector<std::uint64_t> outliers_;  // in each bucket
  std::size_t next_ = 0;                 // bucket to be decided
};

void TiledProjection::decide_classes(const Context& context, Projection& projection) {
  const PointLayout layout = points_.file->layout();
  AttributeSums sums(plan_.lattice, plan_.bins, layout.colour, layout.intensity, cloud_.largest_intensity);
  std::vector<PointClass> point_class(PointFile::kPiece);
  std::vector<std::uint32_t> rgba;
  std::vector<float> intensity;
  points_.counts_bits.resize(points_.file->buckets());
  projection.outside = beyond_;
  OutliersOfBuckets outliers(*this, context, projection);
  each_piece(0, plan_.bins.bins_y(), context.pool, [&](const Piece& piece) {
    const double done = static_cast<double>(piece.bucket) / static_cast<double>(points_.file->buckets());
    context.progress.at(kFitted + (1.0 - kFitted) * done);
    const std::size_t count = piece.points.count;
    add_classes(classify_points(piece.points, plan_.bins, projection.grid, plan_.gap_m, plan_.facing.get(),
                                context.pool, point_class.data()),
                projection);
    std::vector<std::uint64_t>& bits = points_.counts_bits[piece.bucket];
    bits.resize(static_cast<std::size_t>((piece.records.first + count + 63) / 64), 0);
    for (std::size_t k = 0; k < count; ++k) {
      const bool counts = point_class[k] == PointClass::used || point_class[k] == PointClass::outlier;
      const std::uint64_t record = piece.records.first + k;
      if (counts) bits[static_cast<std::size_t>(record / 64)] |= std::uint64_t{1} << (record % 64);
    }
    outliers.add(piece, point_class.data());
    if (layout.words() == 3) return;
    rgba.resize(layout.colour ? count : 0);
    intensity.resize(layout.intensity ? count : 0);
    for (std::size_t k = 0; k < rgba.size(); ++k) rgba[k] = piece.records.rgba(k);
    for (std::size_t k = 0; k < intensity.size(); ++k) intensity[k] = piece.records.intensity(k);
    sums.add(piece.points, point_class.data(), rgba.data(), intensity.data());
  });
  outliers.finish();
  points_.counted = projection.used + projection.outlier;
  sums.write(projection);
}

Projection TiledProjection::run(const TileRoom& room, const std::filesystem::path& folder, const Context& context) {
  fill_buckets(folder, context);
  if (room.limit.bytes > 0) system::trim_heap();  // buckets' buffers have gone
  Projection projection = plan_.empty_projection();
  const std::vector<Tile> tiles = own_tiles(cut(room, context));
  std::vector<std::uint8_t> verdicts(plan_.discs ? plan_.lattice.count() : 0);
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    context.progress.at(kBucketed + (kFitted - kBucketed) * static_cast<double>(t) / static_cast<double>(tiles.size()));
    measure_tile(tiles[t], room.finished, context, projection, verdicts);
  }
  tile_memory_.clear();
  if (room.limit.bytes > 0) system::trim_heap();  // sums of attributes come next
  if (ranks_ != nullptr) bring_rows_together(projection, verdicts);
  if (ranks_ != nullptr && !ranks_->is_root()) return projection;
  add_verdicts(verdicts, projection);
  leave_out_turned_away(plan_, verdicts, context.pool, projection);
  require_a_measured_node(projection.grid);
  decide_classes(context, projection);
  return projection;
}

}  // namespace sparsha::pipeline
