// Curvature of the texture h = f - f_b. Node-to-node differences would measure noise, so derivatives come from a
// quadratic fitted with Gaussian weights. On whole windows that fit is a separable filter; elsewhere it is made of the
// nodes of the own layer (pipeline/layers/layer_fit.h).
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "pipeline/layers/border.h"
#include "pipeline/layers/curvature_kernel.h"
#include "pipeline/layers/friction_slope.h"
#include "pipeline/layers/layer_fit.h"
#include "pipeline/layers/layers.h"
#include "pipeline/layers/surface_links.h"

namespace sparsha::pipeline {
namespace {

constexpr double kReach = 2.5;        // scales; where the fit's Gaussian window ends
constexpr double kBorderWider = 1.5;  // scales; of the Gaussian that the texture goes on with beyond the lattice
constexpr int kLeastRows = 48;        // of a piece; it looks at `radius` rows more on either side
constexpr int kLeastColumns = 512;    // so that a piece's memory does not depend on the lattice

/// The fit as 1-D filters: least squares with weights w(x) w(y) and basis 1, x, y, x^2, xy, y^2 separates, because 1, x
/// and x^2 - m2 are orthogonal under w.
struct Filter {
  std::vector<float> value, slope, bend;
  int radius = 0;

  explicit Filter(double scale) : radius(std::max(1, static_cast<int>(std::lround(kReach * scale)))) {
    std::vector<double> weight;
    double total = 0, m2 = 0, m4 = 0;
    for (int k = 0; k <= radius; ++k) {
      weight.push_back(std::exp(-0.5 * k * k / (scale * scale)));
      const double both = k == 0 ? weight.back() : 2 * weight.back();
      total += both;
      m2 += both * k * k;
      m4 += both * k * k * k * k;
    }
    m2 /= total;
    m4 /= total;
    for (int k = 0; k <= radius; ++k) {
      const double w = weight[static_cast<std::size_t>(k)] / total;
      value.push_back(static_cast<float>(w));
      slope.push_back(static_cast<float>(w * k / m2));
      bend.push_back(static_cast<float>(2 * w * (static_cast<double>(k) * k - m2) / (m4 - m2 * m2)));
    }
  }
  [[nodiscard]] kernel::CurvatureFilter view() const { return {radius, value.data(), slope.data(), bend.data()}; }
};

/// A 1-D filter at offsets -radius to radius, from its half; `sign` is 1 for even and -1 for odd ones.
std::vector<double> both_halves(const std::vector<float>& half, double sign) {
  std::vector<double> whole(half.size() - 1);
  for (std::size_t k = 1; k < half.size(); ++k) whole[half.size() - 1 - k] = sign * half[k];
  whole.insert(whole.end(), half.begin(), half.end());
  return whole;
}

/// The filter after a Gaussian of `sigma` spacings, as long as both need; `sigma` 0 gives nothing: no envelope.
std::vector<double> smoothed(const std::vector<double>& filter, double sigma, int margin) {
  std::vector<double> gaussian, result(filter.size() + 2 * static_cast<std::size_t>(margin));
  double total = 0;
  for (int k = -margin; k <= margin; ++k) {
    gaussian.push_back(sigma > 0 ? std::exp(-0.5 * k * k / (sigma * sigma)) : 0.0);
    total += gaussian.back();
  }
  for (std::size_t n = 0; n < filter.size() && total > 0; ++n)
    for (std::size_t k = 0; k < gaussian.size(); ++k) result[n + k] += filter[n] * gaussian[k] / total;
  return result;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// What unit white noise in the heights becomes in the derivatives of the texture: the envelope is nearly a Gaussian of
/// the heights where these differ by noise alone, so a derivative K of the texture is K - K * G of the heights.
NoiseGain noise_gain(const Filter& filter, double sigma) {
  const int margin = static_cast<int>(3 * sigma);  // as the envelope's own window
  const auto padded = [&](const std::vector<float>& half, double sign) {
    std::vector<double> whole(static_cast<std::size_t>(margin));
    const std::vector<double> middle = both_halves(half, sign);
    whole.insert(whole.end(), middle.begin(), middle.end());
    whole.resize(whole.size() + static_cast<std::size_t>(margin));
    return whole;
  };
  const std::vector<double> v = padded(filter.value, 1), s = padded(filter.slope, -1), b = padded(filter.bend, 1);
  const std::vector<double> vg = smoothed(both_halves(filter.value, 1), sigma, margin),
                            sg = smoothed(both_halves(filter.slope, -1), sigma, margin),
                            bg = smoothed(both_halves(filter.bend, 1), sigma, margin);
  // Kernels are products of a filter in x and one in y; so are their scalar products.
  const double bend = dot(b, b) * dot(v, v) - 2 * dot(b, bg) * dot(v, vg) + dot(bg, bg) * dot(vg, vg);
  const double twist = dot(s, s) * dot(s, s) - 2 * dot(s, sg) * dot(s, sg) + dot(sg, sg) * dot(sg, sg);
  const double covariance = dot(b, v) * dot(b, v) - 2 * dot(b, vg) * dot(v, bg) + dot(bg, vg) * dot(bg, vg);
  return {bend, bend, twist, covariance};
}

/// Nodes [first, last) along an axis.
struct Range {
  int first, last;
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(last - first); }
};

/// Some columns of the texture, which goes on beyond the lattice; NaN where a height is unknown or beside a step, so
/// that every window that touches one yields NaN.
class WholeTexture {
 public:
  WholeTexture(const scene::DepthGrid& grid, const TextureView& texture, const SurfaceLinks& links,
               const BorderExtension& border, Range columns, int margin)
      : lattice_(grid.lattice),
        texture_(texture),
        links_(links),
        border_(border),
        columns_{columns.first - margin, columns.last + margin},
        inside_{std::max(0, columns_.first), std::min(lattice_.nx, columns_.last)} {
    // What lies beyond a border is made of the nodes next to it.
    if (columns_.first < 0) inside_.last = std::max(inside_.last, std::min(lattice_.nx, border.nodes()));
    if (columns_.last > lattice_.nx) inside_.first = std::min(inside_.first, std::max(0, lattice_.nx - border.nodes()));
  }

