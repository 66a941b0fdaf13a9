// Counting sort in two steps: to bands of rows that fit the cache, then to bins within a band.
#include "pipeline/grid/project_bins.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "pipeline/grid/project_kernel.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kPiece = 1U << 13U;
constexpr std::size_t kMostBands = 256;
constexpr std::size_t kCacheLine = 64;
constexpr std::size_t kHeads = 4;  // of each band and piece, see BandSend
constexpr std::size_t kMostHeads = kHeads * (kMostBands + 1);
using Point = BandPoint;

// Total order by height, then place, on the bits' values: the same for any order of input.
bool higher(const Point& a, const Point& b) {
  if (a.z != b.z) return a.z > b.z;
  if (a.x != b.x) return a.x < b.x;
  return a.y < b.y;
}

void sort_full_bin(const BinSort& sort, std::uint32_t begin, std::uint32_t end, std::vector<Point>& points) {
  points.assign(sort.from + begin, sort.from + end);
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

BandKernel band_kernel(const BinLattice& lattice, const BinWindow& window, std::size_t rows_per_band,
                       std::size_t bands) {
  const BinRuler ruler(lattice);
  BandKernel kernel;
  kernel.x_shift_m = ruler.x_shift_m;
  kernel.y_shift_m = ruler.y_shift_m;
  kernel.per_m = ruler.per_m;
  kernel.left = static_cast<float>(window.first_column);
  kernel.right = static_cast<float>(window.last_column);
  kernel.bottom = static_cast<float>(window.first_row);
  kernel.top = static_cast<float>(window.last_row);
  kernel.first_row = window.first_row;
  kernel.row_length = lattice.bins_x();
  kernel.band_rows_log2 = std::countr_zero(rows_per_band);
  kernel.row_mask = static_cast<std::int32_t>(rows_per_band - 1);
  kernel.nowhere = static_cast<std::int32_t>(bands);
  return kernel;
}

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
  const BandKernel kernel = band_kernel(lattice, window, rows_per_band, bands);

  // Each piece sorts its own points into bands: those of `band` are [of_piece[band], of_piece[band + 1]) of them.
  const auto banded = make_buffer<Point>(points.count, store);
  std::vector<std::uint32_t> offsets(pieces * (bands + 2), 0);
  pool.for_ranges(points.count, kPiece, [&](std::size_t begin, std::size_t end) {
    std::array<std::int32_t, kPiece> band;
    std::array<std::int32_t, kPiece> bin;
    const std::size_t count = end - begin;
    const float* const x = points.x.get() + begin;
    const float* const y = points.y.get() + begin;
    fastest_kernels().index_bands(kernel, x, y, count, band.data(), bin.data());
    if (!skip.empty()) {
      for (std::size_t k = 0; k < count; ++k) band[k] = skip[begin + k] != 0 ? kernel.nowhere : band[k];
    }
    std::array<std::uint32_t, kMostHeads> head;
    std::fill_n(head.begin(), kHeads * (bands + 1), 0U);
    for (std::size_t k = 0; k < count; ++k) ++head[kHeads * static_cast<std::size_t>(band[k]) + k % kHeads];
    std::uint32_t* const of_piece = offsets.data() + begin / kPiece * (bands + 2);
    std::uint32_t sum = 0;
    for (std::size_t b = 0; b <= bands; ++b) {
      for (std::size_t h = kHeads * b; h < kHeads * (b + 1); ++h) sum += std::exchange(head[h], sum);
      of_piece[b + 1] = sum;
    }
    fastest_kernels().send_to_bands(
        {x, y, points.z.get() + begin, band.data(), bin.data(), head.data(), banded.get() + begin}, count);
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
  // Each piece's points of a band, with those of the piece after it.
  const auto for_runs_of = [&](std::size_t band, const auto& use) {
    const auto end_of = [&](std::size_t piece, std::size_t b) {
      return banded.get() + piece * kPiece + offsets[piece * (bands + 2) + b];
    };
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const std::size_t next = std::min(piece + 1, pieces - 1);
      use(end_of(piece, band), end_of(piece, band + 1), end_of(next, band), end_of(next, band + 1));
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
    for_runs_of(band, [&](const Point* run, const Point* end, const Point* next, const Point* next_end) {
      // Runs are too short for the processor to foresee the next one.
      for (; next < next_end; next += kCacheLine / sizeof(Point)) __builtin_prefetch(next);
      for (; run != end; ++run) ++first[run->bin + 1];
    });
    for (std::size_t b = 0; b < size; ++b) first[b + 1] += first[b];
    std::uint32_t* start = bins.start.get() + first_row * columns;
    for (std::size_t b = 0; b < size; ++b) start[b] = static_cast<std::uint32_t>(begin) + first[b];
    std::vector<std::uint32_t> head(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(size));
    const auto scattered = make_buffer<Point>(count + BinSort::kReadAhead);
    std::fill_n(scattered.get() + count, BinSort::kReadAhead, Point{});
    for_runs_of(band, [&](const Point* run, const Point* end, const Point*, const Point*) {
      for (; run != end; ++run) scattered[head[run->bin]++] = *run;
    });
    const BinSort sort{first.data(), scattered.get(), bins.x.get() + begin, bins.y.get() + begin, bins.z.get() + begin};
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
