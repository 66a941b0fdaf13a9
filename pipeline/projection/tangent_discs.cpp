// Sorts points into columns, asks the kernel for their discs row by row and packs those that were found.
#include "pipeline/projection/tangent_discs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/surface_plane.h"

namespace sparsha::pipeline {
namespace {

constexpr float kLowest = -std::numeric_limits<float>::infinity();
// Between a front and points below it that are left out: what the steepest disc that reaches the front descends.
constexpr double kHidden = 25.0;  // spacings, where no disc is wider than DiscRule::kMostSpacings
constexpr int kHiddenBy = 2;      // columns to each side that must all have a front

/// Rows and columns that hold points.
struct Rows {
  std::size_t nx, first, last;
};

// A value per column. Memory of other rows is not touched.
template <typename T>
Buffer<T> of_columns(const BinLattice& columns, const Rows& rows, T value) {
  Buffer<T> values = make_buffer<T>(columns.bin_count());
  std::fill(values.get() + rows.first * rows.nx, values.get() + rows.last * rows.nx, value);
  return values;
}

// Below these heights, one per column, points are hidden: all columns around have two points far above.
Buffer<float> hidden_below(const Bins& bins, const Rows& rows, double depth_m, ThreadPool& pool) {
  const std::size_t nx = rows.nx;
  const Buffer<float> second = of_columns(bins.lattice, rows, kLowest);
  Buffer<float> hidden = of_columns(bins.lattice, rows, kLowest);
  pool.for_ranges(rows.last - rows.first, 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = (rows.first + begin) * nx; c < (rows.first + end) * nx; ++c) {
      if (bins.start[c + 1] - bins.start[c] >= 2) second[c] = bins.z[bins.start[c] + 1];
    }
  });
  pool.for_ranges(rows.last - rows.first, 8, [&](std::size_t begin, std::size_t end) {
    std::vector<float> lowest(nx);
    for (std::size_t j = rows.first + begin; j < rows.first + end; ++j) {
      if (j < rows.first + kHiddenBy || j + kHiddenBy >= rows.last) continue;
      std::copy_n(second.get() + (j - kHiddenBy) * nx, nx, lowest.begin());
      for (std::size_t b = j - kHiddenBy + 1; b <= j + kHiddenBy; ++b) {
        for (std::size_t i = 0; i < nx; ++i) lowest[i] = std::min(lowest[i], second[b * nx + i]);
      }
      for (std::size_t i = kHiddenBy; i + kHiddenBy < nx; ++i) {
        float least = lowest[i];
        for (std::size_t a = i - kHiddenBy; a <= i + kHiddenBy; ++a) least = std::min(least, lowest[a]);
        hidden[j * nx + i] = least - static_cast<float>(depth_m);
      }
    }
  });
  return hidden;
}

/// What the kernel writes, one value per point.
struct Found {
  Buffer<float> x, y, z, slope_x, slope_y, above, radius2;

  Found(std::size_t count, MemoryStore* store) {
    for (Buffer<float>* array : {&x, &y, &z, &slope_x, &slope_y, &above, &radius2}) {
      *array = make_buffer<float>(count + DiscKernel::kReadAhead, store);
    }
  }
};

// Moves the discs that were found to the front of their row and notes where each column's begin.
void pack_row(const Bins& bins, std::size_t row, std::size_t nx, Found& found, std::uint32_t* start, float* records) {
  std::uint32_t to = bins.start[row * nx];
  for (std::size_t i = 0; i < nx; ++i) {
    start[i] = to;
    for (std::uint32_t p = bins.start[row * nx + i]; p < bins.start[row * nx + i + 1]; ++p) {
      if (!(found.radius2[p] > 0.0F)) continue;
      float* record = records + kDiscRecord * to;
      for (const Buffer<float>* array :
           {&found.x, &found.y, &found.z, &found.slope_x, &found.slope_y, &found.above, &found.radius2}) {
        *record++ = (*array)[p];
      }
      *record = 0.0F;
      for (Buffer<float>* array : {&found.x, &found.y, &found.slope_x, &found.slope_y, &found.radius2}) {
        (*array)[to] = (*array)[p];
      }
      ++to;
    }
  }
  start[nx] = to;
}

