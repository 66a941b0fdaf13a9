// What a hand intends that is told where to go and how hard to press: across towards the wanted place, down until it
// feels the stone, then along it by the force that it feels.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include <Eigen/Core>

namespace sparsha::haptics {

/// Where a steered hand is wanted; written by whoever steers, read by the device. Device frame.
struct SteeringSample {
  std::array<double, 2> wanted_m{};
  double speed_m_per_s = 0.04;  ///< across
  double press_n = 1.0;         ///< kept against the stone; 0: the hand stays in the air
  std::uint64_t armed = 0;      ///< 1: forces are delivered. Else the hand rises, because they come in free space alone
  std::uint64_t sequence = 0;   ///< counts samples; 0 = none yet
};
static_assert(std::is_trivially_copyable_v<SteeringSample>);

/// Device frame. Deterministic for its samples and the forces felt; no allocation, no exceptions.
class SteeringScript {
 public:
  /// The hand begins above the workspace's middle.
  explicit SteeringScript(double workspace_width_m);

  /// The intended position after `dt_s`, given what the hand feels now and where it is.
  [[nodiscard]] const Eigen::Vector3d& advance(const SteeringSample& wish, const Eigen::Vector3d& felt_force_n,
                                               const Eigen::Vector3d& hand_m, double dt_s) noexcept;
  [[nodiscard]] const Eigen::Vector3d& target_m() const noexcept { return target_m_; }

 private:
  void go_across(const SteeringSample& wish, double lateral_n, const Eigen::Vector3d& hand_m, double dt_s) noexcept;
  void go_down(const SteeringSample& wish, double up_n, double lateral_n, double hand_m, double dt_s) noexcept;

  double reach_m_;
  Eigen::Vector3d target_m_;
  double touched_m_;  // height of the hand when it last felt the stone
};

}  // namespace sparsha::haptics
