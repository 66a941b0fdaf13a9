// Nodes are taken cube by cube of space, so that the nodes about them are looked up once a cube.
#include "pipeline/charts/sheet_texture.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "scene/depth_grid.h"
#include "scene/solid/envelope.h"
#include "scene/solid/surface_nodes.h"

namespace sparsha::pipeline {
namespace {

constexpr double kFitReach = 2.5;       // scales of the fit, as for one view
constexpr double kSteepest = 1.5;       // of the way from a node to one of the same layer, beside a cell
constexpr double kLeastWeight = 0.25;   // of a whole window's in a fit
constexpr double kLeastBalance = 0.35;  // of the two spreads of its nodes
// What noise leaves in k, in noises per square of the fit's scale: of clouds of balls after the smoothing of sheets the
// 95th percentile is 0.056 to 0.07 at scales of two to five spacings, 1.5 times as much.
constexpr double kNoiseGain = 0.045;

/// A node of the sheets that is asked about.
struct Asked {
  std::uint64_t cube = 0;
  std::uint32_t sheet = 0;
  std::uint32_t node = 0;
};

std::vector<Asked> all_nodes(const scene::Charts& charts, const scene::SurfaceNodes& nodes) {
  std::vector<Asked> asked;
  asked.reserve(charts.measured_nodes());
  for (std::size_t s = 0; s < charts.sheets.size(); ++s) {
    const scene::Sheet& sheet = charts.sheets[s];
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i)
        if (sheet.measured(sheet.index(i, j)))
          asked.push_back({scene::SurfaceNodes::key_of(nodes.cube_of(charts.place_m(sheet, i, j))),
                           static_cast<std::uint32_t>(s), static_cast<std::uint32_t>(sheet.index(i, j))});
  }
  std::sort(asked.begin(), asked.end(), [](const Asked& a, const Asked& b) {
    return std::tie(a.cube, a.sheet, a.node) < std::tie(b.cube, b.sheet, b.node);
  });
  return asked;
}

/// Result(place, normal, nodes about it) of every measured node into `layer` of its sheet, NaN elsewhere.
template <class Result>
void for_nodes(scene::Charts& charts, const scene::SurfaceNodes& nodes, std::vector<float> scene::Sheet::*layer,
               const Context& context, const Result& result) {
  for (scene::Sheet& sheet : charts.sheets) (sheet.*layer).assign(sheet.count(), scene::kUnknownHeight);
  const std::vector<Asked> asked = all_nodes(charts, nodes);
  constexpr std::size_t kPiece = 4096;
  context.pool.for_ranges(asked.size(), kPiece, [&](std::size_t begin, std::size_t end) {
    std::vector<scene::SurfaceNode> about;
    for (std::size_t k = begin; k < end; ++k) {
      scene::Sheet& sheet = charts.sheets[asked[k].sheet];
      const auto nx = static_cast<std::uint32_t>(sheet.nx);
      const int i = static_cast<int>(asked[k].node % nx), j = static_cast<int>(asked[k].node / nx);
      const Eigen::Vector3d place_m = charts.place_m(sheet, i, j);
      if (k == begin || asked[k].cube != asked[k - 1].cube) nodes.near(nodes.cube_of(place_m), about);
      (sheet.*layer)[asked[k].node] = static_cast<float>(result(place_m, scene::Charts::normal(sheet, i, j), about));
    }
  });
}

/// k of the values about a place, as a function over its tangent plane.
class Bend {
 public:
  Bend(double scale_m, double spacing_m, double noise_k)
      : scale_m_(scale_m), spacing_m_(spacing_m), noise_2_(noise_k * noise_k) {}

