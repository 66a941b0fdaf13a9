// Sums of integers first; only then floating point, of whole neighbourhoods.
#include "pipeline/projection/edge_on.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace sparsha::pipeline {
namespace {

constexpr double kSteps = 256.0;       // of a cube's moments
constexpr double kCubeSpacings = 2.5;  // a plane at that distance of points leaves 56 in three by three by three cubes
constexpr std::int64_t kLeastPoints = 8;  // of them: an eighth of that density and more
constexpr double kThin = 0.15;            // standard deviation across the plane, cubes; of scattered points it is 0.87
constexpr double kWide = 0.4;             // and along it, less than which is a line or a clump
constexpr double kAlongSight = 0.3;       // cosine of normal and line of sight: a slope of more than 3
constexpr double kWithinDeviations = 3.0;
constexpr std::size_t kPiece = 1U << 14U;

}  // namespace

EdgeOnSurfaces::EdgeOnSurfaces(const BinLattice& lattice, double point_spacing_m)
    : locator_(lattice),
      bins_per_cube_(static_cast<int>(std::clamp(std::ceil(kCubeSpacings * point_spacing_m / lattice.spacing_m), 1.0,
                                                 static_cast<double>(std::max(lattice.nx, lattice.ny))))),
      per_cube_m_(static_cast<float>(1.0 / (bins_per_cube_ * lattice.spacing_m))),
      middle_(0.5 * lattice.bins_x() / bins_per_cube_, 0.5 * lattice.bins_y() / bins_per_cube_) {}

bool EdgeOnSurfaces::find_place(const OrientedPoints& points, std::size_t k, Place& place) const {
  int column = 0;
  int row = 0;
  if (!locator_.locate(points.x[k], points.y[k], column, row)) return false;
  const double z = static_cast<double>(points.z[k]) * static_cast<double>(per_cube_m_);
  constexpr double kFar = 1e15;  // cubes
  if (!(std::abs(z) < kFar)) return false;
  place.key = {column / bins_per_cube_, row / bins_per_cube_, static_cast<std::int64_t>(std::floor(z))};
  const auto u = static_cast<double>((points.x[k] - locator_.x_shift_m) * per_cube_m_);
  const auto v = static_cast<double>((points.y[k] - locator_.y_shift_m) * per_cube_m_);
  const Eigen::Vector3d inside(u - static_cast<double>(place.key[0]), v - static_cast<double>(place.key[1]),
                               z - static_cast<double>(place.key[2]));
  place.inside = inside.cwiseMax(0.0).cwiseMin(1.0);  // beyond by rounding alone
  return true;
}

void EdgeOnSurfaces::add(const OrientedPoints& points, const PointClass* point_class) {
  Place place;
  for (std::size_t k = 0; k < points.count; ++k) {
    if (point_class[k] != PointClass::outlier || !find_place(points, k, place)) continue;
    auto& cubes = rows_[place.key[1]].cubes;
    Moments& moments = cubes[cubes.number(place.key)].moments;
    std::array<std::int64_t, 3> step{};
    for (std::size_t a = 0; a < 3; ++a)
      step[a] = static_cast<std::int64_t>(place.inside[static_cast<Eigen::Index>(a)] * kSteps);
    ++moments.count;
    for (std::size_t a = 0, ab = 0; a < 3; ++a) {
      moments.first[a] += step[a];
      for (std::size_t b = a; b < 3; ++b) moments.second[ab++] += step[a] * step[b];
    }
  }
}

const EdgeOnSurfaces::Cube* EdgeOnSurfaces::cube(const Key& key) const {
  const auto row = rows_.find(key[1]);
  if (row == rows_.end()) return nullptr;
  const std::uint32_t number = row->second.cubes.find(key);
  return number == row->second.cubes.size() ? nullptr : &row->second.cubes[number];
}

