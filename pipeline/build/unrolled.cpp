#include "pipeline/build/unrolled.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "base/error.h"
#include "pipeline/orient/mantle.h"
#include "pipeline/projection/projector.h"

namespace sparsha::pipeline {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kOverlap = kTurn / 12.0;  // by which the picture reaches beyond the seam on either side
constexpr double kBeyondNodes = 32.0;      // that points reach beyond the overlap, so that its last nodes know all

Eigen::Vector3d front_of(const scene::UnrollConfig& unroll, const Eigen::Matrix4d& scan_to_grid) {
  constexpr double kBeside = 0.95;  // cosine to the axis up to which a view is from beside it
  const Eigen::Vector3d axis = unroll.axis->normalized();
  const Eigen::Vector3d look_from = scan_to_grid.block<1, 3>(2, 0).transpose();
  for (const Eigen::Vector3d& front :
       {Eigen::Vector3d(look_from.normalized()), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0, 0, 1)}) {
    if (std::abs(front.dot(axis)) < kBeside) return front;
  }
  return {1, 0, 0};
}

Eigen::Vector3d place_of(const Cloud& cloud, std::size_t n) {
  return cloud.origin_m + Eigen::Map<const Eigen::Vector3f>(cloud.xyz1() + 4 * n).cast<double>();
}

void put_place(Cloud& cloud, std::size_t n, const Eigen::Vector3d& flat_m) {
  const Eigen::Vector3f place = flat_m.cast<float>();
  std::copy_n(place.data(), 3, cloud.xyz1() + 4 * n);
}

struct NodesAround {
  int count = 0;
  int step = 2;  // every level of the scene repeats after a whole number of nodes where `count` is a multiple of it
};

NodesAround nodes_around(double period_m, double spacing_m, int window) {
  NodesAround around;
  const double nodes = period_m / spacing_m;
  while (nodes / around.step > std::max(window, 2)) around.step *= 2;
  const double steps = std::max(1.0, std::round(nodes / around.step));
  if (!(steps * around.step < 1e9))
    throw usage_error("unroll: the grid has too many nodes", "a larger grid.spacing_mm");
  around.count = static_cast<int>(steps) * around.step;
  return around;
}

/// Repeats the points whose angle from the middle of the picture is beyond `angle`, on the other side.
class Repeater {
 public:
  Repeater(Cloud& cloud, const scene::Unrolling& unrolling) : cloud_(cloud), unrolling_(unrolling) {}

  void repeat_beyond(double angle) {
    const std::size_t count = cloud_.size();
    std::vector<std::uint32_t> from;
    std::vector<std::int8_t> turns;
    for (std::size_t n = 0; n < count; ++n) {
      const double at = unrolling_.angle(place_of(cloud_, n));
      if (std::abs(at) < angle) continue;
      from.push_back(static_cast<std::uint32_t>(n));
      turns.push_back(at < 0.0 ? 1 : -1);
    }
    append(from, turns);
  }

 private:
  template <typename Value>
  static void append_values(std::vector<Value>& values, const std::vector<std::uint32_t>& from) {
    if (values.empty()) return;
    values.reserve(values.size() + from.size());
    for (const std::uint32_t n : from) values.push_back(values[n]);
  }

  void append(const std::vector<std::uint32_t>& from, const std::vector<std::int8_t>& turns) {
    const std::size_t first = cloud_.size();
    cloud_.resize_points(first + from.size());
    for (std::size_t k = 0; k < from.size(); ++k)
      put_place(cloud_, first + k, unrolling_.turned(place_of(cloud_, from[k]), turns[k]));
    append_values(cloud_.rgba, from);
    append_values(cloud_.intensity, from);
  }

  Cloud& cloud_;
  const scene::Unrolling& unrolling_;
};

