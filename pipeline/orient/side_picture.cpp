// Discs of points, the nearest in front; differences of two Gaussians whose windows end at steps.
#include "pipeline/orient/side_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <Eigen/Geometry>

#include "pipeline/scan/origin.h"
#include "pipeline/scan/statistics.h"
#include "scene/config/orientation.h"

namespace sparsha::pipeline {
namespace {

constexpr double kPixels = 150.0;              // along the diagonal of the object's box
constexpr std::array kInner = {0.005, 0.995};  // of the points, per axis: a far outlier says nothing about the object
constexpr double kThinned = 0.7;               // pixels: width of the cubes that keep one point
constexpr float kDisc = 1.6F;                  // pixels: radius of a point
constexpr float kBehind = 2.0F;                // pixels: farther behind the first point is another layer
constexpr double kFine = 1.5, kCoarse = 3.0;   // pixels: standard deviations of the two Gaussians
constexpr float kSteep = 3.0F;                 // a slope beyond is a step
constexpr double kLeastWindow = 0.35;          // of a Gaussian's weight
constexpr float kMostRelief = 1.0F;            // pixels

struct Placed {
  float x, y, z;
};

std::vector<Placed> seen_from(const EvenPoints& object, const Eigen::Vector3d& look_from, const Eigen::Vector3d& up) {
  const Eigen::Vector3d right = up.cross(look_from);
  std::vector<Placed> placed;
  placed.reserve(object.points.size());
  for (const Eigen::Vector3d& p : object.points) {
    placed.push_back({static_cast<float>(right.dot(p) + object.half), static_cast<float>(up.dot(p) + object.half),
                      static_cast<float>(look_from.dot(p))});
  }
  return placed;
}

// Calls with each pixel of a point's disc: its index and the squared distance from the point.
template <typename Visit>
void for_disc(const SidePicture& picture, const Placed& p, const Visit& visit) {
  const int reach = static_cast<int>(std::ceil(kDisc));
  const int cx = static_cast<int>(std::lround(p.x));
  const int cy = static_cast<int>(std::lround(p.y));
  for (int y = std::max(0, cy - reach); y <= std::min(picture.side - 1, cy + reach); ++y) {
    for (int x = std::max(0, cx - reach); x <= std::min(picture.side - 1, cx + reach); ++x) {
      const float dx = static_cast<float>(x) - p.x;
      const float dy = static_cast<float>(y) - p.y;
      const float squared = dx * dx + dy * dy;
      if (squared <= kDisc * kDisc) visit(picture.index(x, y), squared);
    }
  }
}

// Mean heights under a Gaussian. Pixels count in pairs opposite each other, so that a slope changes nothing, and only
// where both lie on the middle's own surface. NaN where too few do.
std::vector<float> smoothed(const SidePicture& picture, double sigma) {
  struct Pair {
    int x, y;
    float weight, step;
  };
  const int reach = static_cast<int>(std::ceil(2.0 * sigma));
  std::vector<Pair> pairs;
  double total = 1.0;
  for (int y = 0; y <= reach; ++y) {
    for (int x = y == 0 ? 1 : -reach; x <= reach; ++x) {
      const double squared = x * x + y * y;
      const double weight = std::exp(-0.5 * squared / (sigma * sigma));
      pairs.push_back({x, y, static_cast<float>(weight), kSteep * static_cast<float>(std::sqrt(squared)) + 1.0F});
      total += 2.0 * weight;
    }
  }
  std::vector<float> mean(picture.height.size(), std::numeric_limits<float>::quiet_NaN());
  for (int y = reach; y < picture.side - reach; ++y) {
    for (int x = reach; x < picture.side - reach; ++x) {
      const float middle = picture.height[picture.index(x, y)];
      if (std::isnan(middle)) continue;
      float sum = middle;
      float weights = 1.0F;
      for (const Pair& pair : pairs) {
        const float a = picture.height[picture.index(x + pair.x, y + pair.y)];
        const float b = picture.height[picture.index(x - pair.x, y - pair.y)];
        if (!(std::abs(a - middle) < pair.step) || !(std::abs(b - middle) < pair.step)) continue;
        sum += pair.weight * (a + b);
        weights += 2.0F * pair.weight;
      }
      if (weights > kLeastWindow * total) mean[picture.index(x, y)] = sum / weights;
    }
  }
  return mean;
}

struct Box {
  Eigen::Vector3d low, high;
  [[nodiscard]] Eigen::Vector3d middle() const { return 0.5 * (low + high); }
  [[nodiscard]] double size() const { return (high - low).norm(); }
  /// From the middle to where the object ends, with a margin.
  [[nodiscard]] Eigen::Vector3d reach() const { return 0.55 * (high - low) + Eigen::Vector3d::Constant(0.02 * size()); }
};

Box box_of(const std::vector<Eigen::Vector3d>& points) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = coordinate_quantile(points, axis, kInner[0]);
    box.high[axis] = coordinate_quantile(points, axis, kInner[1]);
  }
  return box;
}

