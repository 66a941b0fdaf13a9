// Steps by second differences: a surface, however steep, goes on as it came on one side at least; across a step the
// slope changes by the jump and back again.
#include "pipeline/layers/surface_links.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kRowsPerPiece = 48;
// A jump counts from this many spacings or noises on, more on slopes: there a point's place, too, moves its height.
constexpr double kJump = 0.9, kJumpOfSlope = 0.1;
constexpr double kNoises = 8.0, kNoisesOfSlope = 0.25;
// Steeper than that no surface is measured (the projection's discs end at 83 degrees).
constexpr double kSteepest = 8.0;
// A node half-way up a step makes two jumps of it, steeper than what flanks are trusted to be.
constexpr double kSteepPair = 3.5;
constexpr double kGentle = 2.0;

/// Heights in spacings about one link, in its direction: `before` and `after` lie beyond its ends, NaN where unknown.
struct LinkHeights {
  double before2, before, from, to, after, after2;
};

class StepTest {
 public:
  StepTest(double spacing_m, const StepRule& rule)
      : scale_(1 / spacing_m),
        jump_(std::min(std::max(kJump, kNoises * rule.noise_m / spacing_m), rule.step_m / spacing_m)),
        noise_(rule.noise_m / spacing_m) {}

  [[nodiscard]] double scale() const { return scale_; }
  /// What cannot be a step: a slope that differs by less than this from one beside it, and is itself below kGentle.
  [[nodiscard]] double harmless() const { return jump_; }

  [[nodiscard]] bool cuts(const LinkHeights& z) const {
    const double own = z.to - z.from;
    if (!(std::abs(own) <= kSteepest)) return true;
    const double s0 = z.from - z.before, s2 = z.after - z.to;
    if (beyond(own, s0, s2) > limit(s0, s2)) return true;
    return half_way(z.before, z.from, z.to, z.after, z.after2) || half_way(z.before2, z.before, z.from, z.to, z.after);
  }

 private:
  /// How far a slope lies outside of those on its two sides; NaN ones say nothing.
  static double beyond(double own, double s0, double s2) {
    if (std::isnan(s0)) s0 = std::isnan(s2) ? 0.0 : s2;
    if (std::isnan(s2)) s2 = s0;
    return std::max({0.0, own - std::max(s0, s2), std::min(s0, s2) - own});
  }
  [[nodiscard]] double limit(double s0, double s2) const {
    const double steep = std::isnan(s0) ? (std::isnan(s2) ? 0.0 : std::abs(s2))
                                        : (std::isnan(s2) ? std::abs(s0) : std::min(std::abs(s0), std::abs(s2)));
    return std::max(jump_ + kJumpOfSlope * steep, std::min(jump_, kNoises * noise_) * (1 + kNoisesOfSlope * steep));
  }
  /// Is `middle` half-way up a step from `low` to `high`?
  [[nodiscard]] bool half_way(double before, double low, double middle, double high, double after) const {
    const double first = middle - low, second = high - middle, mean = 0.5 * (first + second);
    const double s0 = low - before, s3 = after - high;
    if (!(std::abs(mean) > kSteepPair) || std::isnan(s0) || std::isnan(s3)) return false;
    const double most = 2 * limit(s0, s3);
    return std::abs(first - second) <= most && beyond(mean, s0, s3) > most;
  }

  double scale_, jump_, noise_;
};

/// Packs bytes of 0 and 1 into bits.
void pack(const std::vector<std::uint8_t>& bytes, std::uint64_t* words, std::size_t count) {
  for (std::size_t w = 0; w < count; ++w) {
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      std::uint64_t eight = 0;
      std::memcpy(&eight, bytes.data() + 64 * w + 8 * k, 8);
      bits |= ((eight * 0x0102040810204080U) >> 56) << (8 * k);
    }
    words[w] = bits;
  }
}

