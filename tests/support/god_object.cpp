#include "tests/support/god_object.h"

#include <algorithm>
#include <cmath>

namespace sparsha::test {

using Eigen::Vector3d;

Vector3d GodObject::normal(const Vector3d& place_m) const {
  const double step = 1e-3 * step_m_;
  Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d d = step * Vector3d::Unit(axis);
    gradient[axis] = object_.distance_m(place_m + d) - object_.distance_m(place_m - d);
  }
  return gradient.normalized();
}

Vector3d GodObject::on_surface(Vector3d place_m) const {
  for (int k = 0; k < 20; ++k) {
    const double d = object_.distance_m(place_m);
    if (std::abs(d) < 1e-6 * step_m_) break;
    place_m -= d * normal(place_m);
  }
  return place_m;
}

void GodObject::move(const Vector3d& hand_m) {
  for (int k = 0; k < 8; ++k) {
    if (!contact_) fly(hand_m);
    if (!contact_) return;
    slide(hand_m);
    if (contact_) return;
  }
}

void GodObject::fly(const Vector3d& hand_m) {
  const Vector3d way = hand_m - place_m_;
  const int steps = std::max(1, static_cast<int>(std::ceil(way.norm() / (0.05 * step_m_))));
  bool outside = object_.distance_m(place_m_) > -1e-4 * step_m_;
  const Vector3d from = place_m_;
  for (int k = 1; k <= steps; ++k) {
    const Vector3d next = from + way * (static_cast<double>(k) / steps);
    const double d = object_.distance_m(next);
    if (outside && d < -1e-4 * step_m_) {
      place_m_ = on_surface(next);
      contact_ = true;
      return;
    }
    outside = outside || d >= 0.0;
  }
  place_m_ = hand_m;
}

void GodObject::slide(const Vector3d& hand_m) {
  double reach = step_m_;
  for (int k = 0; k < 4000 && reach > 1e-7 * step_m_; ++k) {
    const Vector3d pull = hand_m - place_m_;
    const Vector3d n = normal(place_m_);
    const double out = pull.dot(n);
    if (out > 0.0) {
      contact_ = false;
      place_m_ += 1e-3 * step_m_ * n;
      return;
    }
    const Vector3d along = pull - out * n;
    const double length = along.norm();
    if (length < 1e-6 * step_m_) return;
    const Vector3d next = on_surface(place_m_ + along * std::min(1.0, reach / length));
    if ((hand_m - next).squaredNorm() < pull.squaredNorm()) {
      place_m_ = next;
      reach = std::min(step_m_, 1.5 * reach);
    } else {
      reach *= 0.5;
      if (reach > length) reach = 0.5 * length;
    }
  }
}

}  // namespace sparsha::test