// How many columns away discs may lie that reach each column. A foot may lie a little outside its point's column.
std::vector<std::uint8_t> rings_of_columns(const TangentDiscs& discs, const Rows& rows, double side_m, int widest) {
  const std::size_t nx = rows.nx;
  const int most = widest + 1;
  const Buffer<std::uint8_t> own = of_columns<std::uint8_t>(discs.columns, rows, 0);
  for (std::size_t j = rows.first; j < rows.last; ++j) {
    for (std::size_t i = 0; i < nx; ++i) {
      float widest2 = 0.0F;
      const std::uint32_t* start = discs.start.get() + j * (nx + 1) + i;
      for (std::uint32_t d = start[0]; d < start[1]; ++d) widest2 = std::max(widest2, discs.radius2[d]);
      const double sides = std::sqrt(static_cast<double>(widest2)) / side_m;
      own[j * nx + i] = static_cast<std::uint8_t>(std::min<double>(most, std::ceil(sides)));
    }
  }
  // A foot may lie a little outside its point's column, so one ring is looked at in any case.
  std::vector<std::uint8_t> rings(discs.columns.bin_count(), 1);
  for (std::size_t j = rows.first; j < rows.last; ++j) {
    for (std::size_t i = 0; i < nx; ++i) {
      const std::size_t reach = own[j * nx + i];
      if (reach <= 1) continue;
      for (std::size_t b = j > reach ? j - reach : 0; b <= std::min(rows.last - 1, j + reach); ++b) {
        for (std::size_t a = i > reach ? i - reach : 0; a <= std::min(nx - 1, i + reach); ++a) {
          std::uint8_t& here = rings[b * nx + a];
          here = std::max(here, static_cast<std::uint8_t>(reach));
        }
      }
    }
  }
  return rings;
}

}  // namespace

BinLattice disc_columns(const BinLattice& nodes, const DiscRule& rule) {
  // Beyond the nodes, with the margin of every BinLattice (two columns): the widest disc and its neighbours.
  const int beyond = 2 * rule.widest() - 2;
  const double side_m = disc_column_m(rule);
  BinLattice columns;
  columns.spacing_m = side_m;
  columns.x0_m = nodes.x0_m - beyond * side_m;
  columns.y0_m = nodes.y0_m - beyond * side_m;
  columns.nx = static_cast<int>(std::ceil((nodes.nx - 1) * nodes.spacing_m / side_m)) + 1 + 2 * beyond;
  columns.ny = static_cast<int>(std::ceil((nodes.ny - 1) * nodes.spacing_m / side_m)) + 1 + 2 * beyond;
  return columns;
}

TangentDiscs find_discs(const OrientedPoints& points, const std::vector<std::uint8_t>& skip, const BinLattice& columns,
                        const BinWindow& window, const DiscRule& rule, bool all, ThreadPool& pool, MemoryStore* store) {
  Bins bins = sort_into_bins(points, skip, columns, window, pool, store);
  leave_out_repeats(bins, window, pool);
  const Rows rows{static_cast<std::size_t>(columns.bins_x()), static_cast<std::size_t>(window.first_row),
                  static_cast<std::size_t>(window.last_row)};
  const double hidden_m = kHidden * rule.most_spacings / DiscRule::kMostSpacings * rule.spacing_m;
  const Buffer<float> hidden = all ? of_columns(columns, rows, kLowest) : hidden_below(bins, rows, hidden_m, pool);
  Found found(bins.points, store);

  DiscKernel kernel;
  kernel.start = bins.start.get();
  kernel.x = bins.x.get();
  kernel.y = bins.y.get();
  kernel.z = bins.z.get();
  kernel.bins_x = rows.nx;
  kernel.first_row = rows.first;
  kernel.last_row = rows.last;
  kernel.side_m = static_cast<float>(columns.spacing_m);
  kernel.wanted = rule.neighbours;
  kernel.least = (rule.neighbours + 1) / 2 + 1;
  kernel.rings = static_cast<std::size_t>(rule.widest());
  kernel.most_spacing_m = static_cast<float>(rule.most_spacings * rule.spacing_m);
  if (rule.scattered) kernel.dense_spacing_m = static_cast<float>(DiscRule::kDenseSpacings * rule.spacing_m);
  kernel.least_nz = static_cast<float>(rule.least_nz);
  kernel.narrow = static_cast<float>(SurfacePlane::kNarrow);
  kernel.least_width2 = rule.lines ? static_cast<float>(2.0 * rule.noise_m * rule.noise_m) : 0.0F;
  kernel.reach = static_cast<float>(DiscRule::kReach);
  kernel.noise_m = static_cast<float>(rule.noise_m);
  kernel.needed_m = hidden.get();
  kernel.foot_x = found.x.get();
  kernel.foot_y = found.y.get();
  kernel.foot_z = found.z.get();
  kernel.slope_x = found.slope_x.get();
  kernel.slope_y = found.slope_y.get();
  kernel.above = found.above.get();
  kernel.radius2 = found.radius2.get();

  TangentDiscs discs;
  discs.columns = columns;
  discs.window = window;
  discs.start = make_buffer<std::uint32_t>(static_cast<std::size_t>(columns.bins_y()) * (rows.nx + 1), store);
  discs.records = make_buffer<float>(kDiscRecord * bins.points, store);
  pool.for_ranges(rows.last - rows.first, 2, [&](std::size_t begin, std::size_t end) {
    const auto scratch = make_buffer<float>(DiscKernel::kScratch);
    DiscKernel mine = kernel;
    mine.scratch = scratch.get();
    for (std::size_t row = rows.first + begin; row < rows.first + end; ++row) {
      fastest_kernels().fit_discs(mine, row);
      pack_row(bins, row, rows.nx, found, discs.start.get() + row * (rows.nx + 1), discs.records.get());
    }
  });
  discs.x = std::move(found.x);
  discs.y = std::move(found.y);
  discs.slope_x = std::move(found.slope_x);
  discs.slope_y = std::move(found.slope_y);
  discs.radius2 = std::move(found.radius2);
  discs.rings = rings_of_columns(discs, rows, columns.spacing_m, rule.widest());
  return discs;
}

