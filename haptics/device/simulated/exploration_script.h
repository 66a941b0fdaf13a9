// What the simulated person intends: rounds of free space, approach, press, stroke and lift, drawn from a seed.
// Guided by the force felt, as a person is, so that it finds and follows any surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace sparsha::haptics {

/// A place to visit, device frame, metres.
struct TourStop {
  enum class Kind {
    strike,  ///< down fast, up as soon as something is felt
    stroke,  ///< press, and slide to `to_m`
  };
  Kind kind = Kind::strike;
  Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d to_m = Eigen::Vector2d::Zero();  ///< stroke
  std::uint64_t buttons = 0;                       ///< pressed in the middle of a stroke, for a tenth of a second
};

/// Device frame. Deterministic for a seed and a history of felt forces; no allocation, no exceptions.
class ExplorationScript {
 public:
  /// The stops of `tour` come first, in their order; then rounds by chance.
  ExplorationScript(std::uint64_t seed, double workspace_width_m, std::vector<TourStop> tour = {});

  enum class Phase { hover, approach, strike, press, stroke, lift };

  /// The intended position after `dt_s`, given what the hand feels now and where it is.
  [[nodiscard]] const Eigen::Vector3d& advance(const Eigen::Vector3d& felt_force_n, const Eigen::Vector3d& hand_m,
                                               double dt_s) noexcept;
  [[nodiscard]] const Eigen::Vector3d& target_m() const noexcept { return target_m_; }
  [[nodiscard]] Phase phase() const noexcept { return phase_; }
  /// Buttons that are held down now.
  [[nodiscard]] std::uint64_t buttons() const noexcept;

 private:
  void enter(Phase phase) noexcept;
  [[nodiscard]] double uniform(double low, double high) noexcept;
  void hover(double dt_s) noexcept;
  void steer(double dt_s) noexcept;
  void regulate(const Eigen::Vector3d& felt_force_n, double dt_s) noexcept;
  /// Null when the tour is over.
  [[nodiscard]] const TourStop* stop() const noexcept { return next_ < tour_.size() ? &tour_[next_] : nullptr; }

  std::vector<TourStop> tour_;
  std::size_t next_ = 0;
  std::uint64_t random_;
  double radius_m_;  // of the area that is stroked
  Phase phase_ = Phase::hover;
  Eigen::Vector3d target_m_;
  double phase_s_ = 0.0;
  double phase_length_s_ = 0.0;
  Eigen::Vector3d goal_m_;
  double wanted_force_n_ = 1.0;
  double speed_ = 0.05;
  double heading_rad_ = 0.0;
  double turn_rad_per_s_ = 0.0;
};

}  // namespace sparsha::haptics