/// 0 where the link from b to c cannot be a step, between a before and d after it; else 1, so where one is unknown.
void doubt(const float* a, const float* b, const float* c, const float* d, std::size_t count, float harmless_m,
           float gentle_m, std::uint8_t* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const float own = c[i] - b[i];
    const int as_before = std::abs(own - (b[i] - a[i])) <= harmless_m ? 1 : 0;
    const int as_after = std::abs(d[i] - c[i] - own) <= harmless_m ? 1 : 0;
    const int gentle = std::abs(own) <= gentle_m ? 1 : 0;
    out[i] = static_cast<std::uint8_t>(1 ^ (gentle & (as_before | as_after)));
  }
}

/// Links that are cut, a word of zeros before and after each row.
class Cuts {
 public:
  Cuts(const scene::DepthGrid& grid, const StepRule& rule, std::size_t row_words)
      : grid_(grid), test_(grid.lattice.spacing_m, rule), row_words_(row_words) {
    right.resize(row_words * static_cast<std::size_t>(grid.lattice.ny));
    up.resize(right.size());
  }

  void find_row(int j, std::vector<std::uint8_t>& bytes) {
    const scene::Lattice& lattice = grid_.lattice;
    const auto nx = static_cast<std::size_t>(lattice.nx);
    const std::size_t words = row_words_ - 2, first = row_words_ * static_cast<std::size_t>(j) + 1;
    const auto harmless = static_cast<float>(test_.harmless() * lattice.spacing_m);
    const auto gentle = static_cast<float>(kGentle * lattice.spacing_m);
    const float* z = grid_.height_m.data() + lattice.index(0, j);
    bytes.assign(64 * words, 1);
    if (nx > 3) doubt(z, z + 1, z + 2, z + 3, nx - 3, harmless, gentle, bytes.data() + 1);
    pack(bytes, right.data() + first, words);
    std::fill(bytes.begin(), bytes.end(), std::uint8_t{1});
    if (j > 0 && j + 2 < lattice.ny) doubt(z - nx, z, z + nx, z + 2 * nx, nx, harmless, gentle, bytes.data());
    pack(bytes, up.data() + first, words);
    for (std::size_t w = 0; w < words; ++w) {
      look_closer(right[first + w], static_cast<int>(64 * w), j, 1, 0);
      look_closer(up[first + w], static_cast<int>(64 * w), j, 0, 1);
    }
  }

  std::vector<std::uint64_t> right, up;

 private:
  void look_closer(std::uint64_t& word, int i0, int j, int di, int dj) const {
    for (std::uint64_t left = word; left != 0; left &= left - 1) {
      const int bit = std::countr_zero(left), i = i0 + bit;
      const LinkHeights z{at(i - 2 * di, j - 2 * dj), at(i - di, j - dj),         at(i, j),
                          at(i + di, j + dj),         at(i + 2 * di, j + 2 * dj), at(i + 3 * di, j + 3 * dj)};
      if (!test_.cuts(z)) word &= ~(std::uint64_t{1} << bit);
    }
  }
  [[nodiscard]] double at(int i, int j) const {
    const scene::Lattice& lattice = grid_.lattice;
    if (i < 0 || j < 0 || i >= lattice.nx || j >= lattice.ny) return static_cast<double>(scene::kUnknownHeight);
    return test_.scale() * static_cast<double>(grid_.height_m[lattice.index(i, j)]);
  }

  const scene::DepthGrid& grid_;
  StepTest test_;
  std::size_t row_words_;
};

}  // namespace

