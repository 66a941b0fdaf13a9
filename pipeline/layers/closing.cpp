// Dilation by a disc = union over dy of rows dilated by the disc's half width at dy; 64 nodes a word.
#include "pipeline/layers/closing.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <span>

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kRowsPerPiece = 64;

using Words = std::span<std::uint64_t>;
using ConstWords = std::span<const std::uint64_t>;

/// target |= source moved by `shift` bits to higher indices.
void or_moved_up(Words target, ConstWords source, int shift) {
  const auto words = static_cast<std::size_t>(shift / 64);
  const int bits = shift % 64;
  for (std::size_t k = source.size(); k-- > words;) {
    std::uint64_t value = source[k - words] << bits;
    if (bits != 0 && k > words) value |= source[k - words - 1] >> (64 - bits);
    target[k] |= value;
  }
}

/// target |= source moved by `shift` bits to lower indices.
void or_moved_down(Words target, ConstWords source, int shift) {
  const auto words = static_cast<std::size_t>(shift / 64);
  const int bits = shift % 64;
  for (std::size_t k = 0; k + words < source.size(); ++k) {
    std::uint64_t value = source[k + words] >> bits;
    if (bits != 0 && k + words + 1 < source.size()) value |= source[k + words + 1] << (64 - bits);
    target[k] |= value;
  }
}

/// Zeroes the bits beyond nx in a row's last word.
std::uint64_t last_word_mask(int nx) { return nx % 64 == 0 ? ~std::uint64_t{0} : (std::uint64_t{1} << (nx % 64)) - 1; }

/// Grows every run of a row by `width` nodes on both sides, tripling its reach each time.
void dilate_row(Words row, int width, int nx, std::vector<std::uint64_t>& scratch) {
  for (int reach = 0; reach < width;) {
    const int step = std::min(2 * reach + 1, width - reach);
    scratch.assign(row.begin(), row.end());
    or_moved_up(row, scratch, step);
    or_moved_down(row, scratch, step);
    reach += step;
  }
  row.back() &= last_word_mask(nx);
}

/// A copy with `margin` empty nodes left and right, and `above` of them above and below.
NodeSet with_margin(const NodeSet& set, int margin, int above) {
  NodeSet result(set.nx() + 2 * margin, set.ny() + 2 * above);
  std::vector<std::uint64_t> wide(result.words_per_row());
  for (int j = 0; j < set.ny(); ++j) {
    std::copy_n(set.row(j), set.words_per_row(), wide.begin());
    or_moved_up({result.row(j + above), result.words_per_row()}, wide, margin);
  }
  return result;
}

NodeSet without_margin(const NodeSet& set, int margin, int above) {
  NodeSet result(set.nx() - 2 * margin, set.ny() - 2 * above);
  std::vector<std::uint64_t> moved(set.words_per_row());
  for (int j = 0; j < result.ny(); ++j) {
    std::fill(moved.begin(), moved.end(), 0);
    or_moved_down(moved, {set.row(j + above), set.words_per_row()}, margin);
    std::copy_n(moved.begin(), result.words_per_row(), result.row(j));
    result.row(j)[result.words_per_row() - 1] &= last_word_mask(result.nx());
  }
  return result;
}

NodeSet transposed(const NodeSet& set) {
  NodeSet result(set.ny(), set.nx());
  for (int j = 0; j < set.ny(); ++j)
    for (int i = 0; i < set.nx(); ++i)
      if (set.contains(i, j)) result.insert(j, i);
  return result;
}

/// The closing of a set of few rows by a disc of many: rows of centres one by one, so that the margin, which is many
/// times the set, is never in memory.
class NarrowClosing {
 public:
  NarrowClosing(const NodeSet& set, double radius, int margin)
      : ny_(set.ny()),
        nx_(set.nx() + 2 * margin),
        margin_(margin),
        squared_(radius * radius * (1 + 1e-12)),
        set_(with_margin(set, margin, 0)),
        open_(nx_, ny_) {}

