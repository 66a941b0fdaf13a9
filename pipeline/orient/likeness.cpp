// The mirror axis of a picture of carving, and what its rows hold.
#include "pipeline/orient/likeness.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

constexpr int kMiddle = 5;           // pixels either side of the mirror axis
constexpr double kAxisRange = 0.24;  // of the width, that the mirror axis may lie off the middle

// The sum over a picture's rows of relief times its mirror image. `twice` the axis's place is a whole number: it lies
// on a pixel or between two.
double mirrored_row(const SidePicture& picture, const std::vector<float>& relief, int y, int twice, int left,
                    int right) {
  double product = 0.0;
  for (int x = std::max(left, twice - right); 2 * x < twice; ++x) {
    product +=
        static_cast<double>(relief[picture.index(x, y)]) * static_cast<double>(relief[picture.index(twice - x, y)]);
  }
  return product;
}

Likeness likeness_of(const EvenPoints& object, const Eigen::Vector3d& look_from, const Eigen::Vector3d& up) {
  const SidePicture picture = picture_from(object, look_from, up);
  const std::vector<float> relief = relief_of(picture);
  const auto rows = static_cast<std::size_t>(picture.side);
  Likeness likeness{std::vector<double>(rows), std::vector<double>(rows), 0.0};
  double sum = 0.0;
  int left = picture.side;
  int right = 0;
  for (int y = 0; y < picture.side; ++y) {
    for (int x = 0; x < picture.side; ++x) {
      if (std::isnan(picture.height[picture.index(x, y)])) continue;
      likeness.area += 1.0;
      sum += x;
      left = std::min(left, x);
      right = std::max(right, x);
    }
  }
  if (likeness.area == 0.0) return likeness;
  const int middle = static_cast<int>(std::lround(2.0 * sum / likeness.area));
  const int range = static_cast<int>(kAxisRange * (right - left));
  double most = 0.0;
  int axis = middle;
  std::vector<double> tried(rows);
  for (int twice = middle - range; twice <= middle + range; ++twice) {
    double product = 0.0;
    for (int y = 0; y < picture.side; ++y)
      product += tried[static_cast<std::size_t>(y)] = mirrored_row(picture, relief, y, twice, left, right);
    if (product <= most) continue;
    most = product;
    axis = twice;
    likeness.mirrored = tried;
  }
  for (int y = 1; y + 1 < picture.side; ++y) {
    for (int x = std::max(left, axis / 2 - kMiddle); x <= std::min(right, axis / 2 + kMiddle); ++x) {
      const double change = static_cast<double>(relief[picture.index(x, y + 1)] - relief[picture.index(x, y - 1)]);
      likeness.profile[static_cast<std::size_t>(y)] += change * change;
    }
  }
  return likeness;
}

// The least of each row so far.
void take_least(std::vector<double>& least, const std::vector<double>& values) {
  if (least.empty()) least = values;
  for (std::size_t y = 0; y < values.size(); ++y) least[y] = std::max(0.0, std::min(least[y], values[y]));
}

// Of equally flat ones the last.
Eigen::Vector3d flattest_axis(const Eigen::Vector3d& up) {
  Eigen::Index flattest = 2;
  for (const Eigen::Index axis : {1, 0})
    if (std::abs(up[axis]) < std::abs(up[flattest]) - 1e-9) flattest = axis;
  return (flattest == 1 ? -1.0 : 1.0) * Eigen::Vector3d::Unit(flattest);
}

}  // namespace

FaceRing::FaceRing(const EvenPoints& object, const Eigen::Vector3d& up) : object_(object), up_(up) {
  const Eigen::Vector3d axis = flattest_axis(up);
  ahead_ = (axis - axis.dot(up) * up).normalized();
  std::vector<Likeness> likenesses;
  for (std::size_t k = 0; k < kTurns; ++k) {
    likenesses.push_back(likeness_at(static_cast<double>(k)));
    take_least(mirrored_, likenesses.back().mirrored);
    take_least(profile_, likenesses.back().profile);
  }
  for (std::size_t k = 0; k < kTurns; ++k) worth_[k] = worth_of(likenesses[k]);
}

Eigen::Vector3d FaceRing::direction(double turns) const {
  return std::cos(kTurn * turns) * ahead_ + std::sin(kTurn * turns) * up_.cross(ahead_);
}

Likeness FaceRing::likeness_at(double turns) const { return likeness_of(object_, direction(turns), up_); }

double FaceRing::worth_at(double turns) const { return worth_of(likeness_at(turns)); }

// Rows of the mirrored carving count by their square roots: a face has many rows, the edge of a plinth few.
double FaceRing::worth_of(const Likeness& likeness) const {
  double roots = 0.0;
  double changes = 0.0;
  for (std::size_t y = 0; y < mirrored_.size(); ++y) {
    roots += std::sqrt(std::max(0.0, likeness.mirrored[y] - mirrored_[y]));
    changes += likeness.profile[y] - profile_[y];
  }
  return roots * roots * std::sqrt(std::max(0.0, changes)) * std::pow(likeness.area, 1.5);
}

}  // namespace sparsha::pipeline
