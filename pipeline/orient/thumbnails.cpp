#include "pipeline/orient/thumbnails.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

// The slope along a row or a column, one-sided beside steps and where nothing is.
float slope(float before, float here, float after) {
  constexpr float kStep = 4.0F;  // pixels a pixel
  const float left = here - before;
  const float right = after - here;
  const bool lefts = std::abs(left) < kStep;  // false for NaN
  const bool rights = std::abs(right) < kStep;
  if (lefts && rights) return 0.5F * (left + right);
  return lefts ? left : rights ? right : 0.0F;
}

}  // namespace

Thumbnail thumbnail_of(const EvenPoints& object, const NamedView& view) {
  const Eigen::Vector3d ahead = view.look_from.normalized();
  const Eigen::Vector3d up = (view.up - view.up.dot(ahead) * ahead).normalized();
  const SidePicture picture = picture_from(object, ahead, up);
  Thumbnail thumbnail{view.name, view.look_from, view.up, picture.side, {}};
  thumbnail.grey.assign(picture.height.size(), Thumbnail::kNothing);
  const Eigen::Vector3f light = Eigen::Vector3f(-0.5F, 0.6F, 0.8F).normalized();
  for (int y = 1; y + 1 < picture.side; ++y) {
    for (int x = 1; x + 1 < picture.side; ++x) {
      const float here = picture.height[picture.index(x, y)];
      if (std::isnan(here)) continue;
      const Eigen::Vector3f normal(
          -slope(picture.height[picture.index(x - 1, y)], here, picture.height[picture.index(x + 1, y)]),
          -slope(picture.height[picture.index(x, y - 1)], here, picture.height[picture.index(x, y + 1)]), 1.0F);
      const float lit = std::max(0.0F, normal.normalized().dot(light));
      thumbnail.grey[picture.index(x, picture.side - 1 - y)] = static_cast<std::uint8_t>(30.0F + 200.0F * lit);
    }
  }
  return thumbnail;
}

Eigen::Vector3d rounded_direction(const Eigen::Vector3d& direction) {
  return (direction.normalized() * 1000.0).array().round() / 1000.0 + 0.0;
}

std::vector<NamedView> six_sides(const Eigen::Vector3d& look_from, const Eigen::Vector3d& up) {
  const Eigen::Vector3d ahead = look_from.normalized();
  const Eigen::Vector3d above = (up - up.dot(ahead) * ahead).normalized();
  const Eigen::Vector3d right = above.cross(ahead);
  const auto view = [](const char* name, const Eigen::Vector3d& from, const Eigen::Vector3d& upright) {
    return NamedView{name, rounded_direction(from), rounded_direction(upright)};
  };
  return {{"front", look_from, up},    view("back", -ahead, above), view("left", -right, above),
          view("right", right, above), view("top", above, -ahead),  view("bottom", -above, ahead)};
}

std::vector<Thumbnail> six_thumbnails(const EvenPoints& object, const Eigen::Vector3d& look_from,
                                      const Eigen::Vector3d& up) {
  std::vector<Thumbnail> thumbnails;
  if (object.points.empty()) return thumbnails;
  for (const NamedView& view : six_sides(look_from, up)) thumbnails.push_back(thumbnail_of(object, view));
  return thumbnails;
}

}  // namespace sparsha::pipeline