  /// The closed set, as wide as with its margin.
  NodeSet run(ThreadPool& pool) {
    const auto centres = static_cast<std::size_t>(ny_ + 2 * margin_);
    pool.for_ranges(centres, kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
      NodeSet open(nx_, ny_);
      std::vector<std::uint64_t> free(open.words_per_row()), row, scratch;
      for (std::size_t s = begin; s < end; ++s) add_centres(static_cast<int>(s) - margin_, open, free, row, scratch);
      const std::lock_guard lock(mutex_);
      for (int j = 0; j < ny_; ++j)
        for (std::size_t k = 0; k < open.words_per_row(); ++k) open_.row(j)[k] |= open.row(j)[k];
    });
    open_.invert();
    return std::move(open_);
  }

 private:
  /// Half the disc's width `dy` rows from its centre; -1 beyond it.
  [[nodiscard]] int width_at(int dy) const {
    const double half = squared_ - static_cast<double>(dy) * dy;
    return half < 0.0 ? -1 : static_cast<int>(std::min(std::sqrt(half), static_cast<double>(nx_)));
  }

  /// What discs centred in row `centre` cover that are free of the set.
  void add_centres(int centre, NodeSet& open, std::vector<std::uint64_t>& free, std::vector<std::uint64_t>& row,
                   std::vector<std::uint64_t>& scratch) const {
    const std::size_t words = open.words_per_row();
    const auto dilated = [&](const std::uint64_t* from, int dy) {
      row.assign(from, from + words);
      dilate_row(row, width_at(dy), nx_, scratch);
    };
    std::fill(free.begin(), free.end(), 0);
    for (int j = 0; j < ny_; ++j) {
      if (width_at(std::abs(centre - j)) < 0) continue;
      dilated(set_.row(j), std::abs(centre - j));
      for (std::size_t k = 0; k < words; ++k) free[k] |= row[k];
    }
    for (std::uint64_t& word : free) word = ~word;
    free.back() &= last_word_mask(nx_);
    for (int j = 0; j < ny_; ++j) {
      if (width_at(std::abs(centre - j)) < 0) continue;
      dilated(free.data(), std::abs(centre - j));
      for (std::size_t k = 0; k < words; ++k) open.row(j)[k] |= row[k];
    }
  }

  int ny_, nx_, margin_;
  double squared_;
  NodeSet set_, open_;
  std::mutex mutex_;
};

}  // namespace

NodeSet::NodeSet(int nx, int ny)
    : nx_(nx),
      ny_(ny),
      words_((static_cast<std::size_t>(nx) + 63) / 64),
      bits_(words_ * static_cast<std::size_t>(ny)) {}

void NodeSet::invert() {
  for (int j = 0; j < ny_; ++j) {
    std::uint64_t* words = row(j);
    for (std::size_t k = 0; k < words_; ++k) words[k] = ~words[k];
    if (words_ > 0) words[words_ - 1] &= last_word_mask(nx_);
  }
}

std::size_t NodeSet::count() const {
  std::size_t total = 0;
  for (const std::uint64_t word : bits_) total += static_cast<std::size_t>(std::popcount(word));
  return total;
}

NodeSet nodes_of(const scene::DepthGrid& grid, scene::NodeState state) {
  NodeSet result(grid.lattice.nx, grid.lattice.ny);
  for (int j = 0; j < result.ny(); ++j) {
    const scene::NodeState* states = grid.state.data() + grid.lattice.index(0, j);
    std::uint64_t* words = result.row(j);
    for (int i = 0; i < result.nx(); ++i)
      words[i >> 6] |= static_cast<std::uint64_t>(states[i] == state ? 1 : 0) << (i & 63);
  }
  return result;
}

NodeSet dilate_by_disc(const NodeSet& set, double radius, ThreadPool& pool) {
  NodeSet result(set.nx(), set.ny());
  if (set.nx() == 0 || set.ny() == 0) return result;
  NodeSet widened = set;
  const double squared = radius * radius * (1 + 1e-12);
  const int reach = static_cast<int>(std::min(std::sqrt(squared), set.ny() - 1.0));
  const auto rows = static_cast<std::size_t>(set.ny());
  const std::size_t words = set.words_per_row();
  int width = 0;
  for (int dy = reach; dy >= 0; --dy) {
    const double half = std::sqrt(std::max(0.0, squared - static_cast<double>(dy) * dy));
    const int wanted = static_cast<int>(std::min(half, static_cast<double>(set.nx())));
    if (wanted > width) {
      pool.for_ranges(rows, kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint64_t> scratch;
        for (std::size_t j = begin; j < end; ++j)
          dilate_row({widened.row(static_cast<int>(j)), words}, wanted - width, set.nx(), scratch);
      });
      width = wanted;
    }
    pool.for_ranges(rows, kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
      for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j) {
        std::uint64_t* target = result.row(j);
        for (const int other : {j - dy, j + dy}) {
          if (other < 0 || other >= set.ny()) continue;
          const std::uint64_t* source = widened.row(other);
          for (std::size_t k = 0; k < words; ++k) target[k] |= source[k];
        }
      }
    });
  }
  return result;
}