  /// Row j, from margin rows below the lattice to as many above it, into as many floats as the columns and a margin on
  /// both sides.
  void read(int j, float* row) {
    const int ny = lattice_.ny;
    if (j >= 0 && j < ny) return read_inside(j, row);
    if (ny < border_.nodes()) return static_cast<void>(std::fill_n(row, columns_.size(), scene::kUnknownHeight));
    const float* const weights = border_.weights(j < 0 ? -j : j - ny + 1);
    read_border(j < 0 ? Border::low : Border::high);
    std::fill_n(row, columns_.size(), 0.0F);
    const float* of_row = border_rows_.data();
    for (int m = 0; m < border_.nodes(); ++m, of_row += columns_.size())
      for (std::size_t k = 0; k < columns_.size(); ++k) row[k] += weights[m] * of_row[k];
  }

 private:
  enum class Border : std::uint8_t { none, low, high };

  /// The rows that the lattice goes on from, kept while it goes on from them.
  void read_border(Border border) {
    if (border_ready_ == border) return;
    border_rows_.resize(static_cast<std::size_t>(border_.nodes()) * columns_.size());
    for (int m = 0; m < border_.nodes(); ++m)
      read_inside(border == Border::low ? m : lattice_.ny - 1 - m,
                  border_rows_.data() + static_cast<std::size_t>(m) * columns_.size());
    border_ready_ = border;
  }

  void read_inside(int j, float* row) {
    const int nx = lattice_.nx;
    nodes_.resize(inside_.size());
    const std::size_t first = lattice_.index(inside_.first, j);
    for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i] = texture_.at(first + i);
    leave_out_loose(j);
    const Range own{std::max(0, columns_.first), std::min(nx, columns_.last)};
    std::copy_n(nodes_.data() + (own.first - inside_.first), own.size(), row + (own.first - columns_.first));
    for (int i = columns_.first; i < 0; ++i) *row++ = beyond(-i, nodes_.data(), 1);
    row += own.size();
    for (int i = nx; i < columns_.last; ++i) *row++ = beyond(i - nx + 1, nodes_.data() + nodes_.size() - 1, -1);
  }
  void leave_out_loose(int j) {
    links_.loose_nodes(j, loose_);
    for (auto w = static_cast<std::size_t>(inside_.first / 64); w < loose_.size(); ++w) {
      for (std::uint64_t left = loose_[w]; left != 0; left &= left - 1) {
        const int i = static_cast<int>(64 * w) + std::countr_zero(left);
        if (i >= inside_.last) return;
        if (i >= inside_.first) nodes_[static_cast<std::size_t>(i - inside_.first)] = scene::kUnknownHeight;
      }
    }
  }
  /// `k` columns beyond a border at the node `last`, from which on `inwards` leads to the others.
  [[nodiscard]] float beyond(int k, const float* last, std::ptrdiff_t inwards) const {
    if (lattice_.nx < border_.nodes()) return scene::kUnknownHeight;
    const float* const weights = border_.weights(k);
    float sum = 0.0F;
    for (int m = 0; m < border_.nodes(); ++m, last += inwards) sum += weights[m] * *last;
    return sum;
  }

