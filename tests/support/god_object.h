// A god-object (Zilles & Salisbury 1995) on a signed distance, in steps so small that nothing else is needed. Slow; to
// judge renderers by, with which it shares no code.
#pragma once

#include <Eigen/Core>

#include "tests/support/closed_objects.h"

namespace sparsha::test {

class GodObject {
 public:
  /// `step_m`: of the proxy, at most. Starts free at `hand_m`.
  GodObject(const ClosedObject& object, double step_m, const Eigen::Vector3d& hand_m)
      : object_(object), step_m_(step_m), place_m_(hand_m) {}

  /// The hand moves straight to `hand_m`.
  void move(const Eigen::Vector3d& hand_m);

  [[nodiscard]] bool contact() const { return contact_; }
  /// The hand itself when free.
  [[nodiscard]] const Eigen::Vector3d& place_m() const { return place_m_; }
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& place_m) const;

 private:
  void fly(const Eigen::Vector3d& hand_m);
  void slide(const Eigen::Vector3d& hand_m);
  [[nodiscard]] Eigen::Vector3d on_surface(Eigen::Vector3d place_m) const;

  const ClosedObject& object_;
  double step_m_;
  Eigen::Vector3d place_m_;
  bool contact_ = false;
};

}  // namespace sparsha::test
