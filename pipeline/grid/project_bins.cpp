// Counting sort in two steps: to bands of rows that fit the cache, then to bins within a band.
#include "pipeline/grid/project_bins.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kPiece = 1U << 13U;
constexpr float kNothing = -std::numeric_limits<float>::infinity();

struct Point {
  float z, x, y;
  std::uint32_t bin;  // within its band
};

// Total order by height, then place, on the bits' values: the same for any order of input.
bool higher(const Point& a, const Point& b) {
  if (a.z != b.z) return a.z > b.z;
  if (a.x != b.x) return a.x < b.x;
  return a.y < b.y;
}

// Ascending integers for descending heights, then ascending x; only points equal in both need a look at y.
std::uint64_t key_of(const Point& p) {
  const auto ascending = [](float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value + 0.0F);
    return (bits >> 31U) != 0 ? ~bits : bits | 0x80000000U;
  };
  return (static_cast<std::uint64_t>(~ascending(p.z)) << 32U) | ascending(p.x);
}

// Sorts a bin by counting, for each point, those before it: few enough points, and no branch to guess wrong.
void sort_bin(Point* first, std::size_t count) {
  constexpr std::size_t kFew = 12;
  if (count < 2) return;
  if (count > kFew) {
    std::sort(first, first + count, higher);
    return;
  }
  std::array<std::uint64_t, kFew> keys;
  std::array<Point, kFew> points;
  for (std::size_t k = 0; k < count; ++k) {
    points[k] = first[k];
    keys[k] = key_of(first[k]);
  }
  std::size_t ranks = 0;
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t rank = 0;
    for (std::size_t other = 0; other < count; ++other) rank += keys[other] < keys[k] ? 1 : 0;
    first[rank] = points[k];
    ranks += rank;
  }
  // Equal keys share a rank and overwrite each other.
  if (ranks == count * (count - 1) / 2) [[likely]]
    return;
  std::copy_n(points.begin(), count, first);
  std::sort(first, first + count, higher);
}

// Band and bin within the band of points.
struct Indexer {
  Indexer(const BinLattice& lattice, const BinWindow& window, std::uint32_t rows_per_band)
      : ruler(lattice),
        left(static_cast<float>(window.first_column)),
        right(static_cast<float>(window.last_column)),
        bottom(static_cast<float>(window.first_row)),
        top(static_cast<float>(window.last_row)),
        first_row(window.first_row),
        row_length(lattice.bins_x()),
        band_rows_log2(std::countr_zero(rows_per_band)),
        row_mask(static_cast<std::int32_t>(rows_per_band - 1)) {}

  // `nowhere` is the band of points beyond the lattice. A plain loop over int32, which SSE2 converts to.
  void operator()(const float* x, const float* y, std::size_t count, std::int32_t nowhere, std::int32_t* band,
                  std::int32_t* bin) const {
    for (std::size_t k = 0; k < count; ++k) {
      const float u = (x[k] - ruler.x_shift_m) * ruler.per_m;
      const float v = (y[k] - ruler.y_shift_m) * ruler.per_m;
      const bool inside = (u >= left) & (v >= bottom) & (u < right) & (v < top);
      const auto column = static_cast<std::int32_t>(inside ? u : 0.0F);
      const auto row = static_cast<std::int32_t>(inside ? v : bottom) - first_row;
      band[k] = inside ? row >> band_rows_log2 : nowhere;
      bin[k] = (row & row_mask) * row_length + column;
    }
  }

  BinRuler ruler;
  float left, right, bottom, top;
  std::int32_t first_row;
  std::int32_t row_length;
  std::int32_t band_rows_log2;
  std::int32_t row_mask;
};

}  // namespace

BinRuler::BinRuler(const BinLattice& lattice)
    : x_shift_m(static_cast<float>(lattice.x0_m - (BinLattice::kMargin + 0.5) * lattice.spacing_m)),
      y_shift_m(static_cast<float>(lattice.y0_m - (BinLattice::kMargin + 0.5) * lattice.spacing_m)),
      per_m(static_cast<float>(1.0 / lattice.spacing_m)),
      columns(static_cast<float>(lattice.bins_x())),
      rows(static_cast<float>(lattice.bins_y())) {}