TangentDiscs arrange_discs(std::span<const float> records, const BinLattice& columns, const DiscRule& rule) {
  const std::size_t count = records.size() / kDiscRecord;
  const auto nx = static_cast<std::size_t>(columns.bins_x());
  const auto ny = static_cast<std::size_t>(columns.bins_y());
  const BinLocator locator(columns);
  TangentDiscs discs;
  discs.columns = columns;
  discs.window = BinWindow::all(columns);
  discs.start = make_buffer<std::uint32_t>(ny * (nx + 1));
  // Each row of columns has a start more than columns: places of a bin's end and the next row's begin.
  std::vector<std::uint32_t> place(count, 0xffffffffU);
  std::vector<std::uint32_t> sizes(ny * (nx + 1) + 1, 0);
  for (std::size_t d = 0; d < count; ++d) {
    int column = 0;
    int row = 0;
    if (!locator.locate(records[kDiscRecord * d], records[kDiscRecord * d + 1], column, row)) continue;
    place[d] = static_cast<std::uint32_t>(static_cast<std::size_t>(row) * (nx + 1) + static_cast<std::size_t>(column));
    ++sizes[place[d] + 1];
  }
  for (std::size_t c = 1; c < sizes.size(); ++c) sizes[c] += sizes[c - 1];
  std::copy_n(sizes.begin(), ny * (nx + 1), discs.start.get());
  const std::size_t room = count + DiscKernel::kReadAhead;
  for (Buffer<float>* array : {&discs.x, &discs.y, &discs.slope_x, &discs.slope_y, &discs.radius2}) {
    *array = make_buffer<float>(room);
    std::fill_n(array->get(), room, 0.0F);
  }
  discs.records = make_buffer<float>(kDiscRecord * room);
  for (std::size_t d = 0; d < count; ++d) {
    if (place[d] == 0xffffffffU) continue;
    const std::uint32_t to = sizes[place[d]]++;
    const float* record = records.data() + kDiscRecord * d;
    std::copy_n(record, kDiscRecord, discs.records.get() + kDiscRecord * to);
    discs.x[to] = record[0];
    discs.y[to] = record[1];
    discs.slope_x[to] = record[3];
    discs.slope_y[to] = record[4];
    discs.radius2[to] = record[6];
  }
  discs.rings = rings_of_columns(discs, {nx, 0, ny}, columns.spacing_m, rule.widest());
  return discs;
}

// A plane through 14 points is uncertain by 0.27 standard deviations of noise at its foot and by 0.69 at its rim, so
// two discs of one layer that meet there differ by one.
DiscNodeKernel node_kernel(const TangentDiscs& discs, const BinLattice& nodes, double noise_m, bool lines) {
  const BinLocator locator(discs.columns);
  DiscNodeKernel kernel;
  kernel.start = discs.start.get();
  kernel.x = discs.x.get();
  kernel.y = discs.y.get();
  kernel.slope_x = discs.slope_x.get();
  kernel.slope_y = discs.slope_y.get();
  kernel.radius2 = discs.radius2.get();
  kernel.records = discs.records.get();
  kernel.rings = discs.rings.data();
  kernel.bins_x = static_cast<std::size_t>(discs.columns.bins_x());
  kernel.first_row = static_cast<std::size_t>(discs.window.first_row);
  kernel.last_row = static_cast<std::size_t>(discs.window.last_row);
  kernel.columns_x0_m = locator.x_shift_m;
  kernel.columns_y0_m = locator.y_shift_m;
  kernel.per_side = locator.per_m;
  kernel.x0_m = nodes.x0_m;
  kernel.y0_m = nodes.y0_m;
  kernel.spacing_m = nodes.spacing_m;
  kernel.nx = static_cast<std::size_t>(nodes.nx);
  kernel.per_reach = static_cast<float>(1.0 / DiscRule::kReach);
  kernel.link_noise_m = static_cast<float>(noise_m);
  kernel.lines = lines;
  return kernel;
}

}  // namespace sparsha::pipeline
