#include "haptics/guide/guide_path.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace sparsha::haptics {

GuidePath::GuidePath(const std::vector<Eigen::Vector2d>& corners_m) {
  for (const Eigen::Vector2d& corner : corners_m) add({{corner.x(), corner.y(), 0.0}});
  finish();
}

GuidePath::GuidePath(const std::vector<PathCorner>& corners) : in_space_(true) {
  for (const PathCorner& corner : corners) add(corner);
  finish();
}

void GuidePath::add(const PathCorner& corner) {
  const Eigen::Vector3d& place_m = corner.place_m;
  if (!place_m.allFinite() || !corner.normal.allFinite())
    throw Error(ErrorKind::failure, {}, "a corner of a guide's line is not a number", "metres in the grid frame");
  if (!corners_m_.empty() && !((place_m - corners_m_.back()).norm() > 0.0)) return;
  along_m_.push_back(corners_m_.empty() ? 0.0 : along_m_.back() + (place_m - corners_m_.back()).norm());
  corners_m_.push_back(place_m);
  if (in_space_) normals_.push_back(corner.normal);
}

void GuidePath::finish() {
  if (corners_m_.size() < 2)
    throw Error(ErrorKind::failure, {}, "a guide's line has no length", "two different corners");
  closed_ = corners_m_.size() > 3 && corners_m_.front() == corners_m_.back();
}

GuidePath::Place GuidePath::nearest_on(std::size_t piece, const Eigen::Vector3d& point_m) const noexcept {
  const Eigen::Vector3d way = corners_m_[piece + 1] - corners_m_[piece];
  return {piece, std::clamp((point_m - corners_m_[piece]).dot(way) / way.squaredNorm(), 0.0, 1.0)};
}

GuidePath::Place GuidePath::nearest_among(std::size_t first, std::size_t count,
                                          const Eigen::Vector3d& point_m) const noexcept {
  Place best;
  double least_m2 = HUGE_VAL;
  for (std::size_t piece = first; piece < std::min(first + count, pieces()); ++piece) {
    const Place place = nearest_on(piece, point_m);
    const double distance_m2 = (this->point_m(place) - point_m).squaredNorm();
    if (distance_m2 >= least_m2) continue;
    least_m2 = distance_m2;
    best = place;
  }
  return best;
}

Eigen::Vector3d GuidePath::point_m(const Place& place) const noexcept {
  return corners_m_[place.piece] + place.share * (corners_m_[place.piece + 1] - corners_m_[place.piece]);
}

Eigen::Vector3d GuidePath::normal(const Place& place) const noexcept {
  if (!in_space_) return Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d& from = normals_[place.piece];
  const Eigen::Vector3d between = from + place.share * (normals_[place.piece + 1] - from);
  const double length = between.norm();
  return length > 0.0 ? Eigen::Vector3d(between / length) : from;
}

double GuidePath::along_m(const Place& place) const noexcept {
  return along_m_[place.piece] + place.share * (along_m_[place.piece + 1] - along_m_[place.piece]);
}

Eigen::Vector3d GuidePath::direction(std::size_t piece) const noexcept {
  return (corners_m_[piece + 1] - corners_m_[piece]).normalized();
}

}  // namespace sparsha::haptics