Bins sort_into_bins(const OrientedPoints& points, const std::vector<std::uint8_t>& skip, const BinLattice& lattice,
                    const BinWindow& window, ThreadPool& pool) {
  const auto columns = static_cast<std::size_t>(lattice.bins_x());
  const auto rows = static_cast<std::size_t>(window.last_row - window.first_row);
  // Bands of about 16 K points are 256 KB; at most 256 bands keep their write heads in cache.
  const std::size_t wanted_bands = std::clamp<std::size_t>(points.count / 16384, 1, 256);
  const std::size_t rows_per_band = std::bit_ceil(std::max<std::size_t>(1, (rows + wanted_bands - 1) / wanted_bands));
  const std::size_t bands = (rows + rows_per_band - 1) / rows_per_band;
  const std::size_t pieces = (points.count + kPiece - 1) / kPiece;
  const Indexer indexer(lattice, window, static_cast<std::uint32_t>(rows_per_band));
  const auto nowhere = static_cast<std::int32_t>(bands);
  const auto index_piece = [&](std::size_t begin, std::size_t end, std::int32_t* band, std::int32_t* bin) {
    indexer(points.x.get() + begin, points.y.get() + begin, end - begin, nowhere, band, bin);
    if (skip.empty()) return;
    for (std::size_t k = begin; k < end; ++k) band[k - begin] = skip[k] != 0 ? nowhere : band[k - begin];
  };

  // offset[piece * (bands + 1) + band]: where the piece writes its points of the band; the last band is nowhere.
  std::vector<std::size_t> offset(pieces * (bands + 1), 0);
  pool.for_ranges(points.count, kPiece, [&](std::size_t begin, std::size_t end) {
    std::array<std::int32_t, kPiece> band;
    std::array<std::int32_t, kPiece> bin;
    index_piece(begin, end, band.data(), bin.data());
    std::size_t* mine = offset.data() + begin / kPiece * (bands + 1);
    for (std::size_t k = 0; k < end - begin; ++k) ++mine[band[k]];
  });
  std::vector<std::size_t> band_start(bands + 1, 0);
  std::size_t total = 0;
  for (std::size_t band = 0; band < bands; ++band) {
    band_start[band] = total;
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const std::size_t here = offset[piece * (bands + 1) + band];
      offset[piece * (bands + 1) + band] = total;
      total += here;
    }
  }
  band_start[bands] = total;

  const auto banded = make_buffer<Point>(total);
  pool.for_ranges(points.count, kPiece, [&](std::size_t begin, std::size_t end) {
    std::array<std::int32_t, kPiece> band;
    std::array<std::int32_t, kPiece> bin;
    index_piece(begin, end, band.data(), bin.data());
    std::size_t* mine = offset.data() + begin / kPiece * (bands + 1);
    for (std::size_t k = 0; k < end - begin; ++k) {
      if (band[k] == nowhere) [[unlikely]]
        continue;
      banded[mine[band[k]]++] = {points.z[begin + k], points.x[begin + k], points.y[begin + k],
                                 static_cast<std::uint32_t>(bin[k])};
    }
  });

  Bins bins;
  bins.lattice = lattice;
  bins.points = total;
  bins.start = make_buffer<std::uint32_t>(lattice.bin_count() + 1 + Bins::kReadAhead);
  bins.top = make_buffer<float>(lattice.bin_count() + Bins::kReadAhead);
  for (Buffer<float>* array : {&bins.x, &bins.y, &bins.z}) {
    *array = make_buffer<float>(total + Bins::kReadAhead);
    std::fill_n(array->get() + total, Bins::kReadAhead, 0.0F);
  }
  std::fill_n(bins.top.get() + lattice.bin_count(), Bins::kReadAhead, kNothing);
  pool.for_ranges(bands, 1, [&](std::size_t band, std::size_t) {
    const std::size_t first_row = static_cast<std::size_t>(window.first_row) + band * rows_per_band;
    const std::size_t band_rows = std::min(rows_per_band, static_cast<std::size_t>(window.last_row) - first_row);
    std::uint32_t* start = bins.start.get() + first_row * columns;
    const std::size_t size = band_rows * columns;
    std::vector<std::uint32_t> head(size + 1, 0);
    const std::size_t begin = band_start[band];
    const std::size_t end = band_start[band + 1];
    for (std::size_t k = begin; k < end; ++k) ++head[banded[k].bin + 1];
    for (std::size_t b = 0; b < size; ++b) head[b + 1] += head[b];
    for (std::size_t b = 0; b < size; ++b) start[b] = static_cast<std::uint32_t>(begin + head[b]);
    const auto sorted = make_buffer<Point>(end - begin);
    for (std::size_t k = begin; k < end; ++k) sorted[head[banded[k].bin]++] = banded[k];
    // Every head now stands at its bin's end.
    std::size_t bin_begin = 0;
    for (std::size_t b = 0; b < size; ++b) {
      const std::size_t bin_end = head[b];
      sort_bin(sorted.get() + bin_begin, bin_end - bin_begin);
      bins.top[first_row * columns + b] = bin_begin < bin_end ? sorted[bin_begin].z : kNothing;
      bin_begin = bin_end;
    }
    for (std::size_t k = 0; k < end - begin; ++k) {
      bins.x[begin + k] = sorted[k].x;
      bins.y[begin + k] = sorted[k].y;
      bins.z[begin + k] = sorted[k].z;
    }
  });
  std::fill_n(bins.start.get() + static_cast<std::size_t>(window.last_row) * columns, 1 + Bins::kReadAhead,
              static_cast<std::uint32_t>(total));
  return bins;
}

}  // namespace sparsha::pipeline
