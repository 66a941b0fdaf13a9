// Small pictures of an object's six sides, by which a person chooses the front that its points leave open.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pipeline/orient/side_picture.h"

namespace sparsha::pipeline {

/// Front, back, left, right, top and bottom of what is seen first from `look_from`, with their names. Directions are
/// rounded to three digits but the front's own.
struct NamedView {
  std::string name;
  Eigen::Vector3d look_from, up;
};
[[nodiscard]] std::vector<NamedView> six_sides(const Eigen::Vector3d& look_from, const Eigen::Vector3d& up);

/// Of length 1, rounded to three digits.
[[nodiscard]] Eigen::Vector3d rounded_direction(const Eigen::Vector3d& direction);

/// A side as it looks without perspective under a light from the upper left. All of one object have the same scale.
struct Thumbnail {
  static constexpr std::uint8_t kNothing = 255;  ///< where no surface is; surfaces are at most 230

  std::string name;  ///< front, back, ...
  Eigen::Vector3d look_from = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  int side = 0;                    ///< pixels: it is a square
  std::vector<std::uint8_t> grey;  ///< rows from the top down
};

[[nodiscard]] Thumbnail thumbnail_of(const EvenPoints& object, const NamedView& view);
/// Of six_sides(), in their order. Empty when the object has no points.
[[nodiscard]] std::vector<Thumbnail> six_thumbnails(const EvenPoints& object, const Eigen::Vector3d& look_from,
                                                    const Eigen::Vector3d& up);

}  // namespace sparsha::pipeline