using Cell = std::array<std::int32_t, 3>;

Cell cell_of(const Eigen::Vector3d& place, double cell) {
  const Eigen::Vector3d floor = (place / cell).array().floor();
  return {static_cast<std::int32_t>(floor.x()), static_cast<std::int32_t>(floor.y()),
          static_cast<std::int32_t>(floor.z())};
}

// About the middle of the box, one a cube: the mean of what lies in it. Sorted by cubes.
std::vector<Eigen::Vector3d> thinned(const std::vector<Eigen::Vector3d>& surface, const Box& box, double cell) {
  struct Celled {
    Cell cell;
    Eigen::Vector3d point;
  };
  const Eigen::Vector3d middle = box.middle();
  const Eigen::Vector3d reach = box.reach();
  std::vector<Celled> celled;
  celled.reserve(surface.size());
  for (const Eigen::Vector3d& p : surface) {
    const Eigen::Vector3d d = p - middle;
    if ((d.array().abs() <= reach.array()).all()) celled.push_back({cell_of(d, cell), d});
  }
  std::sort(celled.begin(), celled.end(), [](const Celled& a, const Celled& b) {
    if (a.cell != b.cell) return a.cell < b.cell;
    return std::lexicographical_compare(a.point.begin(), a.point.end(), b.point.begin(), b.point.end());
  });
  std::vector<Eigen::Vector3d> means;
  for (std::size_t i = 0; i < celled.size();) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const std::size_t first = i;
    for (; i < celled.size() && celled[i].cell == celled[first].cell; ++i) sum += celled[i].point;
    means.emplace_back(sum / static_cast<double>(i - first));
  }
  return means;
}

EvenPoints even_within(const std::vector<Eigen::Vector3d>& surface_m, const Box& box) {
  EvenPoints even;
  const double size_m = box.size();
  if (!(size_m > 0.0) || !std::isfinite(size_m)) return even;
  even.pixel_m = size_m / kPixels;
  even.points = thinned(surface_m, box, kThinned * even.pixel_m);
  // Clouds that are sparser than that have larger pixels, so that their discs leave no holes.
  const double apart_m = median_spacing(even.points);
  if (apart_m > even.pixel_m) {
    even.pixel_m = apart_m;
    even.points = thinned(surface_m, box, kThinned * even.pixel_m);
  }
  for (Eigen::Vector3d& p : even.points) p /= even.pixel_m;
  even.half = static_cast<int>(std::ceil((box.reach() / even.pixel_m).norm())) + 2;
  return even;
}

// Those that have others around them, as a surface does. All, where that would take away more than scattered points
// are of a scan.
std::vector<Eigen::Vector3d> without_scattered(const EvenPoints& even) {
  constexpr int kAround = 3;              // cubes each way
  constexpr std::size_t kOthers = 2;      // of them with points
  constexpr double kMostScattered = 0.4;  // of the cubes: a twentieth of the points fills many
  std::vector<Cell> cells;
  cells.reserve(even.points.size());
  for (const Eigen::Vector3d& p : even.points) cells.push_back(cell_of(p, kThinned));
  std::vector<Cell> sorted = cells;
  std::sort(sorted.begin(), sorted.end());
  const auto others_near = [&](const Cell& cell) {
    std::size_t others = 0;
    for (int x = -kAround; x <= kAround; ++x) {
      for (int y = -kAround; y <= kAround; ++y) {
        const Cell from{cell[0] + x, cell[1] + y, cell[2] - kAround};
        const Cell to{cell[0] + x, cell[1] + y, cell[2] + kAround};
        others += static_cast<std::size_t>(std::upper_bound(sorted.begin(), sorted.end(), to) -
                                           std::lower_bound(sorted.begin(), sorted.end(), from));
        if (others > kOthers) return others - 1;
      }
    }
    return others - 1;  // itself
  };
  std::vector<Eigen::Vector3d> kept;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (others_near(cells[i]) >= kOthers) kept.push_back(even.points[i]);
  const double left = static_cast<double>(kept.size()) / static_cast<double>(std::max<std::size_t>(1, cells.size()));
  return left < 1.0 - kMostScattered ? even.points : kept;
}

}  // namespace