  const scene::Lattice& lattice_;
  const TextureView& texture_;
  const SurfaceLinks& links_;
  const BorderExtension& border_;
  Range columns_, inside_;  // with margins; of the lattice's, those that are read
  Border border_ready_ = Border::none;
  std::vector<std::uint64_t> loose_;
  std::vector<float> nodes_, border_rows_;
};

/// What unit white noise becomes in the derivatives near the lattice's border, by the distances of a node from it.
class BorderNoise {
 public:
  BorderNoise(const Filter& filter, const BorderExtension& border) {
    const std::vector<double> v = both_halves(filter.value, 1), s = both_halves(filter.slope, -1),
                              b = both_halves(filter.bend, 1);
    for (int distance = 0; distance <= filter.radius; ++distance) {
      const std::vector<double> fv = border.folded(v, distance), fs = border.folded(s, distance),
                                fb = border.folded(b, distance);
      parts_.push_back({dot(fv, fv), dot(fs, fs), dot(fb, fb), dot(fv, fb)});
    }
  }
  /// Distances beyond the filter's radius count as it.
  [[nodiscard]] NoiseGain at(int x, int y) const {
    const Part& a = part(x);
    const Part& b = part(y);
    return {a.bend * b.value, a.value * b.bend, a.slope * b.slope, a.mixed * b.mixed};
  }

 private:
  struct Part {
    double value, slope, bend, mixed;
  };
  [[nodiscard]] const Part& part(int distance) const {
    return parts_[std::min(static_cast<std::size_t>(distance), parts_.size() - 1)];
  }
  std::vector<Part> parts_;
};

/// Expectations that white noise in h adds, and the scales that turn spacings into metres.
struct Noise {
  double mean_2 = 0, gaussian = 0, rms_2 = 0;
};

struct Curvature {
  double rms, mean, gaussian;
};

/// H and K of a Monge patch, ALGORITHMS "Friction map"; squares lose their noise expectation.
Curvature curvature_of(const Derivatives& d, const Noise& noise) {
  const double gx = 1 + d.h_x * d.h_x, gy = 1 + d.h_y * d.h_y, g = gx + d.h_y * d.h_y;
  const double mean = (d.h_xx * gy + d.h_yy * gx - 2 * d.h_xy * d.h_x * d.h_y) / (2 * g * std::sqrt(g));
  const double gaussian = (d.h_xx * d.h_yy - d.h_xy * d.h_xy) / (g * g) - noise.gaussian;
  const double mean_2 = mean * mean - noise.mean_2;
  return {std::sqrt(std::max(0.0, 2 * mean_2 - gaussian)), std::copysign(std::sqrt(std::max(0.0, mean_2)), mean),
          gaussian};
}

/// Heights as float32 are rounded by that much.
double rounding_m(const scene::DepthGrid& grid) {
  float most_m = 0;
  for (const float z : grid.height_m)
    if (std::abs(z) > most_m) most_m = std::abs(z);
  return 0.5 * static_cast<double>(std::numeric_limits<float>::epsilon() * most_m);
}

}  // namespace

