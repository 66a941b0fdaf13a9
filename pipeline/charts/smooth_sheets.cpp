// Moments of windows are summed along rows and then across them. Lengths are in spacings here.
#include "pipeline/charts/smooth_sheets.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sparsha::pipeline {
namespace {

constexpr int kLeastRadius = 2;
constexpr int kMostRadius = 6;
constexpr double kNodeNoise = 0.4;  // of the points' noise: standard deviation of a node, the mean of several discs
constexpr double kMostRest = 1.35;  // standard deviations: root of the mean square of what a window leaves
constexpr double kMostMove = 3.0;   // standard deviations: of the node itself

/// Sums along a row about each node: of z, i z, i^2 z and z^2.
struct RowSums {
  std::vector<double> z, iz, iiz, zz;

  explicit RowSums(std::size_t size) : z(size), iz(size), iiz(size), zz(size) {}
  void clear(std::size_t begin, std::size_t end) {
    for (std::vector<double>* of : {&z, &iz, &iiz, &zz})
      std::fill(of->begin() + static_cast<std::ptrdiff_t>(begin), of->begin() + static_cast<std::ptrdiff_t>(end), 0.0);
  }
};

/// Nodes [begin, end) of a row.
struct Range {
  std::size_t begin = static_cast<std::size_t>(-1), end = 0;

  void add(const Range& other) { begin = std::min(begin, other.begin), end = std::max(end, other.end); }
};

/// Sums over a square window. The basis is orthogonal: 1, i, j, i^2 - m, j^2 - m and ij, where m is the mean of i^2.
struct Window {
  int radius;
  double side, mean, second, fourth;  // mean of i^2; squared norms of i and i^2 - m along a row

