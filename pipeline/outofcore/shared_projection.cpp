// What a projection does that several ranks share: each has a share of the records, measures a band of the grid's rows,
// and hands it to the root. The root has the points of all bands, since it tells what became of each.
#include <algorithm>
#include <cstring>
#include <numeric>

#include "pipeline/outofcore/tiled_projection.h"
#include "pipeline/projection/measure_rows.h"

namespace sparsha::pipeline {
namespace {

using Bytes = Ranks::Bytes;

void append(Bytes& bytes, const void* from, std::size_t size) {
  const std::size_t at = bytes.size();
  bytes.resize(at + size);
  if (size > 0) std::memcpy(bytes.data() + at, from, size);
}

const std::byte* take(const std::byte* bytes, void* to, std::size_t size) {
  if (size > 0) std::memcpy(to, bytes, size);
  return bytes + size;
}

// Whether a rank has more points to send, before them in each message; as wide as a coordinate.
using More = std::uint32_t;

}  // namespace

/// Points of all ranks in each row of bins.
void TiledProjection::count_rows(const Context& context) {
  const BinLocator locator(plan_.bins);
  row_points_.assign(static_cast<std::size_t>(plan_.bins.bins_y()), 0);
  cloud_.file->read(0, PointFile::kPiece, [&](const PointRecords& records) {
    context.progress.throw_if_cancelled();
    (void)for_each_in_bins(locator, orient(records, context.pool),
                           [&](std::size_t, std::size_t row) { ++row_points_[row]; });
  });
  Bytes bytes;
  append(bytes, row_points_.data(), row_points_.size() * sizeof(std::uint64_t));
  ranks_->join(bytes);
  std::vector<std::uint64_t> of_rank(row_points_.size());
  std::fill(row_points_.begin(), row_points_.end(), 0);
  const std::byte* at = bytes.data();
  for (std::size_t r = 0; r < ranks_->size(); ++r) {
    at = take(at, of_rank.data(), of_rank.size() * sizeof(std::uint64_t));
    for (std::size_t row = 0; row < of_rank.size(); ++row) row_points_[row] += of_rank[row];
  }
}

/// Bands of node rows with about as many points each.
void TiledProjection::share_rows() {
  const std::uint64_t all = std::accumulate(row_points_.begin(), row_points_.end(), std::uint64_t{0});
  const double share = static_cast<double>(all) / static_cast<double>(ranks_->size());
  first_rows_.assign(1, 0);
  std::uint64_t below = 0;
  for (int j = 0; j < plan_.lattice.ny; ++j) {
    while (first_rows_.size() < ranks_->size() &&
           static_cast<double>(below) >= share * static_cast<double>(first_rows_.size()))
      first_rows_.push_back(j);
    below += row_points_[static_cast<std::size_t>(j + BinLattice::kMargin)];
  }
  first_rows_.resize(ranks_->size() + 1, plan_.lattice.ny);
}

/// That decide the rank's nodes.
TiledProjection::BinRows TiledProjection::bin_rows_of(std::size_t rank) const {
  const int halo = halo_of_tiles();
  const int first = first_rows_[rank];
  const int last = first_rows_[rank + 1];
  if (rank == 0) return {0, row_points_.size()};  // the root tells the classes of all points
  if (first == last) return {0, 0};
  const int low = std::max(0, first + BinLattice::kMargin - halo);
  const int high = std::min(plan_.bins.bins_y(), last + BinLattice::kMargin + halo);
  return {static_cast<std::size_t>(low), static_cast<std::size_t>(high)};
}

/// Sends each point to the ranks whose bin rows have it, piece by piece, and uses those that come.
void TiledProjection::exchange_points(const std::function<void(const float* record, std::size_t row)>& use,
                                      const Context& context) {
  const BinLocator locator(plan_.bins);
  const std::size_t record_bytes = cloud_.file->layout().bytes();
  std::vector<BinRows> rows;
  for (std::size_t r = 0; r < ranks_->size(); ++r) rows.push_back(bin_rows_of(r));
  std::vector<Bytes> to(ranks_->size());
  std::vector<float> record(cloud_.file->layout().words());
  const auto begin = [&](More more) {
    for (Bytes& bytes : to) {
      bytes.clear();
      append(bytes, &more, sizeof(more));
    }
  };
  // A record goes with its row, which rounding could tell otherwise on another machine.
  const auto exchange = [&] {
    bool more = false;
    for (const Bytes& got : ranks_->all_to_all(to)) {
      More theirs = 0;
      const std::byte* at = take(got.data(), &theirs, sizeof(theirs));
      more = more || theirs != 0;
      while (at != got.data() + got.size()) {
        std::uint32_t row = 0;
        at = take(at, &row, sizeof(row));
        at = take(at, record.data(), record_bytes);
        use(record.data(), row);
      }
    }
    return more;
  };
  const std::size_t sent_bytes = sizeof(std::uint32_t) + record_bytes;
  std::vector<std::size_t> ends(to.size());
  cloud_.file->drain(0, PointFile::kPiece, [&](const PointRecords& records) {
    context.progress.throw_if_cancelled();
    const OrientedPoints points = orient(records, context.pool);
    begin(1);
    for (std::size_t r = 0; r < to.size(); ++r) {
      ends[r] = to[r].size();
      if (r != ranks_->number()) to[r].resize(ends[r] + points.count * sent_bytes);
    }
    beyond_ += for_each_in_bins(locator, points, [&](std::size_t k, std::size_t row) {
      const auto number = static_cast<std::uint32_t>(row);
      for (std::size_t r = 0; r < rows.size(); ++r) {
        if (number < rows[r].first || number >= rows[r].last) continue;
        if (r == ranks_->number()) {
          use(records.xyz(k), number);
          continue;
        }
        std::memcpy(to[r].data() + ends[r], &number, sizeof(number));
        std::memcpy(to[r].data() + ends[r] + sizeof(number), records.xyz(k), record_bytes);
        ends[r] += sent_bytes;
      }
    });
    for (std::size_t r = 0; r < to.size(); ++r) to[r].resize(ends[r]);
    (void)exchange();
  });
  do {
    begin(0);
  } while (exchange());
}

/// Of tiles of the whole lattice the rows of this rank, with the bins that decide them; all of them alone.
std::vector<Tile> TiledProjection::own_tiles(std::vector<Tile> tiles) const {
  if (ranks_ == nullptr) return tiles;
  const int halo = halo_of_tiles();
  std::vector<Tile> own;
  for (Tile tile : tiles) {
    tile.first_row = std::max(tile.first_row, first_rows_[ranks_->number()]);
    tile.last_row = std::min(tile.last_row, first_rows_[ranks_->number() + 1]);
    if (tile.first_row >= tile.last_row) continue;
    tile.bins.first_row = std::max(tile.bins.first_row, tile.first_row + BinLattice::kMargin - halo);
    tile.bins.last_row = std::min(tile.bins.last_row, tile.last_row + BinLattice::kMargin + halo);
    std::uint64_t points = 0;
    for (int row = tile.bins.first_row; row < tile.bins.last_row; ++row)
      points += row_points_[static_cast<std::size_t>(row)];
    tile.points = std::min(tile.points, points);
    own.push_back(tile);
  }
  return own;
}

/// Heights, states and verdicts of each rank's rows to the root, with what was counted.
void TiledProjection::bring_rows_together(Projection& projection, std::vector<std::uint8_t>& of_nodes) {
  scene::DepthGrid& grid = projection.grid;
  const auto from = [&](std::size_t rank) { return plan_.lattice.index(0, first_rows_[rank]); };
  const auto count = [&](std::size_t rank) {
    return static_cast<std::size_t>(first_rows_[rank + 1] - first_rows_[rank]) *
           static_cast<std::size_t>(plan_.lattice.nx);
  };
  std::uint64_t scattered = projection.scattered;
  std::uint64_t beyond = beyond_;
  Bytes bytes;
  append(bytes, &scattered, sizeof(scattered));
  append(bytes, &beyond, sizeof(beyond));
  if (const std::size_t own = ranks_->number(); !ranks_->is_root()) {
    append(bytes, grid.height_m.data() + from(own), count(own) * sizeof(grid.height_m[0]));
    append(bytes, grid.state.data() + from(own), count(own) * sizeof(grid.state[0]));
    if (!of_nodes.empty()) append(bytes, of_nodes.data() + from(own), count(own));
  }
  const std::vector<Bytes> all = ranks_->gather(std::move(bytes));
  if (!ranks_->is_root()) return;
  projection.scattered = 0;
  beyond_ = 0;
  for (std::size_t r = 0; r < all.size(); ++r) {
    const std::byte* at = take(all[r].data(), &scattered, sizeof(scattered));
    at = take(at, &beyond, sizeof(beyond));
    projection.scattered += scattered;
    beyond_ += beyond;
    if (r == 0) continue;
    at = take(at, grid.height_m.data() + from(r), count(r) * sizeof(grid.height_m[0]));
    at = take(at, grid.state.data() + from(r), count(r) * sizeof(grid.state[0]));
    if (!of_nodes.empty()) take(at, of_nodes.data() + from(r), count(r));
  }
}

}  // namespace sparsha::pipeline
