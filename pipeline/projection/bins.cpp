// Counting sort in two steps: to bands of rows that fit the cache, then to bins within a band.
#include "pipeline/projection/bins.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <utility>

#include "pipeline/projection/simd/kernels.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kPiece = 1U << 13U;
constexpr std::size_t kMostBands = 256;
constexpr std::size_t kCacheLine = 64;
constexpr std::size_t kHeads = 4;  // of each band and piece, see BandSend
constexpr std::size_t kMostHeads = kHeads * (kMostBands + 1);
using Point = BandPoint;

// Total order by height, then place, on the bits' values: the same for any order of input.
// No function but an object: std::sort calls that one without a pointer.
constexpr auto higher = [](const Point& a, const Point& b) {
  if (a.z != b.z) return a.z > b.z;
  if (a.x != b.x) return a.x < b.x;
  return a.y < b.y;
};

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
  const BinLocator locator(lattice);
  BandKernel kernel;
  kernel.x_shift_m = locator.x_shift_m;
  kernel.y_shift_m = locator.y_shift_m;
  kernel.per_m = locator.per_m;
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

// The points of all bands, piece by piece of the input: those of `band` are [of_piece[band], of_piece[band + 1]) of a
// piece's.
struct Bands {
  std::size_t rows = 0;  // of a band
  std::size_t count = 0;
  std::size_t pieces = 0;
  Buffer<Point> points;
  std::vector<std::uint32_t> offsets;
  std::vector<std::size_t> start;  // of each band among all points, and the end

  Bands(std::size_t all_rows, std::size_t point_count, MemoryStore* store) {
    // Bands of about 16 K points are 256 KB; at most so many keep their write heads in cache.
    const std::size_t wanted = std::clamp<std::size_t>(point_count / 8192, 1, kMostBands);
    rows = std::bit_ceil(std::max<std::size_t>(1, (all_rows + wanted - 1) / wanted));
    count = (all_rows + rows - 1) / rows;
    pieces = (point_count + kPiece - 1) / kPiece;
    points = make_buffer<Point>(point_count, store);
    offsets.assign(pieces * (count + 2), 0);
  }

  [[nodiscard]] std::uint32_t* of_piece(std::size_t piece) { return offsets.data() + piece * (count + 2); }
  [[nodiscard]] std::size_t total() const { return start[count]; }

  void find_starts() {
    start.assign(count + 1, 0);
    for (std::size_t band = 0; band < count; ++band) {
      start[band + 1] = start[band];
      for (std::size_t piece = 0; piece < pieces; ++piece) {
        const std::uint32_t* offset = of_piece(piece) + band;
        start[band + 1] += offset[1] - offset[0];
      }
    }
  }

  // Each piece's points of a band, with those of the piece after it.
  template <typename Use>
  void for_runs_of(std::size_t band, const Use& use) const {
    const auto end_of = [&](std::size_t piece, std::size_t b) {
      return points.get() + piece * kPiece + offsets[piece * (count + 2) + b];
    };
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const std::size_t next = std::min(piece + 1, pieces - 1);
      use(end_of(piece, band), end_of(piece, band + 1), end_of(next, band), end_of(next, band + 1));
    }
  }
};

// Each piece sorts its own points into bands.
void send_to_bands(const OrientedPoints& points, const std::vector<std::uint8_t>& skip, const BandKernel& kernel,
                   ThreadPool& pool, Bands& bands) {
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
    std::fill_n(head.begin(), kHeads * (bands.count + 1), 0U);
    for (std::size_t k = 0; k < count; ++k) ++head[kHeads * static_cast<std::size_t>(band[k]) + k % kHeads];
    std::uint32_t* const of_piece = bands.of_piece(begin / kPiece);
    std::uint32_t sum = 0;
    for (std::size_t b = 0; b <= bands.count; ++b) {
      for (std::size_t h = kHeads * b; h < kHeads * (b + 1); ++h) sum += std::exchange(head[h], sum);
      of_piece[b + 1] = sum;
    }
    fastest_kernels().send_to_bands(
        {x, y, points.z.get() + begin, band.data(), bin.data(), head.data(), bands.points.get() + begin}, count);
  });
  bands.find_starts();
}

// The points of a band into their bins, whose rows begin with `first_row`.
void sort_band(const Bands& bands, std::size_t band, std::size_t first_row, std::size_t rows, Bins& bins) {
  const auto columns = static_cast<std::size_t>(bins.lattice.bins_x());
  const std::size_t size = rows * columns;
  const std::size_t begin = bands.start[band];
  const std::size_t count = bands.start[band + 1] - begin;
  std::vector<std::uint32_t> first(size + 1 + BinSort::kReadAhead, 0);
  bands.for_runs_of(band, [&](const Point* run, const Point* end, const Point* next, const Point* next_end) {
    // Runs are too short for the processor to predict the next one.
    for (; next < next_end; next += kCacheLine / sizeof(Point)) __builtin_prefetch(next);
    for (; run != end; ++run) ++first[run->bin + 1];
  });
  for (std::size_t b = 0; b < size; ++b) first[b + 1] += first[b];
  std::uint32_t* start = bins.start.get() + first_row * columns;
  for (std::size_t b = 0; b < size; ++b) start[b] = static_cast<std::uint32_t>(begin) + first[b];
  std::vector<std::uint32_t> head(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(size));
  const auto scattered = make_buffer<Point>(count + BinSort::kReadAhead);
  std::fill_n(scattered.get() + count, BinSort::kReadAhead, Point{});
  bands.for_runs_of(band, [&](const Point* run, const Point* end, const Point*, const Point*) {
    for (; run != end; ++run) scattered[head[run->bin]++] = *run;
  });
  const BinSort sort{first.data(), scattered.get(), bins.x.get() + begin, bins.y.get() + begin, bins.z.get() + begin};
  fastest_kernels().sort_bins(sort, size);
  std::vector<Point> many;
  for (std::size_t b = 0; b < size; ++b) {
    if (first[b + 1] - first[b] > BinSort::kFew) sort_full_bin(sort, first[b], first[b + 1], many);
  }
}