SurfaceLinks::SurfaceLinks(const scene::DepthGrid& grid, const StepRule& rule, ThreadPool& pool)
    : nx_(grid.lattice.nx), ny_(grid.lattice.ny), phase_words_((static_cast<std::size_t>(nx_) + 63) / 64 + 2) {
  if (grid.lattice.count() == 0) return;
  Cuts cuts(grid, rule, phase_words_);
  const auto rows = static_cast<std::size_t>(ny_);
  pool.for_ranges(rows, kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint8_t> bytes;
    for (std::size_t j = begin; j < end; ++j) cuts.find_row(static_cast<int>(j), bytes);
  });
  right_.resize(cuts.right.size());
  up_.resize(cuts.up.size());
  // A step goes on from link to link; a cut that stands alone is noise.
  pool.for_ranges(rows, kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    const std::uint64_t none = 0;
    for (std::size_t j = begin; j < end; ++j)
      for (std::size_t w = 1; w + 1 < phase_words_; ++w) {
        const std::size_t n = j * phase_words_ + w;
        const bool low = j == 0, high = j + 1 == rows;
        const std::uint64_t r = cuts.right[n], u = cuts.up[n];
        if ((r | u) != 0) {
          const std::uint64_t below_r = low ? none : cuts.right[n - phase_words_];
          const std::uint64_t above_r = high ? none : cuts.right[n + phase_words_];
          const std::uint64_t below_u = low ? none : cuts.up[n - phase_words_];
          const std::uint64_t below_u1 = low ? none : (below_u >> 1) | (cuts.up[n - phase_words_ + 1] << 63);
          const std::uint64_t u_right = (u >> 1) | (cuts.up[n + 1] << 63), u_left = (u << 1) | (cuts.up[n - 1] >> 63);
          const std::uint64_t r_left = (r << 1) | (cuts.right[n - 1] >> 63);
          const std::uint64_t above_left = high ? none : (above_r << 1) | (cuts.right[n + phase_words_ - 1] >> 63);
          right_[n] = ~(r & (below_r | above_r | u | u_right | below_u | below_u1));
          up_[n] = ~(u & (u_left | u_right | r | r_left | above_r | above_left));
        } else {
          right_[n] = up_[n] = ~none;
        }
      }
    // The border and what lies beyond it have no links, and unknown nodes none however they stand.
    const std::size_t last = (static_cast<std::size_t>(nx_) - 1) / 64 + 1,
                      bit = (static_cast<std::size_t>(nx_) - 1) % 64;
    const std::uint64_t known_columns = bit == 63 ? ~none : (std::uint64_t{2} << bit) - 1;
    for (std::size_t j = begin; j < end; ++j) {
      right_[j * phase_words_ + last] &= known_columns >> 1;
      up_[j * phase_words_ + last] &= known_columns;
      if (j + 1 == rows) std::fill_n(up_.begin() + static_cast<std::ptrdiff_t>(j * phase_words_), phase_words_, none);
    }
  });
}

SurfaceLinks SurfaceLinks::thinned(int stride) const {
  if (stride == 1) return *this;
  SurfaceLinks thin;
  thin.nx_ = nx_;
  thin.ny_ = ny_;
  thin.stride_ = stride;
  const auto step = static_cast<std::size_t>(stride);
  thin.phase_words_ = ((static_cast<std::size_t>(nx_) + step - 1) / step + 63) / 64 + 2;
  thin.right_.resize(static_cast<std::size_t>(ny_) * step * thin.phase_words_);
  thin.up_.resize(thin.right_.size());
  std::vector<int> whole_up(static_cast<std::size_t>(nx_),
                            0);  // links above this row that are whole, one after another
  for (int j = ny_ - 1; j >= 0; --j) {
    int whole_right = 0;
    for (int i = nx_ - 1; i >= 0; --i) {
      const auto column = static_cast<std::size_t>(i);
      whole_right = (right(i, j) & 1U) != 0 ? whole_right + 1 : 0;
      whole_up[column] = (up(i, j) & 1U) != 0 ? whole_up[column] + 1 : 0;
      const std::size_t at = column / step + 64;
      const std::size_t n = (static_cast<std::size_t>(j) * step + column % step) * thin.phase_words_ + at / 64;
      const std::uint64_t bit = std::uint64_t{1} << (at % 64);
      if (whole_right >= stride) thin.right_[n] |= bit;
      if (whole_up[column] >= stride) thin.up_[n] |= bit;
    }
  }
  return thin;
}