NodeSet close_by_disc(const NodeSet& set, double diameter, ThreadPool& pool) {
  const double radius = diameter / 2;
  if (radius < 1 || set.nx() == 0 || set.ny() == 0) return set;
  const int margin = static_cast<int>(std::min(radius * (1 + 1e-12), static_cast<double>(set.nx() + set.ny()))) + 1;
  constexpr int kNarrow = 8;  // margins as wide as so many sets: row by row is faster then, too
  if (margin > kNarrow * set.nx() && set.nx() < set.ny())
    return transposed(close_by_disc(transposed(set), diameter, pool));
  if (margin > kNarrow * set.ny()) return without_margin(NarrowClosing(set, radius, margin).run(pool), margin, 0);
  NodeSet free = dilate_by_disc(with_margin(set, margin, margin), radius, pool);
  free.invert();
  NodeSet closed = dilate_by_disc(free, radius, pool);
  closed.invert();
  return without_margin(closed, margin, margin);
}

namespace {

/// The nodes that ways along rows and columns reach from the lattice's border past a set, run by run.
class Outside {
 public:
  explicit Outside(const NodeSet& set) : free_(set), reached_(set.nx(), set.ny()) { free_.invert(); }

  NodeSet run() {
    const int nx = free_.nx(), ny = free_.ny();
    if (nx == 0 || ny == 0) return std::move(reached_);
    for (int j = 0; j < ny; ++j) {
      reach(0, j);
      reach(nx - 1, j);
    }
    reach_runs(0, 0, nx);
    reach_runs(ny - 1, 0, nx);
    while (!pending_.empty()) {
      const Run run = pending_.back();
      pending_.pop_back();
      if (run.j > 0) reach_runs(run.j - 1, run.first, run.end);
      if (run.j + 1 < ny) reach_runs(run.j + 1, run.first, run.end);
    }
    return std::move(reached_);
  }

 private:
  struct Run {
    int j, first, end;  // nodes [first, end)
  };

  /// The first node of row j from i on that is free, or not free; nx when there is none.
  [[nodiscard]] int next(int i, int j, bool free) const {
    const std::uint64_t* const words = free_.row(j);
    for (int k = i >> 6; k < static_cast<int>(free_.words_per_row()); ++k) {
      std::uint64_t word = free ? words[k] : ~words[k];
      if (k == i >> 6) word &= ~std::uint64_t{0} << (i & 63);
      if (word != 0) return std::min(free_.nx(), 64 * k + std::countr_zero(word));
    }
    return free_.nx();
  }
  /// The first node of the free run that ends with node i.
  [[nodiscard]] int begin_of_run(int i, int j) const {
    const std::uint64_t* const words = free_.row(j);
    for (int k = i >> 6; k >= 0; --k) {
      std::uint64_t word = ~words[k];
      if (k == i >> 6) word &= ~std::uint64_t{0} >> (63 - (i & 63));
      if (word != 0) return 64 * k + 64 - std::countl_zero(word);
    }
    return 0;
  }
  /// The free run about a free node.
  [[nodiscard]] Run run_about(int i, int j) const { return {j, begin_of_run(i, j), next(i, j, false)}; }

  void reach(int i, int j) {
    if (free_.contains(i, j) && !reached_.contains(i, j)) take(run_about(i, j));
  }
  /// All free runs of row j that have a node among [first, end).
  void reach_runs(int j, int first, int end) {
    for (int i = next(first, j, true); i < end;) {
      const Run run = run_about(i, j);
      if (!reached_.contains(i, j)) take(run);
      i = next(run.end, j, true);
    }
  }
  void take(const Run& run) {
    std::uint64_t* const words = reached_.row(run.j);
    for (int k = run.first >> 6; k <= (run.end - 1) >> 6; ++k) {
      std::uint64_t word = ~std::uint64_t{0};
      if (k == run.first >> 6) word &= word << (run.first & 63);
      if (k == (run.end - 1) >> 6) word &= ~std::uint64_t{0} >> (63 - ((run.end - 1) & 63));
      words[k] |= word;
    }
    pending_.push_back(run);
  }

  NodeSet free_, reached_;
  std::vector<Run> pending_;
};

}  // namespace

NodeSet fill_holes(const NodeSet& set) {
  NodeSet outside = Outside(set).run();
  outside.invert();
  return outside;
}

double outline_diameter(const scene::Lattice& lattice, double max_gap_m) {
  constexpr double kLeast = 3.0;
  return std::max(max_gap_m / lattice.spacing_m, kLeast);
}

NodeSet outline_nodes(const scene::DepthGrid& grid, double max_gap_m, ThreadPool& pool) {
  const NodeSet measured = nodes_of(grid, scene::NodeState::measured);
  return fill_holes(close_by_disc(measured, outline_diameter(grid.lattice, max_gap_m), pool));
}

}  // namespace sparsha::pipeline
