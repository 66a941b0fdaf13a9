// Counting sort in two steps: to bands of rows that fit the cache, then to bins within a band.
#include "pipeline/grid/project_bins.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "pipeline/grid/project_kernel.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kPiece = 1U << 13U;
constexpr std::size_t kMostBands = 256;
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

void sort_full_bin(const BinSort& sort, std::uint32_t begin, std::uint32_t end, std::vector<Point>& points) {
  points.clear();
  for (std::uint32_t k = begin; k < end; ++k) points.push_back({sort.from_z[k], sort.from_x[k], sort.from_y[k], 0});
  constexpr std::size_t kFewToMove = 24;
  if (points.size() > kFewToMove) {
    std::sort(points.begin(), points.end(), higher);
  } else {
    for (std::size_t k = 1; k < points.size(); ++k) {
      const Point point = points[k];
      std::size_t at = k;
      for (; at > 0 && higher(point, points[at - 1]); --at) points[at] = points[at - 1];
      points[at] = point;
    }
  }
  for (std::uint32_t k = begin; k < end; ++k) {
    sort.x[k] = points[k - begin].x;
    sort.y[k] = points[k - begin].y;
    sort.z[k] = points[k - begin].z;
  }
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
                    const BinWindow& window, ThreadPool& pool, MemoryStore* store) {
  const auto columns = static_cast<std::size_t>(lattice.bins_x());
  const auto rows = static_cast<std::size_t>(window.last_row - window.first_row);
  // Bands of about 16 K points are 256 KB; at most so many keep their write heads in cache.
  const std::size_t wanted_bands = std::clamp<std::size_t>(points.count / 8192, 1, kMostBands);
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

  // Each piece sorts its own points into bands: those of `band` are [of_piece[band], of_piece[band + 1]) of them.
  const auto banded = make_buffer<Point>(points.count, store);
  std::vector<std::uint32_t> offsets(pieces * (bands + 2), 0);
  pool.for_ranges(points.count, kPiece, [&](std::size_t begin, std::size_t end) {
    std::array<std::int32_t, kPiece> band;
    std::array<std::int32_t, kPiece> bin;
    index_piece(begin, end, band.data(), bin.data());
    std::uint32_t* const of_piece = offsets.data() + begin / kPiece * (bands + 2);
    for (std::size_t k = 0; k < end - begin; ++k) ++of_piece[band[k] + 1];
    for (std::size_t b = 0; b <= bands; ++b) of_piece[b + 1] += of_piece[b];
    std::array<std::uint32_t, kMostBands + 1> head;
    std::copy_n(of_piece, bands + 1, head.begin());
    Point* const piece = banded.get() + begin;
    for (std::size_t k = 0; k < end - begin; ++k) {
      piece[head[static_cast<std::size_t>(band[k])]++] = {points.z[begin + k], points.x[begin + k], points.y[begin + k],
                                                          static_cast<std::uint32_t>(bin[k])};
    }
  });
  std::vector<std::size_t> band_start(bands + 1, 0);
  for (std::size_t band = 0; band < bands; ++band) {
    band_start[band + 1] = band_start[band];
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const std::uint32_t* of_piece = offsets.data() + piece * (bands + 2) + band;
      band_start[band + 1] += of_piece[1] - of_piece[0];
    }
  }
  const std::size_t total = band_start[bands];
  const auto for_points_of = [&](std::size_t band, const auto& use) {
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const std::uint32_t* of_piece = offsets.data() + piece * (bands + 2) + band;
      const Point* const first = banded.get() + piece * kPiece;
      for (const Point* p = first + of_piece[0]; p != first + of_piece[1]; ++p) use(*p);
    }
  };

  Bins bins;
  bins.lattice = lattice;
  bins.points = total;
  bins.start = make_buffer<std::uint32_t>(lattice.bin_count() + 1 + Bins::kReadAhead, store);
  for (Buffer<float>* array : {&bins.x, &bins.y, &bins.z}) {
    *array = make_buffer<float>(total + Bins::kReadAhead, store);
    std::fill_n(array->get() + total, Bins::kReadAhead, 0.0F);
  }
  pool.for_ranges(bands, 1, [&](std::size_t band, std::size_t) {
    const std::size_t first_row = static_cast<std::size_t>(window.first_row) + band * rows_per_band;
    const std::size_t band_rows = std::min(rows_per_band, static_cast<std::size_t>(window.last_row) - first_row);
    const std::size_t size = band_rows * columns;
    const std::size_t begin = band_start[band];
    const std::size_t count = band_start[band + 1] - begin;
    std::vector<std::uint32_t> first(size + 1 + BinSort::kReadAhead, 0);
    for_points_of(band, [&](const Point& p) { ++first[p.bin + 1]; });
    for (std::size_t b = 0; b < size; ++b) first[b + 1] += first[b];
    std::uint32_t* start = bins.start.get() + first_row * columns;
    for (std::size_t b = 0; b < size; ++b) start[b] = static_cast<std::uint32_t>(begin) + first[b];
    std::vector<std::uint32_t> head(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(size));
    const std::size_t stride = count + BinSort::kReadAhead;
    const auto scattered = make_buffer<float>(3 * stride);
    float* const x = scattered.get();
    float* const y = x + stride;
    float* const z = y + stride;
    for (float* array : {x, y, z}) std::fill_n(array + count, BinSort::kReadAhead, 0.0F);
    for_points_of(band, [&](const Point& p) {
      const std::uint32_t at = head[p.bin]++;
      x[at] = p.x;
      y[at] = p.y;
      z[at] = p.z;
    });
    const BinSort sort{first.data(), x, y, z, bins.x.get() + begin, bins.y.get() + begin, bins.z.get() + begin};
    fastest_kernels().sort_bins(sort, size);
    std::vector<Point> many;
    for (std::size_t b = 0; b < size; ++b) {
      if (first[b + 1] - first[b] > BinSort::kFew) sort_full_bin(sort, first[b], first[b + 1], many);
    }
  });
  std::fill_n(bins.start.get() + static_cast<std::size_t>(window.last_row) * columns, 1 + Bins::kReadAhead,
              static_cast<std::uint32_t>(total));
  return bins;
}

}  // namespace sparsha::pipeline
