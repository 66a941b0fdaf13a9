// The point proxy on a whole object: the exact solver moves it on one sheet at a time, and it goes over to the sheet
// that goes on where one ends (docs/use/whole-objects.md, "Touch"). Object frame, metres. For the servo thread: no
// allocation, no locks, no exceptions, bounded cost.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "haptics/around/flight.h"
#include "haptics/around/left_sheets.h"
#include "haptics/around/object_surface.h"
#include "haptics/around/seam_fade.h"
#include "haptics/around/unseen_entry.h"
#include "haptics/proxy/proxy.h"

namespace sparsha::haptics {

/// What carries over from tick to tick.
struct AroundState {
  std::uint32_t sheet = kNoSheet;                        ///< that the proxy lies on; kNoSheet: it is free
  ProxyState proxy;                                      ///< local frame of `sheet`
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< object frame
  bool started = false;
  SeamFade seam;
  FreeHand free;
};

/// What one update found.
struct AroundUpdate {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< the proxy, and what is left of a seam
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();      ///< unit; zero when free
  double mu_dynamic = 0.0;
  double mu_static = 0.0;
  bool contact = false;
  bool sticking = false;
  bool unfinished = false;  ///< goes on next tick
  bool in_crease = false;   ///< held by two sheets at once, `sheet` is one of them
  bool released = false;    ///< the surface ended under the proxy: it is with the hand, which may be inside
  std::uint32_t sheet = kNoSheet;
  std::uint8_t cell_flags = 0;
  int hand_overs = 0;  ///< to sheets of the same surface
  int edges = 0;       ///< to sheets beyond a sharp edge
  int segments = 0;
};

/// Moves the proxy for a hand at `hip_m`. At the first call the proxy is the hand, wherever that is. A hand that is not
/// finite leaves the state as it was and reports no contact. A free proxy is the hand itself, to the last bit.
[[nodiscard]] AroundUpdate update_around(const ObjectSurface& object, const Eigen::Vector3d& hip_m, AroundState& state,
                                         const SolverOptions& options) noexcept;

}  // namespace sparsha::haptics