std::uint64_t SurfaceLinks::word(const std::vector<std::uint64_t>& bits, int i, int j) const {
  if (j < 0 || j >= ny_) return 0;
  const int column = i >= 0 ? i / stride_ : -((stride_ - 1 - i) / stride_), phase = i - column * stride_;
  const auto at = static_cast<std::size_t>(column + 64);
  const std::uint64_t* words = bits.data() + static_cast<std::size_t>(j * stride_ + phase) * phase_words_ + at / 64;
  const std::size_t shift = at % 64;
  return shift == 0 ? words[0] : (words[0] >> shift) | (words[1] << (64 - shift));
}

void SurfaceLinks::loose_nodes(int j, std::vector<std::uint64_t>& words) const {
  words.resize(phase_words_ - 2);
  const std::uint64_t all = ~std::uint64_t{0};
  for (std::size_t w = 0; w < words.size(); ++w) {
    const int i = static_cast<int>(64 * w);
    const int columns = std::min(nx_ - i, 64);
    const std::uint64_t inside = columns == 64 ? all : (std::uint64_t{1} << columns) - 1;
    std::uint64_t to_right = right(i, j), to_left = right(i - 1, j);
    if (i + columns == nx_) to_right |= std::uint64_t{1} << (columns - 1);
    if (i == 0) to_left |= 1;
    words[w] = inside & ~(to_right & to_left & (j + 1 < ny_ ? up(i, j) : all) & (j > 0 ? up(i, j - 1) : all));
  }
}

namespace {

/// Fills `seeds` on along links: bit k of `along` leads to bit k + 1 (k - 1 for the way down).
std::uint64_t spread_up(std::uint64_t seeds, std::uint64_t along) {
  std::uint64_t open = along << 1;
  for (int shift = 1; shift <= LayerWindow::kMostRadius; shift *= 2) {
    seeds |= open & (seeds << shift);
    open &= open << shift;
  }
  return seeds;
}
std::uint64_t spread_down(std::uint64_t seeds, std::uint64_t along) {
  std::uint64_t open = along;
  for (int shift = 1; shift <= LayerWindow::kMostRadius; shift *= 2) {
    seeds |= open & (seeds >> shift);
    open &= open >> shift;
  }
  return seeds;
}

}  // namespace

void LayerWindow::find(const SurfaceLinks& links, int i, int j, int radius) {
  radius_ = radius;
  count_ = 0;
  const int s = links.stride(), first = i - s * radius;
  const std::uint64_t centre = std::uint64_t{1} << radius, all = (std::uint64_t{1} << (2 * radius + 1)) - 1;
  const std::uint64_t high = all & ~(centre - 1), low = (centre << 1) - 1;
  const auto row_links = [&](int row) { return links.right(first, row) & (all >> 1); };
  // Nodes to the right and to the left of the centre, the centre's column in both.
  const std::uint64_t middle = row_links(j);
  const std::uint64_t to_right = spread_up(centre, middle & high), to_left = spread_down(centre, middle & (low >> 1));
  rows_[static_cast<std::size_t>(radius)] = to_right | to_left;
  for (const int way : {1, -1}) {
    std::uint64_t rights = to_right, lefts = to_left;
    for (int dy = way; std::abs(dy) <= radius; dy += way) {
      const int row = j + s * dy;
      if ((rights | lefts) != 0) {
        const std::uint64_t steps = links.up(first, way > 0 ? row - s : row), along = row_links(row);
        rights = spread_up(rights & steps, along & high);
        lefts = spread_down(lefts & steps, along & (low >> 1));
      }
      rows_[static_cast<std::size_t>(dy + radius)] = rights | lefts;
    }
  }
  for (int dy = -radius; dy <= radius; ++dy) count_ += std::popcount(row(dy));
}

}  // namespace sparsha::pipeline
