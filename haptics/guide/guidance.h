// Leads a hand along a line, for one tick: soft walls beside the line, and a force along it that draws the hand on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include <Eigen/Core>

#include "haptics/guide/guide_path.h"
#include "haptics/state/state.h"

namespace sparsha::haptics {

/// Servo thread only; no allocation, no exceptions. Places are in the grid frame; forces, speeds and distances are the
/// hand's size, along the axes of the grid frame. Across one view all are across the stone and have z = 0; on a whole
/// object they lie in the plane that touches the stone at the hand's place on the line.
///
/// The hand's place on the line is the nearest one, followed from tick to tick, so that no neck and no neighbouring
/// line is jumped. Across the line a spring holds the hand; it reaches the guide's force 2 mm away. Along it a spring
/// is wound up by what leads, at the guide's speed and never further than the guide's force; it pushes towards the line
/// ahead, up to the next sharp turn. The sum is never stronger than the guide's force. A hand that is taken up away
/// from the line feels no step: the walls stand at its place first and close in with the guide's speed.
class Guidance {
 public:
  struct Input {
    Eigen::Vector3d hand_m = Eigen::Vector3d::Zero();            ///< of one view with z = 0
    Eigen::Vector3d velocity_m_per_s = Eigen::Vector3d::Zero();  ///< of the hand
    Eigen::Vector3d scrolled_m = Eigen::Vector3d::Zero();        ///< of the stone under the hand since the last tick
    double scale = 1.0;                                          ///< device metres per grid metre
    double height_m = 0.0;           ///< of the hand above the stone, at the hand; not read on whole objects
    double stiffness_n_per_m = 0.0;  ///< of no spring may be more
    double step_s = 0.001;           ///< since the last tick, at most the planned period
  };
  struct Output {
    Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
    double stored_j = 0.0;    ///< in the springs
    double supplied_j = 0.0;  ///< put into them in this tick: at most force times speed times its length
  };

  /// Null: no guide. The first time the hand is taken up from further away than afterwards.
  void set(std::shared_ptr<const Guide> guide) noexcept;
  /// No force; near the line the hand is taken up anew. After faults and changes of the view.
  void interrupt() noexcept;

  [[nodiscard]] Output update(const Input& input) noexcept;

  [[nodiscard]] GuidePhase phase() const noexcept { return phase_; }
  [[nodiscard]] std::uint64_t rounds() const noexcept { return rounds_; }

 private:
  /// From the hand to a place of the line.
  struct Offset {
    Eigen::Vector3d across_m = Eigen::Vector3d::Zero();
    double height_m = 0.0;  ///< of the hand above the stone
  };
  [[nodiscard]] Offset offset(const Input& input, const GuidePath::Place& place) const noexcept;
  void look_for_line(const Input& input) noexcept;
  void take_up(const GuidePath::Place& place, double distance_m) noexcept;
  [[nodiscard]] bool leaves(double step_s, double height_m, double beyond_m, double across_n) noexcept;
  void let_go() noexcept;
  void follow(const Input& input) noexcept;
  void turn_at_end() noexcept;
  [[nodiscard]] bool neighbour(std::size_t piece, int step, std::size_t& next) const noexcept;
  [[nodiscard]] Eigen::Vector3d way_ahead(double reach_m, double& room_m) const noexcept;
  [[nodiscard]] Output lead(const Input& input) noexcept;

  std::shared_ptr<const Guide> guide_;
  GuidePhase phase_ = GuidePhase::off;
  bool asked_ = false;         // not taken up since it was asked for
  double let_go_s_ = 0.0;      // since then
  std::size_t looked_at_ = 0;  // pieces of this round of looking
  GuidePath::Place nearest_;   // of these
  double nearest_m_ = 0.0;
  GuidePath::Place place_;
  double direction_ = 1.0;  // along the line, or against it
  double walls_m_ = 0.0;    // from the line
  double lead_m_ = 0.0;     // of what leads, ahead of the hand
  double share_ = 0.0;      // of the force; rises after the hand was taken up, falls after it was let go
  double strained_s_ = 0.0;
  double travelled_m_ = 0.0;  // grid frame, since the last round
  std::uint64_t rounds_ = 0;
};

}  // namespace sparsha::haptics