// Whether a point of the bins stands where the one before it stands.
bool has_repeats(const Bins& bins, ThreadPool& pool) {
  std::atomic<bool> found = false;
  pool.for_ranges(bins.points, 1U << 16U, [&](std::size_t begin, std::size_t end) {
    std::size_t equal = 0;
    for (std::size_t p = std::max<std::size_t>(begin, 1); p < end; ++p) equal += bins.z[p] == bins.z[p - 1] ? 1 : 0;
    for (std::size_t p = std::max<std::size_t>(begin, 1); equal > 0 && p < end; ++p) {
      if (bins.z[p] != bins.z[p - 1]) continue;
      --equal;
      if (bins.x[p] == bins.x[p - 1] && bins.y[p] == bins.y[p - 1]) found = true;
    }
  });
  return found;
}

}  // namespace

BinLocator::BinLocator(const BinLattice& lattice)
    : x_shift_m(static_cast<float>(lattice.x0_m - (BinLattice::kMargin + 0.5) * lattice.spacing_m)),
      y_shift_m(static_cast<float>(lattice.y0_m - (BinLattice::kMargin + 0.5) * lattice.spacing_m)),
      per_m(static_cast<float>(1.0 / lattice.spacing_m)),
      columns(static_cast<float>(lattice.bins_x())),
      rows(static_cast<float>(lattice.bins_y())) {}

Bins sort_into_bins(const OrientedPoints& points, const std::vector<std::uint8_t>& skip, const BinLattice& lattice,
                    const BinWindow& window, ThreadPool& pool, MemoryStore* store) {
  const auto first_row = static_cast<std::size_t>(window.first_row);
  const auto last_row = static_cast<std::size_t>(window.last_row);
  Bands bands(last_row - first_row, points.count, store);
  send_to_bands(points, skip, band_kernel(lattice, window, bands.rows, bands.count), pool, bands);

  Bins bins;
  bins.lattice = lattice;
  bins.points = bands.total();
  // Of a part of the rows most of the starts are never touched, and take no memory that is not kept.
  const bool all_rows = last_row - first_row == static_cast<std::size_t>(lattice.bins_y());
  bins.start = make_buffer<std::uint32_t>(lattice.bin_count() + 1 + Bins::kReadAhead, all_rows ? store : nullptr);
  for (Buffer<float>* array : {&bins.x, &bins.y, &bins.z}) {
    *array = make_buffer<float>(bins.points + Bins::kReadAhead, store);
    std::fill_n(array->get() + bins.points, Bins::kReadAhead, 0.0F);
  }
  pool.for_ranges(bands.count, 1, [&](std::size_t band, std::size_t) {
    const std::size_t row = first_row + band * bands.rows;
    sort_band(bands, band, row, std::min(bands.rows, last_row - row), bins);
  });
  std::fill_n(bins.start.get() + last_row * static_cast<std::size_t>(lattice.bins_x()), 1 + Bins::kReadAhead,
              static_cast<std::uint32_t>(bins.points));
  return bins;
}

void leave_out_repeats(Bins& bins, const BinWindow& window, ThreadPool& pool) {
  if (!has_repeats(bins, pool)) return;
  const auto columns = static_cast<std::size_t>(bins.lattice.bins_x());
  const std::size_t last = static_cast<std::size_t>(window.last_row) * columns;
  std::uint32_t from = bins.start[static_cast<std::size_t>(window.first_row) * columns];
  std::uint32_t to = from;
  for (std::size_t b = static_cast<std::size_t>(window.first_row) * columns; b < last; ++b) {
    bins.start[b] = to;
    for (const std::uint32_t end = bins.start[b + 1]; from < end; ++from) {
      const std::uint32_t kept = to - 1;
      const bool repeats = to > bins.start[b] && bins.z[from] == bins.z[kept] && bins.x[from] == bins.x[kept] &&
                           bins.y[from] == bins.y[kept];
      if (repeats) continue;
      bins.x[to] = bins.x[from];
      bins.y[to] = bins.y[from];
      bins.z[to++] = bins.z[from];
    }
  }
  bins.points = to;
  for (Buffer<float>* array : {&bins.x, &bins.y, &bins.z}) std::fill_n(array->get() + to, Bins::kReadAhead, 0.0F);
  std::fill_n(bins.start.get() + last, 1 + Bins::kReadAhead, to);
}

}  // namespace sparsha::pipeline