CurvatureMap texture_curvature(const scene::DepthGrid& grid, const std::vector<float>& envelope_m, double scale_m,
                               double noise_m, double step_m, ThreadPool& pool, double sigma_space_m) {
  const int nx = grid.lattice.nx, ny = grid.lattice.ny;
  const double h = grid.lattice.spacing_m;
  const double scale = std::clamp(scale_m / h, 0.5, static_cast<double>(nx + ny));
  const Filter filter(scale);
  const auto view = filter.view();
  const kernel::CurvatureKernels kernels = kernel::curvature_kernels();
  const TextureView texture{grid.height_m.data(), envelope_m.data(), static_cast<std::size_t>(nx)};

  const double variance = noise_m * noise_m / (h * h * h * h);
  Noise noise;
  const NoiseGain gain = noise_gain(filter, std::min(sigma_space_m / h, static_cast<double>(nx + ny)));
  noise.mean_2 = variance * (gain.bend_x + gain.covariance) / 2;
  noise.gaussian = variance * (gain.covariance - gain.twist);
  noise.rms_2 = 2 * noise.mean_2 - noise.gaussian;

  // Windows that are not whole: without the envelope's part, of which as much is taken to be in them.
  const NoiseGain whole = noise_gain(filter, 0.0);
  const double envelope_share = gain.rms() / whole.rms();
  const double rounded_m = rounding_m(grid);
  const TextureNoise texture_noise{std::hypot(noise_m, rounded_m),
                                   std::hypot(noise_m * std::sqrt(envelope_share), rounded_m)};
  const OwnLayerFit layer_fit(scale, h, whole);
  const SurfaceLinks links(grid, {noise_m, step_m}, pool);
  const SurfaceLinks thinned = links.thinned(layer_fit.stride());

  CurvatureMap map;
  map.noise_floor_per_m = std::sqrt(std::max(0.0, noise.rms_2));
  map.rms_per_m.resize(grid.lattice.count());
  map.mean_per_m.resize(grid.lattice.count());
  map.gaussian_per_m2.resize(grid.lattice.count());
  const auto keep = [&](std::size_t n, const Derivatives& d, const Noise& expected) {
    const Curvature c =
        curvature_of({d.h_x / h, d.h_y / h, d.h_xx / (h * h), d.h_xy / (h * h), d.h_yy / (h * h)}, expected);
    map.rms_per_m[n] = static_cast<float>(c.rms);
    map.mean_per_m[n] = static_cast<float>(c.mean);
    map.gaussian_per_m2[n] = static_cast<float>(c.gaussian);
  };
  const auto expected = [&](const NoiseGain& own) {
    const double mean_2 = noise.mean_2 * (own.bend_x + own.bend_y + 2 * own.covariance) /
                          (whole.bend_x + whole.bend_y + 2 * whole.covariance);
    return Noise{mean_2, 2 * mean_2 - noise.rms_2 * own.rms() / whole.rms(), 0.0};
  };

  const int r = filter.radius;
  const BorderExtension border(kBorderWider * scale, r);
  const BorderNoise border_noise(filter, border);
  const int most_rows = std::min(std::max(kLeastRows, 2 * r), ny),
            most_columns = std::min(std::max(kLeastColumns, 2 * r), nx);
  const int across = (nx + most_columns - 1) / most_columns, along = (ny + most_rows - 1) / most_rows;
  const auto measure = [&](Range columns, Range rows) {
    const std::size_t width = columns.size();
    const std::size_t seen_rows = rows.size() + 2 * static_cast<std::size_t>(r);
    std::vector<float> row(width + 2 * static_cast<std::size_t>(r));
    std::vector<float> value(seen_rows * width), slope(seen_rows * width), bend(seen_rows * width), results(5 * width);
    WholeTexture whole_texture(grid, texture, links, border, columns, r);
    for (std::size_t k = 0; k < seen_rows; ++k) {
      whole_texture.read(rows.first + static_cast<int>(k) - r, row.data());
      kernels.along(view, row.data() + r, width, value.data() + k * width, slope.data() + k * width,
                    bend.data() + k * width);
    }
    const std::array<float*, 5> out = {results.data(), results.data() + width, results.data() + 2 * width,
                                       results.data() + 3 * width, results.data() + 4 * width};
    OwnLayerFit fit = layer_fit;
    for (int y = rows.first; y < rows.last; ++y) {
      const std::size_t start = static_cast<std::size_t>(y - rows.first + r) * width;
      kernels.across(view, value.data() + start, slope.data() + start, bend.data() + start,
                     static_cast<std::ptrdiff_t>(width), width, out.data());
      const int from_y = std::min(y, ny - 1 - y);
      for (std::size_t i = 0; i < width; ++i) {
        const int x = columns.first + static_cast<int>(i), from_x = std::min(x, nx - 1 - x);
        const std::size_t n = grid.lattice.index(x, y);
        Derivatives d{out[0][i], out[1][i], out[2][i], out[3][i], out[4][i]};
        NoiseGain own;
        if (!std::isnan(d.h_xx)) {
          keep(n, d, std::min(from_x, from_y) >= r ? noise : expected(border_noise.at(from_x, from_y)));
        } else if (!std::isnan(grid.height_m[n]) && fit.fit(texture, thinned, x, y, texture_noise, d, own)) {
          keep(n, d, expected(own));
        } else {
          map.rms_per_m[n] = map.mean_per_m[n] = map.gaussian_per_m2[n] = scene::kUnknownHeight;
        }
      }
    }
  };
  pool.for_ranges(static_cast<std::size_t>(across) * static_cast<std::size_t>(along), 1,
                  [&](std::size_t begin, std::size_t end) {
                    for (int piece = static_cast<int>(begin); piece < static_cast<int>(end); ++piece) {
                      const int left = piece % across * most_columns, bottom = piece / across * most_rows;
                      measure({left, std::min(nx, left + most_columns)}, {bottom, std::min(ny, bottom + most_rows)});
                    }
                  });
  map.percentile_95_per_m = curvature_percentile(grid, map.rms_per_m, links, filter.radius, step_m);
  return map;
}

}  // namespace sparsha::pipeline
