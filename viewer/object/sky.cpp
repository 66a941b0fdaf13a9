// Pictures of the depth of the blockers, from many directions evenly over the sphere: what lies behind them does not
// see the sky there.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "viewer/object/mesh.h"

namespace sparsha::viewer {
namespace {

constexpr int kDirections = 72;
constexpr int kMostPixels = 320;     // of a depth picture's side
constexpr double kLeastPixel = 2.0;  // of the blockers' spacing, so that their vertices leave no gap
constexpr float kClear = 2.5F;       // pixels along its normal from which a vertex looks at the sky
constexpr float kEdge = 3.0F;        // pixels of depth over which a blocker takes the sky away

struct DepthPicture {
  Eigen::Vector3f right, up, towards;
  std::vector<float> nearest;  // along `towards`
};

/// Evenly spread points of the sphere (a Fibonacci lattice).
Eigen::Vector3f direction(int k) {
  const double z = 1.0 - (2.0 * k + 1.0) / kDirections;
  const double turn = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double radius = std::sqrt(1.0 - z * z);
  return Eigen::Vector3d(radius * std::cos(turn), radius * std::sin(turn), z).cast<float>();
}

}  // namespace

std::vector<float> sky_over(const ObjectMesh& mesh, const ObjectMesh& blockers, ThreadPool& pool) {
  Eigen::Vector3f low = mesh.place.front(), high = low;
  for (const ObjectMesh* of : {&mesh, &blockers})
    for (const Eigen::Vector3f& p : of->place) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  const Eigen::Vector3f middle = 0.5F * (low + high);
  const float radius = 0.5F * (high - low).norm() + static_cast<float>(blockers.spacing);
  const auto pixel = static_cast<float>(
      std::max(kLeastPixel * blockers.spacing, 2.0 * static_cast<double>(radius) / (kMostPixels - 4)));
  const int side = static_cast<int>(std::ceil(2.0F * radius / pixel)) + 4;
  const auto at = [&](const DepthPicture& picture, const Eigen::Vector3f& p) -> Eigen::Vector2f {
    const Eigen::Vector3f from = p - middle;
    return Eigen::Vector2f(picture.right.dot(from), picture.up.dot(from)) / pixel +
           Eigen::Vector2f::Constant(0.5F * static_cast<float>(side));
  };

  std::array<DepthPicture, kDirections> pictures;
  pool.for_ranges(kDirections, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      DepthPicture& picture = pictures[k];
      picture.towards = direction(static_cast<int>(k));
      picture.right = picture.towards.unitOrthogonal();
      picture.up = picture.towards.cross(picture.right);
      picture.nearest.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), -1e30F);
      for (const Eigen::Vector3f& p : blockers.place) {
        const Eigen::Vector2f xy = at(picture, p);
        const float depth = picture.towards.dot(p - middle);
        const int x = static_cast<int>(xy.x() - 0.5F), y = static_cast<int>(xy.y() - 0.5F);
        for (int b = y; b <= y + 1; ++b)
          for (int a = x; a <= x + 1; ++a) {
            float& nearest = picture.nearest[static_cast<std::size_t>(b * side + a)];
            nearest = std::max(nearest, depth);
          }
      }
    }
  });
  std::vector<float> share(mesh.place.size());
  pool.for_ranges(mesh.place.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Eigen::Vector3f from = mesh.place[v] + kClear * pixel * mesh.normal[v];
      float seen = 0.0F, all = 0.0F;
      for (const DepthPicture& picture : pictures) {
        const float cosine = picture.towards.dot(mesh.normal[v]);
        if (cosine <= 0.0F) continue;
        all += cosine;
        const Eigen::Vector2f xy = at(picture, from);
        const int x = std::clamp(static_cast<int>(xy.x()), 0, side - 1);
        const int y = std::clamp(static_cast<int>(xy.y()), 0, side - 1);
        const float over = picture.nearest[static_cast<std::size_t>(y * side + x)] - picture.towards.dot(from - middle);
        seen += cosine * std::clamp(1.0F - over / (kEdge * pixel), 0.0F, 1.0F);
      }
      share[v] = all > 0.0F ? seen / all : 1.0F;
    }
  });
  return share;
}

}  // namespace sparsha::viewer
