// A tree of boxes over the nodes, each cut across its longest side.
#include "scene/solid/winding.h"

#include <algorithm>
#include <cmath>

namespace sparsha::scene {
namespace {

constexpr float kFar = 2.5F;           // radii of a box from which on its pieces count as one
constexpr float kSoft2 = 0.4F * 0.4F;  // spacings^2
constexpr double kPerSolidAngle = 0.25 / 3.14159265358979323846;

/// The solid angle of a small piece, softened near it.
float angle_of(const Eigen::Vector3f& area, const Eigen::Vector3f& away) {
  const float r2 = away.squaredNorm() + kSoft2;
  return area.dot(away) / (r2 * std::sqrt(r2));
}

/// The area that a node stands for, in squares of the spacing: of the charts that the place is in, each has the share
/// of its squared facing.
double area_of(const Eigen::Vector3d& normal, double facing, double least_facing) {
  double all = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(normal[axis]) >= least_facing) all += normal[axis] * normal[axis];
  }
  return facing / std::max(all, facing * facing);
}

}  // namespace

WindingNumber::WindingNumber(const Charts& charts) {
  constexpr double kLeastFacing = 0.4;  // of a node in its chart
  pieces_.reserve(charts.measured_nodes());
  for (const Sheet& sheet : charts.sheets) {
    const SideAxes axes = SideAxes::of(sheet.side);
    for (int j = 0; j < sheet.ny; ++j) {
      for (int i = 0; i < sheet.nx; ++i) {
        if (!sheet.measured(sheet.index(i, j))) continue;
        const Eigen::Vector3d normal = Charts::normal(sheet, i, j);
        const double area = area_of(normal, axes.sign * normal[axes.w], kLeastFacing);
        pieces_.push_back(
            {(charts.place_m(sheet, i, j) / charts.spacing_m).cast<float>(), (area * normal).cast<float>()});
      }
    }
  }
  boxes_.reserve(pieces_.size() / 2 + 2);
  if (!pieces_.empty()) build(0, static_cast<std::uint32_t>(pieces_.size()));
}

std::uint32_t WindingNumber::build(std::uint32_t begin, std::uint32_t end) {
  const auto number = static_cast<std::uint32_t>(boxes_.size());
  boxes_.emplace_back();
  Box box;
  box.begin = begin;
  box.end = end;
  Eigen::Vector3f low = pieces_[begin].centre, high = low;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), area = Eigen::Vector3d::Zero();
  double weight = 0.0;
  for (std::uint32_t k = begin; k < end; ++k) {
    const Piece& piece = pieces_[k];
    low = low.cwiseMin(piece.centre);
    high = high.cwiseMax(piece.centre);
    const auto size = static_cast<double>(piece.area.norm());
    centre += size * piece.centre.cast<double>();
    area += piece.area.cast<double>();
    weight += size;
  }
  box.all = {(centre / weight).cast<float>(), area.cast<float>()};
  for (std::uint32_t k = begin; k < end; ++k) {
    box.radius = std::max(box.radius, (pieces_[k].centre - box.all.centre).norm());
  }
  if (end - begin > kLeaf) {
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const std::uint32_t middle = begin + (end - begin) / 2;
    const auto less = [axis](const Piece& a, const Piece& b) {
      for (Eigen::Index k = 0; k < 3; ++k) {  // a total order, so that every library's partition is the same set
        const Eigen::Index at = (axis + k) % 3;
        if (a.centre[at] != b.centre[at]) return a.centre[at] < b.centre[at];
      }
      return std::lexicographical_compare(a.area.data(), a.area.data() + 3, b.area.data(), b.area.data() + 3);
    };
    std::nth_element(pieces_.begin() + begin, pieces_.begin() + middle, pieces_.begin() + end, less);
    build(begin, middle);
    box.second = build(middle, end);
  }
  boxes_[number] = box;
  return number;
}

double WindingNumber::at(const Eigen::Vector3f& place) const {
  if (boxes_.empty()) return 0.0;
  std::array<std::uint32_t, 64> waiting{};
  std::size_t count = 0;
  waiting[count++] = 0;
  double sum = 0.0;
  while (count > 0) {
    const std::uint32_t number = waiting[--count];
    const Box& box = boxes_[number];
    const Eigen::Vector3f away = box.all.centre - place;
    if (away.squaredNorm() > kFar * kFar * box.radius * box.radius + 4.0F) {
      sum += static_cast<double>(angle_of(box.all.area, away));
    } else if (box.second == 0) {
      for (std::uint32_t k = box.begin; k < box.end; ++k) {
        sum += static_cast<double>(angle_of(pieces_[k].area, pieces_[k].centre - place));
      }
    } else {
      waiting[count++] = box.second;
      waiting[count++] = number + 1;
    }
  }
  return sum * kPerSolidAngle;
}

}  // namespace sparsha::scene
