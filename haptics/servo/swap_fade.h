// From the force of the surface that was touched before a swap to that of the new one, so that a hand at rest feels
// neither a step nor a turn. Device frame; no allocation, no exceptions.
#pragma once

#include <Eigen/Core>

namespace sparsha::haptics {

/// While it fades the old surface goes on as a wall: the plane that the old force stood on, as deep under it as the
/// hand is. Old and new force are both springs of the same stiffness, and so is their mean: a hand that moves is
/// answered at once, and one that leaves both feels nothing.
class SwapFade {
 public:
  /// Would anybody feel a step from `old_n` to `fresh_n`?
  [[nodiscard]] static bool is_felt(const Eigen::Vector3d& old_n, const Eigen::Vector3d& fresh_n) noexcept;
  /// After a swap: `old_n` was felt last, `fresh_n` is the new surface's for the same hand. Begins anew while another
  /// fade runs: `old_n` is then a mean of the two before.
  void begin(const Eigen::Vector3d& old_n, const Eigen::Vector3d& fresh_n, const Eigen::Vector3d& hand_m,
             double stiffness_n_per_m) noexcept;
  void end() noexcept { active_ = watching_ = knows_ = false; }
  /// From now on every change of force that the hand's motion does not explain fades in, not only those after a swap: a
  /// whole object has edges, and ends.
  void watch_always(bool on) noexcept {
    always_ = on;
    knows_ = false;
  }
  /// Until the hand has settled on the new surface; apply() changes nothing otherwise.
  [[nodiscard]] bool active() const noexcept { return watching_ || always_; }

  /// The force of this tick from the new surface's. One step of the fade.
  [[nodiscard]] Eigen::Vector3d apply(const Eigen::Vector3d& fresh_n, const Eigen::Vector3d& hand_m,
                                      double stiffness_n_per_m, double period_s) noexcept;

 private:
  void fade(const Eigen::Vector3d& old_n, const Eigen::Vector3d& fresh_n, const Eigen::Vector3d& hand_m,
            double stiffness_n_per_m, double duration_s) noexcept;
  [[nodiscard]] Eigen::Vector3d mean(const Eigen::Vector3d& fresh_n, const Eigen::Vector3d& hand_m,
                                     double stiffness_n_per_m, double period_s) noexcept;
  [[nodiscard]] double step(const Eigen::Vector3d& old_n, const Eigen::Vector3d& way_n, double changed_n,
                            double travel_m, double period_s) const noexcept;

  /// Most that the hand's motion explains, in its stiffness, and what counts without any motion.
  struct Explained {
    double steepness;
    double still_n;
  };
  [[nodiscard]] bool jumps(const Eigen::Vector3d& fresh_n, const Eigen::Vector3d& hand_m, double stiffness_n_per_m,
                           const Explained& explained) const noexcept;

  bool always_ = false;
  bool knows_ = false;     // the last tick's force
  bool watching_ = false;  // for jumps of a hand that settles
  bool active_ = false;
  double since_swap_s_ = 0.0;
  double stiffness_n_per_m_ = 0.0;                     // of the last tick
  Eigen::Vector3d fresh_n_ = Eigen::Vector3d::Zero();  // likewise
  Eigen::Vector3d felt_n_ = Eigen::Vector3d::Zero();   // likewise
  double time_share_ = 0.0;                            // 0 to 1
  double duration_s_ = 0.0;
  double depth_m_ = 0.0;  // of the hand under the plane at the swap
  Eigen::Vector3d place_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d begun_m_ = Eigen::Vector3d::Zero();  // the hand at the swap
  Eigen::Vector3d last_m_ = Eigen::Vector3d::Zero();
};

}  // namespace sparsha::haptics
