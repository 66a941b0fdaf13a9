// Curvature of the texture h = f - f_b. Node-to-node differences would measure noise, so derivatives come from a
// quadratic fitted with Gaussian weights; on complete windows that fit is a separable filter.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/statistics.h"
#include "pipeline/layers/curvature_kernel.h"
#include "pipeline/layers/layers.h"

namespace sparsha::pipeline {
namespace {

constexpr double kReach = 2.5;  // scales; where the fit's Gaussian window ends
constexpr std::size_t kRowsPerPiece = 48;
// The 95th percentile of k that noise leaves on a flat plane after its expectation is taken away, in noise floors, and
// the percentile from which on the texture stands clear of it.
constexpr double kNoisePercentile = 1.6;
constexpr double kClearPercentile = 3.0;

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
      bend.push_back(static_cast<float>(2 * w * (k * k - m2) / (m4 - m2 * m2)));
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
struct NoiseGain {
  double bend = 0;        ///< variance of h_xx and of h_yy
  double twist = 0;       ///< variance of h_xy
  double covariance = 0;  ///< of h_xx and h_yy

  NoiseGain(const Filter& filter, double sigma) {
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
    bend = dot(b, b) * dot(v, v) - 2 * dot(b, bg) * dot(v, vg) + dot(bg, bg) * dot(vg, vg);
    twist = dot(s, s) * dot(s, s) - 2 * dot(s, sg) * dot(s, sg) + dot(sg, sg) * dot(sg, sg);
    covariance = dot(b, v) * dot(b, v) - 2 * dot(b, vg) * dot(v, bg) + dot(bg, vg) * dot(bg, vg);
  }
};

/// Texture with a border of NaN; NaN too where a height is unknown or beside a step, so that every window that touches
/// one yields NaN.
class Texture {
 public:
  Texture(const DepthGrid& grid, const std::vector<float>& envelope_m, double step_m, int margin)
      : grid_(grid), envelope_(envelope_m), step_(static_cast<float>(step_m)), margin_(margin) {}

  /// Row j into `row`, from -margin to nx + margin.
  void read(int j, float* row) const {
    const int nx = grid_.lattice.nx, ny = grid_.lattice.ny;
    std::fill(row, row + nx + 2 * margin_, kUnknownHeight);
    if (j < 0 || j >= ny) return;
    float* out = row + margin_;
    const float* z = grid_.height_m.data() + grid_.lattice.index(0, j);
    const float* base = envelope_.data() + grid_.lattice.index(0, j);
    for (int i = 0; i < nx; ++i) out[i] = z[i] - base[i];
    const auto mark = [&](const float* other, int from, int to, int shift) {
      for (int i = from; i < to; ++i)
        if (std::abs(z[i] - other[i + shift]) > step_) out[i] = kUnknownHeight;
    };
    mark(z, 1, nx, -1);
    mark(z, 0, nx - 1, 1);
    if (j > 0) mark(z - nx, 0, nx, 0);
    if (j + 1 < ny) mark(z + nx, 0, nx, 0);
  }