  [[nodiscard]] double operator()(const Eigen::Vector3d& place_m, const Eigen::Vector3d& normal,
                                  const std::vector<scene::SurfaceNode>& about) const {
    const Eigen::Vector3d x_axis = normal.unitOrthogonal(), y_axis = normal.cross(x_axis);
    const double reach_2 = kFitReach * kFitReach * scale_m_ * scale_m_;
    Eigen::Matrix<double, 6, 6> squares = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> values = Eigen::Matrix<double, 6, 1>::Zero();
    for (const scene::SurfaceNode& node : about) {
      const Eigen::Vector3d way_m = node.place_m - place_m;
      const double way_2 = way_m.squaredNorm();
      if (way_2 > reach_2 || node.normal.dot(normal) < scene::SurfaceNode::kSameSide) continue;
      const double before_m = normal.dot(way_m);
      const double across_2 = way_2 - before_m * before_m;
      const double most_m = spacing_m_ + kSteepest * std::sqrt(std::max(0.0, across_2));
      if (std::abs(before_m) > most_m) continue;
      const double x = x_axis.dot(way_m) / scale_m_, y = y_axis.dot(way_m) / scale_m_;
      const double weight = node.area * std::exp(-0.5 * (x * x + y * y));
      Eigen::Matrix<double, 6, 1> basis;
      basis << 1.0, x, y, 0.5 * x * x, x * y, 0.5 * y * y;
      squares.noalias() += weight * basis * basis.transpose();
      values += weight * node.value * basis;
    }
    return k_of(squares, values);
  }

 private:
  [[nodiscard]] double k_of(const Eigen::Matrix<double, 6, 6>& squares,
                            const Eigen::Matrix<double, 6, 1>& values) const {
    constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
    const double cells = scale_m_ / spacing_m_;
    if (squares(0, 0) < kLeastWeight * 2.0 * M_PI * cells * cells) return kNothing;
    const double narrow = std::min(squares(1, 1), squares(2, 2)), wide = std::max(squares(1, 1), squares(2, 2));
    const double off_2 = squares(0, 1) * squares(0, 1) + squares(0, 2) * squares(0, 2);
    const bool one_sided = off_2 > kLeastBalance * squares(0, 0) * squares(0, 0);
    if (!(narrow > kLeastBalance * wide) || one_sided) return kNothing;
    const Eigen::Matrix<double, 6, 1> fit = squares.ldlt().solve(values);
    if (!fit.allFinite()) return kNothing;
    const double along = 1.0 / scale_m_;
    const double hx = fit[1] * along, hy = fit[2] * along;
    const double hxx = fit[3] * along * along, hxy = fit[4] * along * along, hyy = fit[5] * along * along;
    const double gx = 1.0 + hx * hx, gy = 1.0 + hy * hy, g = gx + hy * hy;
    const double mean = (hxx * gy + hyy * gx - 2.0 * hxy * hx * hy) / (2.0 * g * std::sqrt(g));
    const double gaussian = (hxx * hyy - hxy * hxy) / (g * g);
    return std::sqrt(std::max(0.0, 2.0 * mean * mean - gaussian - noise_2_));
  }

  double scale_m_, spacing_m_, noise_2_;
};

}  // namespace

void add_texture(scene::Charts& charts, const scene::TextureConfig& config, const Context& context) {
  const double reach_m = std::max(scene::Envelope::reach_m(config.sigma_space_m), charts.spacing_m);
  const scene::SurfaceNodes nodes(charts, reach_m, scene::SurfaceNodes::stride_within(reach_m, charts.spacing_m),
                                  [](const scene::Sheet&, std::size_t) { return 0.0; });
  for_nodes(charts, nodes, &scene::Sheet::texture_m, context,
            scene::Envelope(config.sigma_space_m, config.sigma_range_m));
}

void add_curvature(scene::Charts& charts, double scale_m, double noise_m, const Context& context) {
  const double reach_m = std::max(kFitReach * scale_m, charts.spacing_m);
  const double noise_k = kNoiseGain * noise_m / (scale_m * scale_m);
  const scene::SurfaceNodes nodes(
      charts, reach_m, scene::SurfaceNodes::stride_within(reach_m, charts.spacing_m),
      [](const scene::Sheet& sheet, std::size_t node) { return static_cast<double>(sheet.texture_m[node]); });
  for_nodes(charts, nodes, &scene::Sheet::curvature_per_m, context, Bend(scale_m, charts.spacing_m, noise_k));
}

}  // namespace sparsha::pipeline