  explicit Window(int r) : radius(r), side(2.0 * r + 1.0), mean(0.0), second(0.0), fourth(0.0) {
    for (int i = -r; i <= r; ++i) second += i * i;
    mean = second / side;
    for (int i = -r; i <= r; ++i) fourth += (i * i - mean) * (i * i - mean);
  }
};

/// Quadratic surface at a window's middle.
struct Fitted {
  double z, slope_u, slope_v, rest;  // rest: root of the mean square of what is left
};

class Smoother {
 public:
  Smoother(scene::Sheet& sheet, double spacing_m, double noise_m)
      : sheet_(sheet),
        nx_(static_cast<std::size_t>(sheet.nx)),
        ny_(static_cast<std::size_t>(sheet.ny)),
        spacing_m_(spacing_m),
        noise_(kNodeNoise * noise_m / spacing_m),
        z_(sheet.count(), 0.0),
        room_(sheet.count(), 0),
        rows_(ny_),
        all_(nx_),
        by_row_(nx_),
        jjz_(nx_) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t node = 0; node < sheet.count(); ++node) {
      if (!sheet.measured(node)) continue;
      sum += static_cast<double>(sheet.height_m[node]);
      ++count;
    }
    middle_m_ = count > 0 ? sum / static_cast<double>(count) : 0.0;
    for (std::size_t node = 0; node < sheet.count(); ++node)
      if (sheet.measured(node)) z_[node] = (static_cast<double>(sheet.height_m[node]) - middle_m_) / spacing_m;
    measure_room();
  }

  void run() {
    for (int r = kLeastRadius; r <= kMostRadius && std::min(sheet_.nx, sheet_.ny) > 2 * r; ++r) widen(Window(r));
  }

 private:
  /// The widest window about each node that is measured all over, at most kMostRadius; by the chessboard metric's
  /// chamfer (Rosenfeld & Pfaltz 1966). Nodes that are done with have none.
  void measure_room() {
    const auto beside = [&](std::size_t i, std::size_t j, bool back) -> std::uint8_t {
      if (i == 0 || j == 0 || i + 1 == nx_ || j + 1 == ny_) return 0;
      const std::size_t node = j * nx_ + i;
      const std::size_t row = back ? node + nx_ : node - nx_;
      const std::size_t column = back ? node + 1 : node - 1;
      return std::min({room_[row - 1], room_[row], room_[row + 1], room_[column]});
    };
    // One more than the room, 0 where nothing was measured.
    for (std::size_t j = 0; j < ny_; ++j)
      for (std::size_t i = 0; i < nx_; ++i)
        if (sheet_.measured(j * nx_ + i))
          room_[j * nx_ + i] = static_cast<std::uint8_t>(std::min(kMostRadius, int{beside(i, j, false)}) + 1);
    for (std::size_t j = ny_; j-- > 0;)
      for (std::size_t i = nx_; i-- > 0;)
        if (std::uint8_t& room = room_[j * nx_ + i]; room > 0)
          room = std::min(room, static_cast<std::uint8_t>(beside(i, j, true) + 1));
    for (std::uint8_t& room : room_) room = room > 0 ? static_cast<std::uint8_t>(room - 1) : room;
  }

  void widen(const Window& window) {
    const auto r = static_cast<std::size_t>(window.radius);
    for (std::size_t j = 0; j < ny_; ++j) {
      rows_[j] = {};
      for (std::size_t i = 0; i < nx_; ++i)
        if (room_[j * nx_ + i] >= r) rows_[j].add({i, i + 1});
    }
    std::vector<RowSums> ring(2 * r + 1, RowSums(nx_));
    for (std::size_t j = 0; j < ny_; ++j) {
      sum_along(window, j, ring[j % ring.size()]);
      if (j < 2 * r) continue;
      const std::size_t middle = j - r;
      sum_across(window, middle, ring);
      for (std::size_t i = rows_[middle].begin; i < rows_[middle].end; ++i) {
        std::uint8_t& room = room_[middle * nx_ + i];
        if (room >= r && !take(middle * nx_ + i, fit(window, i))) room = 0;
      }
    }
  }

  /// Of the nodes that windows in rows nearby need.
  void sum_along(const Window& window, std::size_t j, RowSums& sums) const {
    const auto r = static_cast<std::size_t>(window.radius);
    Range range;
    for (std::size_t row = j < r ? 0 : j - r; row <= std::min(j + r, ny_ - 1); ++row) range.add(rows_[row]);
    if (range.end <= range.begin) return;
    sums.clear(range.begin, range.end);
    for (std::size_t k = 0; k <= 2 * r; ++k) {
      const double d = static_cast<double>(k) - static_cast<double>(r);
      add_row(d, z_.data() + j * nx_ + range.begin + k - r, range.end - range.begin, sums.z.data() + range.begin,
              sums.iz.data() + range.begin, sums.iiz.data() + range.begin, sums.zz.data() + range.begin);
    }
  }

  static void add_row(double d, const double* __restrict z, std::size_t count, double* __restrict sum,
                      double* __restrict iz, double* __restrict iiz, double* __restrict zz) {
    for (std::size_t i = 0; i < count; ++i) {
      const double by_i = d * z[i];
      sum[i] += z[i];
      iz[i] += by_i;
      iiz[i] += d * by_i;
      zz[i] += z[i] * z[i];
    }
  }

  /// `by_row_`: the sums of j z in `z` and of ij z in `iz`.
  void sum_across(const Window& window, std::size_t middle, const std::vector<RowSums>& ring) {
    const auto [begin, end] = rows_[middle];
    if (end <= begin) return;
    all_.clear(begin, end);
    by_row_.clear(begin, end);
    std::fill(jjz_.begin() + static_cast<std::ptrdiff_t>(begin), jjz_.begin() + static_cast<std::ptrdiff_t>(end), 0.0);
    const auto r = static_cast<std::size_t>(window.radius);
    for (std::size_t k = 0; k <= 2 * r; ++k) {
      const RowSums& row = ring[(middle + k - r) % ring.size()];
      const double d = static_cast<double>(k) - static_cast<double>(r);
      const std::size_t count = end - begin;
      add_column(d, row.z.data() + begin, count, all_.z.data() + begin, by_row_.z.data() + begin, jjz_.data() + begin);
      add_column(d, row.iz.data() + begin, count, all_.iz.data() + begin, by_row_.iz.data() + begin, nullptr);
      add_column(d, row.iiz.data() + begin, count, all_.iiz.data() + begin, nullptr, nullptr);
      add_column(d, row.zz.data() + begin, count, all_.zz.data() + begin, nullptr, nullptr);
    }
  }

  /// Adds values, and d and d^2 times them where there is room for that.
  static void add_column(double d, const double* __restrict values, std::size_t count, double* __restrict sum,
                         double* __restrict by_d, double* __restrict by_dd) {
    for (std::size_t i = 0; i < count; ++i) sum[i] += values[i];
    if (by_d != nullptr)
      for (std::size_t i = 0; i < count; ++i) by_d[i] += d * values[i];
    if (by_dd != nullptr)
      for (std::size_t i = 0; i < count; ++i) by_dd[i] += d * d * values[i];
  }

  [[nodiscard]] Fitted fit(const Window& window, std::size_t i) const {
    const double nodes = window.side * window.side;
    const double level = all_.z[i] / nodes;
    const double of_i = all_.iz[i] / (window.second * window.side);
    const double of_j = by_row_.z[i] / (window.second * window.side);
    const double of_ij = by_row_.iz[i] / (window.second * window.second);
    const double norm = window.fourth * window.side;
    const double of_ii = (all_.iiz[i] - window.mean * all_.z[i]) / norm;
    const double of_jj = (jjz_[i] - window.mean * all_.z[i]) / norm;
    const double rest = all_.zz[i] - level * all_.z[i] - of_i * all_.iz[i] - of_j * by_row_.z[i] -
                        of_ij * by_row_.iz[i] - norm * (of_ii * of_ii + of_jj * of_jj);
    return {level - window.mean * (of_ii + of_jj), of_i, of_j, std::sqrt(std::max(0.0, rest) / (nodes - 6.0))};
  }

  /// Whether the surface goes on like that within the noise.
  bool take(std::size_t node, const Fitted& fitted) {
    const double noise = noise_ * std::sqrt(1.0 + fitted.slope_u * fitted.slope_u + fitted.slope_v * fitted.slope_v);
    if (!(fitted.rest <= kMostRest * noise && std::abs(fitted.z - z_[node]) <= kMostMove * noise)) return false;
    sheet_.height_m[node] = static_cast<float>(middle_m_ + fitted.z * spacing_m_);
    sheet_.slope_u[node] = static_cast<float>(fitted.slope_u);
    sheet_.slope_v[node] = static_cast<float>(fitted.slope_v);
    return true;
  }

  scene::Sheet& sheet_;
  std::size_t nx_, ny_;
  double spacing_m_, noise_;
  double middle_m_ = 0.0;
  std::vector<double> z_;           // as found; 0 where not measured
  std::vector<std::uint8_t> room_;  // of each node that may still be smoothed
  std::vector<Range> rows_;         // that hold these
  RowSums all_, by_row_;            // over windows about the nodes of one row
  std::vector<double> jjz_;
};

}  // namespace

void smooth_sheets(std::vector<scene::Sheet>& sheets, double spacing_m, double noise_m, const Context& context) {
  if (!(noise_m > 0.0)) return;
  context.pool.for_ranges(sheets.size(), 1, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    for (std::size_t s = begin; s < end; ++s) Smoother(sheets[s], spacing_m, noise_m).run();
  });
}

}  // namespace sparsha::pipeline