/// Of three by three by three cubes, about the lower corner of the middle one.
EdgeOnSurfaces::Moments EdgeOnSurfaces::around(const Key& key) const {
  Moments sum;
  for (std::int64_t j = -1; j <= 1; ++j)
    for (std::int64_t i = -1; i <= 1; ++i)
      for (std::int64_t k = -1; k <= 1; ++k) {
        const Cube* const here = cube({key[0] + i, key[1] + j, key[2] + k});
        if (here == nullptr) continue;
        const Moments& m = here->moments;
        const auto steps = static_cast<std::int64_t>(kSteps);
        const std::array<std::int64_t, 3> shift{i * steps, j * steps, k * steps};
        sum.count += m.count;
        for (std::size_t a = 0, ab = 0; a < 3; ++a) {
          sum.first[a] += m.first[a] + m.count * shift[a];
          for (std::size_t b = a; b < 3; ++b, ++ab)
            sum.second[ab] +=
                m.second[ab] + shift[a] * m.first[b] + shift[b] * m.first[a] + m.count * shift[a] * shift[b];
        }
      }
  return sum;
}

void EdgeOnSurfaces::decide(Cube& cube) const {
  const Moments sum = around(cube.key);
  if (sum.count < kLeastPoints) return;
  const auto n = static_cast<double>(sum.count);
  Eigen::Vector3d mean;
  for (std::size_t a = 0; a < 3; ++a)
    mean[static_cast<Eigen::Index>(a)] = (static_cast<double>(sum.first[a]) / n + 0.5) / kSteps;
  Eigen::Matrix3d covariance;
  for (Eigen::Index a = 0, ab = 0; a < 3; ++a)
    for (Eigen::Index b = a; b < 3; ++b, ++ab) {
      const double moment = static_cast<double>(sum.second[static_cast<std::size_t>(ab)]) / n;
      const double both = static_cast<double>(sum.first[static_cast<std::size_t>(a)]) / n *
                          (static_cast<double>(sum.first[static_cast<std::size_t>(b)]) / n);
      covariance(a, b) = covariance(b, a) = (moment - both) / (kSteps * kSteps);
    }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
  const double across = std::sqrt(std::max(0.0, axes.eigenvalues()[0]));
  const double along = std::sqrt(std::max(0.0, axes.eigenvalues()[1]));
  const Eigen::Vector3d normal = axes.eigenvectors().col(0);
  if (!(across <= kThin && along >= kWide && std::abs(normal.z()) <= kAlongSight)) return;
  cube.normal = normal;
  cube.offset = normal.dot(mean);
  cube.within = std::max(kWithinDeviations * across, kThin);
}

void EdgeOnSurfaces::decide_rows(std::int64_t first, std::int64_t last, ThreadPool& pool) {
  for (auto row = rows_.lower_bound(first); row != rows_.end() && row->first <= last; ++row) {
    if (row->second.decided) continue;
    auto& cubes = row->second.cubes;
    pool.for_ranges(cubes.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) decide(cubes[static_cast<std::uint32_t>(c)]);
    });
    for (std::size_t c = 0; c < cubes.size(); ++c) count_direction(cubes[static_cast<std::uint32_t>(c)]);
    row->second.decided = true;
  }
}

void EdgeOnSurfaces::count_direction(const Cube& cube) {
  if (cube.within == 0.0) return;
  constexpr double kUnit = 4096.0;  // of normals
  // One of the two normals: over half a turn.
  Eigen::Vector3d normal = cube.normal;
  if (normal.y() < 0.0 || (normal.y() == 0.0 && normal.x() < 0.0)) normal = -normal;
  const double turn = std::atan2(normal.y(), normal.x()) / std::numbers::pi;
  const auto direction = static_cast<std::size_t>(std::lround(turn * kDirections)) % kDirections;
  if (direction == 0 && normal.x() < 0.0) normal = -normal;
  Direction& sums = directions_[direction];
  const std::int64_t count = cube.moments.count;
  sums.points += count;
  for (std::size_t a = 0; a < 3; ++a)
    sums.normal[a] += count * std::llround(normal[static_cast<Eigen::Index>(a)] * kUnit);
  const Eigen::Vector2d place(static_cast<double>(cube.key[0]) - middle_.x(),
                              static_cast<double>(cube.key[1]) - middle_.y());
  sums.place += count * std::llround(16.0 * normal.head<2>().dot(place));
}