EvenPoints even_points(const std::vector<Eigen::Vector3d>& surface_m) {
  if (surface_m.size() < 4) return {};
  const Box all = box_of(surface_m);
  EvenPoints even = even_within(surface_m, all);
  std::vector<Eigen::Vector3d> kept = without_scattered(even);
  if (kept.size() == even.points.size()) return even;
  // What is scattered about makes the object look smaller than it is: again, within a box around the rest.
  for (Eigen::Vector3d& p : kept) p = all.middle() + even.pixel_m * p;
  even = even_within(surface_m, box_of(kept));
  even.points = without_scattered(even);
  return even;
}

SidePicture picture_from(const EvenPoints& object, const Eigen::Vector3d& look_from, const Eigen::Vector3d& up) {
  SidePicture picture;
  picture.side = 2 * object.half + 1;
  const auto count = static_cast<std::size_t>(picture.side) * static_cast<std::size_t>(picture.side);
  const std::vector<Placed> placed = seen_from(object, look_from, up);
  std::vector<float> first(count, -std::numeric_limits<float>::infinity());
  for (const Placed& p : placed)
    for_disc(picture, p, [&](std::size_t n, float) { first[n] = std::max(first[n], p.z); });
  std::vector<float> sum(count, 0.0F);
  std::vector<float> weight(count, 0.0F);
  for (const Placed& p : placed) {
    for_disc(picture, p, [&](std::size_t n, float squared) {
      if (p.z < first[n] - kBehind) return;
      const float w = 1.01F - squared / (kDisc * kDisc);
      sum[n] += w * p.z;
      weight[n] += w;
    });
  }
  picture.height.resize(count);
  for (std::size_t n = 0; n < count; ++n)
    picture.height[n] = weight[n] > 0.0F ? sum[n] / weight[n] : std::numeric_limits<float>::quiet_NaN();
  return picture;
}

std::vector<Eigen::Vector3d> sides_all_around() {
  std::vector<Eigen::Vector3d> sides;
  for (const int z : {-1, 0, 1})
    for (const int y : {-1, 0, 1})
      for (const int x : {-1, 0, 1})
        if (x != 0 || y != 0 || z != 0) sides.push_back(Eigen::Vector3d(x, y, z).normalized());
  return sides;
}

double seen_share(const EvenPoints& object, const SidePicture& picture, const Eigen::Vector3d& look_from,
                  const Eigen::Vector3d& up) {
  if (object.points.empty()) return 0.0;
  std::size_t seen = 0;
  for (const Placed& p : seen_from(object, look_from, up)) {
    const int x = std::clamp(static_cast<int>(std::lround(p.x)), 0, picture.side - 1);
    const int y = std::clamp(static_cast<int>(std::lround(p.y)), 0, picture.side - 1);
    if (!(p.z < picture.height[picture.index(x, y)] - 2.0F * kBehind)) ++seen;
  }
  return static_cast<double>(seen) / static_cast<double>(object.points.size());
}

std::vector<float> relief_of(const SidePicture& picture) { return relief_of(picture, kFine, kCoarse, kMostRelief); }

std::vector<float> relief_of(const SidePicture& picture, double fine_px, double coarse_px, float most) {
  const std::vector<float> fine = smoothed(picture, fine_px);
  const std::vector<float> coarse = smoothed(picture, coarse_px);
  std::vector<float> relief(fine.size());
  for (std::size_t n = 0; n < fine.size(); ++n) {
    const float difference = fine[n] - coarse[n];
    relief[n] = std::isfinite(difference) ? std::clamp(difference, -most, most) : 0.0F;
  }
  return relief;
}

}  // namespace sparsha::pipeline