// The grid of a cylinder: once around, and over the seam on either side.
scene::GridConfig grid_of(const Cloud& cloud, const scene::Unrolling& unrolling, const scene::Config& config,
                          scene::GridConfig grid, const Context& context) {
  const auto lattice_of = [&] {
    return Projector(cloud, context.pool, false)
        .lattice(Eigen::Matrix4d::Identity(), grid, config.haptics.resolution_m, context);
  };
  const double period_m = unrolling.period_m();
  const NodesAround around = nodes_around(period_m, lattice_of().spacing_m, config.levels.window);
  const double turn = around.count;
  grid.size = 0;
  grid.spacing_m = period_m / turn;
  const scene::Lattice once = lattice_of();
  int overlap = static_cast<int>(std::ceil(turn * kOverlap / kTurn));
  overlap = std::min(around.count / 2, (overlap + around.step - 1) / around.step * around.step);
  const double left_m = -(0.5 * turn + overlap) * once.spacing_m;
  const double right_m = left_m + (turn + 2.0 * overlap - 1.0) * once.spacing_m;
  grid.bounds_m = {left_m, once.y_m(0), right_m, once.y_m(once.ny - 1)};
  return grid;
}

}  // namespace

void unroll_points(Cloud& cloud, const scene::Unrolling& unrolling) {
  const Eigen::Vector3d origin_m = cloud.origin_m;
  const std::size_t count = cloud.size();
  std::vector<Eigen::Vector3f> measured = std::move(cloud.measured);
  for (Eigen::Vector3f& place : measured) place = unrolling.flat(origin_m + place.cast<double>()).cast<float>();
  for (std::size_t n = 0; n < count; ++n) {
    const Eigen::Vector3d flat = unrolling.flat(place_of(cloud, n));
    put_place(cloud, n, flat);
  }
  cloud.origin_m.setZero();
  cloud.measured = std::move(measured);
  cloud.normals = {};
  cloud.stations = {};  // lines of sight are not straight any more
}

UnrolledCloud unroll_cloud(Cloud& cloud, const std::vector<Eigen::Vector3d>& sample_m, const scene::Config& config,
                           const scene::GridConfig& grid, const Context& context) {
  if (!cloud.faces.empty())
    throw usage_error("unroll: a scan with faces cannot be unrolled yet", "scans of points, or no block 'unroll'");
  UnrolledCloud result;
  const Eigen::Matrix4d& given = config.orientation.scan_to_grid;
  FoundMantle found = find_mantle(sample_m, *config.unroll, given.block<1, 3>(1, 0).transpose());
  result.reason = std::move(found.reason);
  result.unroll = found.unroll;
  result.grid = grid;
  result.points = cloud.size();
  result.scan_to_grid = scene::Unrolling(result.unroll, front_of(result.unroll, given)).scan_to_grid();
  constexpr double kSame = 1e-12;  // of a scene that is built again
  if (result.scan_to_grid.isApprox(given, kSame)) result.scan_to_grid = given;
  const scene::Unrolling unrolling(result.unroll, result.scan_to_grid);
  unroll_points(cloud, unrolling);
  context.progress.throw_if_cancelled();
  Repeater repeater(cloud, unrolling);
  if (unrolling.is_cone()) {
    repeater.repeat_beyond(0.5 * kTurn - kOverlap);
    return result;
  }
  // A lattice that is given as a whole is that of a scene, to be checked.
  if (!(grid.bounds_m && grid.spacing_m > 0.0)) result.grid = grid_of(cloud, unrolling, config, grid, context);
  const double reach_m = -result.grid.bounds_m->at(0) + kBeyondNodes * result.grid.spacing_m;
  repeater.repeat_beyond(std::max(0.0, kTurn - unrolling.angle({reach_m, 0.0, 0.0})));
  return result;
}

void uncount_repeated(std::size_t points, Projection& projection) {
  for (std::size_t n = points; n < projection.point_class.size(); ++n) {
    switch (projection.point_class[n]) {
      case PointClass::used:
        --projection.used;
        break;
      case PointClass::occluded:
        --projection.occluded;
        break;
      case PointClass::outlier:
        --projection.outlier;
        break;
      case PointClass::outside:
        --projection.outside;
        break;
    }
  }
  projection.edge_on = std::min(projection.edge_on, projection.occluded);
}

}  // namespace sparsha::pipeline