Eigen::Vector3d EdgeOnSurfaces::main_normal() const {
  const auto most = std::max_element(directions_.begin(), directions_.end(),
                                     [](const Direction& a, const Direction& b) { return a.points < b.points; });
  if (most->points == 0) return Eigen::Vector3d::Zero();
  // A plane's normals lie in two neighbours at most; of a round wall a few hundredths do.
  constexpr std::int64_t kOneOf = 4;
  const auto at = static_cast<std::size_t>(most - directions_.begin());
  const std::int64_t near = most->points + directions_[(at + 1) % kDirections].points +
                            directions_[(at + kDirections - 1) % kDirections].points;
  std::int64_t all = 0;
  for (const Direction& direction : directions_) all += direction.points;
  if (kOneOf * near < all) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d normal =
      Eigen::Vector3d(static_cast<double>(most->normal[0]), static_cast<double>(most->normal[1]),
                      static_cast<double>(most->normal[2]))
          .normalized();
  return most->place > 0 ? Eigen::Vector3d(-normal) : normal;
}

bool EdgeOnSurfaces::on_a_surface(const Place& place) const {
  for (std::int64_t j = -1; j <= 1; ++j)
    for (std::int64_t i = -1; i <= 1; ++i)
      for (std::int64_t k = -1; k <= 1; ++k) {
        const Cube* const here = cube({place.key[0] + i, place.key[1] + j, place.key[2] + k});
        if (here == nullptr || here->within == 0.0) continue;
        const Eigen::Vector3d p =
            place.inside - Eigen::Vector3d(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
        if (std::abs(here->normal.dot(p) - here->offset) <= here->within) return true;
      }
  return false;
}

std::uint64_t EdgeOnSurfaces::take_out(const OrientedPoints& points, PointClass* point_class, ThreadPool& pool) {
  std::vector<std::uint32_t> outliers;
  std::int64_t first = std::numeric_limits<std::int64_t>::max();
  std::int64_t last = std::numeric_limits<std::int64_t>::min();
  Place place;
  for (std::size_t k = 0; k < points.count; ++k) {
    if (point_class[k] != PointClass::outlier || !find_place(points, k, place)) continue;
    outliers.push_back(static_cast<std::uint32_t>(k));
    first = std::min(first, place.key[1]);
    last = std::max(last, place.key[1]);
  }
  if (outliers.empty()) return 0;
  decide_rows(first - 1, last + 1, pool);
  pool.for_ranges(outliers.size(), kPiece, [&](std::size_t begin, std::size_t end) {
    Place mine;
    for (std::size_t o = begin; o < end; ++o)
      if (find_place(points, outliers[o], mine) && on_a_surface(mine)) point_class[outliers[o]] = PointClass::occluded;
  });
  return static_cast<std::uint64_t>(std::count_if(
      outliers.begin(), outliers.end(), [&](std::uint32_t k) { return point_class[k] == PointClass::occluded; }));
}

void EdgeOnSurfaces::forget_before(int bin_row) {
  rows_.erase(rows_.begin(), rows_.lower_bound(bin_row / bins_per_cube_));
}

void add_edge_on(std::uint64_t points, const Eigen::Vector3d& normal, const Eigen::Matrix4d& scan_to_grid,
                 Projection& projection) {
  projection.outlier -= points;
  projection.occluded += points;
  projection.edge_on += points;
  const Eigen::Vector3d in_scan = scan_to_grid.topLeftCorner<3, 3>().transpose() * normal;
  projection.edge_on_normal = normal.isZero() ? Eigen::Vector3d(normal) : Eigen::Vector3d(in_scan.normalized());
}

}  // namespace sparsha::pipeline
