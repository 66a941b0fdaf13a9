// Turns the tick-by-tick contact into events: touch with the predicted strike, lift, slip.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "haptics/governor/adaptive_velocity.h"
#include "haptics/state/state.h"

namespace sparsha::haptics {

/// Servo thread only; no allocation. Positions in the device frame.
class ContactEvents {
 public:
  /// `hand_mass_kg`: what strikes, for the predicted peak force v_n sqrt(k m) of a spring that stops a mass.
  explicit ContactEvents(double hand_mass_kg = 0.15) noexcept : hand_mass_kg_(hand_mass_kg) {}

  struct Input {
    double time_s = 0.0;
    Eigen::Vector3d hand_m = Eigen::Vector3d::Zero();   ///< device frame
    Eigen::Vector3d proxy_m = Eigen::Vector3d::Zero();  ///< grid frame
    std::array<double, 3> place_m{};                    ///< as State has it
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double stiffness_n_per_m = 0.0;
    double encoder_step_m = 0.0;  ///< 0 = not known yet
    std::uint64_t level = 0;
    bool contact = false;
    bool sticking = false;
  };
  /// At most one event per tick.
  [[nodiscard]] std::optional<ContactEvent> update(const Input& input) noexcept;
  /// Forgets the hand's way, e.g. after a fault; the next touch starts anew.
  void reset() noexcept { approach_.reset(); }

 private:
  double hand_mass_kg_;
  AdaptiveVelocity approach_;
  double approached_s_ = 0.0;  // when it got its last sample
  bool touching_ = false;      // between a touch and a lift event
  bool was_sticking_ = false;
  double last_contact_s_ = 0.0;
  double last_slip_s_ = -1.0;
  Eigen::Vector3d last_proxy_m_ = Eigen::Vector3d::Zero();
  std::array<double, 3> last_place_m_{};
};

}  // namespace sparsha::haptics