 private:
  const DepthGrid& grid_;
  const std::vector<float>& envelope_;
  float step_;
  int margin_;
};

/// Expectations that white noise in h adds, and the scales that turn spacings into metres.
struct Noise {
  double mean_2 = 0, gaussian = 0, rms_2 = 0;
};

struct Derivatives {
  double h_x, h_y, h_xx, h_xy, h_yy;
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

}  // namespace

CurvatureMap texture_curvature(const DepthGrid& grid, const std::vector<float>& envelope_m, double scale_m,
                               double noise_m, double step_m, ThreadPool& pool, double sigma_space_m) {
  const int nx = grid.lattice.nx, ny = grid.lattice.ny;
  const double h = grid.lattice.spacing_m;
  const double scale = std::clamp(scale_m / h, 0.5, static_cast<double>(nx + ny));
  const Filter filter(scale);
  const auto view = filter.view();
  const kernel::CurvatureKernels kernels = kernel::curvature_kernels();
  const Texture texture(grid, envelope_m, step_m, filter.radius);

  const double variance = noise_m * noise_m / (h * h * h * h);
  Noise noise;
  const NoiseGain gain(filter, std::min(sigma_space_m / h, static_cast<double>(nx + ny)));
  noise.mean_2 = variance * (gain.bend + gain.covariance) / 2;
  noise.gaussian = variance * (gain.covariance - gain.twist);
  noise.rms_2 = 2 * noise.mean_2 - noise.gaussian;

  CurvatureMap map;
  map.noise_floor_per_m = std::sqrt(std::max(0.0, noise.rms_2));
  map.rms_per_m.resize(grid.lattice.count());
  map.mean_per_m.resize(grid.lattice.count());
  map.gaussian_per_m2.resize(grid.lattice.count());
  // Marks complete windows over measured nodes, for the percentile.
  std::vector<std::uint8_t> counted(grid.lattice.count());

  const auto width = static_cast<std::size_t>(nx);
  pool.for_ranges(static_cast<std::size_t>(ny), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    const std::size_t rows = end - begin + 2 * static_cast<std::size_t>(filter.radius);
    std::vector<float> row(width + 2 * static_cast<std::size_t>(filter.radius));
    std::vector<float> value(rows * width), slope(rows * width), bend(rows * width), results(5 * width);
    for (std::size_t r = 0; r < rows; ++r) {
      texture.read(static_cast<int>(begin + r) - filter.radius, row.data());
      kernels.along(view, row.data() + filter.radius, width, value.data() + r * width, slope.data() + r * width,
                    bend.data() + r * width);
    }
    const std::array<float*, 5> out = {results.data(), results.data() + width, results.data() + 2 * width,
                                       results.data() + 3 * width, results.data() + 4 * width};
    for (std::size_t j = begin; j < end; ++j) {
      const std::size_t start = (j - begin + static_cast<std::size_t>(filter.radius)) * width;
      kernels.across(view, value.data() + start, slope.data() + start, bend.data() + start,
                     static_cast<std::ptrdiff_t>(width), width, out.data());
      for (std::size_t i = 0; i < width; ++i) {
        if (std::isnan(out[2][i])) continue;
        const std::size_t n = j * width + i;
        const Curvature c = curvature_of(
            {out[0][i] / h, out[1][i] / h, out[2][i] / (h * h), out[3][i] / (h * h), out[4][i] / (h * h)}, noise);
        map.rms_per_m[n] = static_cast<float>(c.rms);
        map.mean_per_m[n] = static_cast<float>(c.mean);
        map.gaussian_per_m2[n] = static_cast<float>(c.gaussian);
        counted[n] = grid.state[n] == NodeState::measured ? 1 : 0;
      }
    }
  });

  std::vector<float> measured;
  measured.reserve(grid.lattice.count());
  for (std::size_t n = 0; n < counted.size(); ++n)
    if (counted[n] != 0) measured.push_back(map.rms_per_m[n]);
  map.percentile_95_per_m = measured.empty() ? 0.0 : static_cast<double>(quantile(measured, 0.95));
  return map;
}

double friction_slope(const CurvatureMap& map, const FrictionConfig& config) {
  if (config.c_m) return *config.c_m;
  const double percentile = map.percentile_95_per_m;
  if (!(percentile > 0)) return 0;
  // Below the clear percentile the slope fades out, so that the roughness of a flat plane's noise is not felt.
  const double low = kNoisePercentile * map.noise_floor_per_m, high = kClearPercentile * map.noise_floor_per_m;
  const double t = high > low ? std::clamp((percentile - low) / (high - low), 0.0, 1.0) : 1.0;
  return t * t * (3 - 2 * t) * (config.mu_max - config.mu_0) / percentile;
}

}  // namespace sparsha::pipeline
