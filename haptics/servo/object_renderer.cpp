// A tick on a whole object, and how it is turned, moved and exchanged under the hand.
#include <algorithm>
#include <cmath>
#include <utility>

#include "haptics/servo/haptic_renderer.h"
#include "haptics/state/vectors.h"

namespace sparsha::haptics {
namespace {

constexpr double kClearCells = 1.0;  // of a hand from the surface that an object was placed with

Eigen::Vector3d middle_of(const ObjectSurface& object) noexcept { return object.origin_m + object.box_m.center(); }

/// Has a place of the proxy on one of them the same meaning on the other?
bool same_object(const ObjectSurface& a, const ObjectSurface& b) noexcept {
  return &a == &b || (a.charts != nullptr && a.charts == b.charts);
}

bool is_turn(const Eigen::Quaterniond& turn) noexcept { return turn.coeffs().allFinite() && turn.norm() > 0.5; }

}  // namespace

Eigen::Vector3d HapticRenderer::hip_on_object_m(const Eigen::Vector3d& hand_m) const noexcept {
  return centre_m_ + object_.to_grid(hand_m) / surface_->scale;
}

HapticRenderer::Touched HapticRenderer::touch_object() noexcept {
  const ObjectSurface& object = *window_.object;
  Touched touched;
  touched.hip_m = hip_on_object_m(hand_m_);
  const Eigen::Vector3d hip_m = touched.hip_m - object.origin_m;
  placed_ = true;
  if (dragging_ || dragged_) object_.let_go();  // the hand was in the air all the while
  dragged_ = dragging_;
  const Eigen::Vector3d before_m = object_.started() ? object_.felt_m() : hip_m;
  around_ = {};
  around_.position_m = hip_m;
  if (!dragging_) around_ = object_.update(object, hip_m, options_.solver_options);

  found_ = {};
  found_.position = around_.position_m;
  found_.normal = object_.to_device(around_.normal);
  found_.mu_dynamic = around_.mu_dynamic;
  found_.mu_static = around_.mu_static;
  found_.contact = around_.contact;
  found_.sticking = around_.sticking;
  found_.unfinished = around_.unfinished;
  found_.segments = around_.segments;
  found_.cell_flags = around_.cell_flags;

  touched.proxy_m = around_.position_m == hip_m ? touched.hip_m : Eigen::Vector3d(around_.position_m + object.origin_m);
  touched.away = Eigen::Vector3d::Zero();
  if (around_.contact) touched.away = object_.to_device(around_.position_m - hip_m);
  touched.travelled = object_.to_device(around_.position_m - before_m);
  touched.normal = around_.normal;
  return touched;
}

std::uint64_t HapticRenderer::find_place_on_object() noexcept {
  record_.cell_m = window_.object->spacing_m;
  if (!around_.contact) return 0;
  const SheetSurface& sheet = window_.object->sheets[around_.sheet];
  const auto [i, j] = recorded_cell(sheet, around_.position_m, window_.object->spacing_m);
  record_.cell_i = i;
  record_.cell_j = j;
  std::uint64_t flags = 0;
  if ((around_.cell_flags & kCellFilled) != 0) flags |= kFlagFilledArea;
  if ((around_.cell_flags & kCellUnknown) != 0) flags |= kFlagUnknownArea;
  return flags;
}

void HapticRenderer::rehearse_object() const noexcept {
  if (!object_.started()) return;
  const Eigen::Vector3d hip_m = hip_on_object_m(hand_m_) - window_.object->origin_m;
  ObjectHand object = object_;
  const AroundUpdate around = object.update(*window_.object, hip_m, options_.solver_options);
  ProxyUpdate found;
  found.contact = around.contact;
  found.normal = object_.to_device(around.normal);
  govern_once_more(found, object_.to_device(around.position_m - hip_m));
}

// What was felt fades, and the proxy is the hand again.
void HapticRenderer::release() noexcept {
  fade_.begin(felt_n_, Eigen::Vector3d::Zero(), hand_m_, std::max(stiffness_n_per_m_, 1.0));
  object_.let_go();
  effects_.swap();
  guidance_.interrupt();
  placed_anew_ = true;
}

// The object is let go of, turned about its middle, as far as that is in the workspace, and comes back with what is
// before the middle of the workspace there, as one view does, and with the hand in the air before it.
void HapticRenderer::place_object(const Eigen::Vector3d& hand_m) noexcept {
  release();
  const Placement placement = placement_.value_or(Placement{});
  placement_.reset();
  const ObjectSurface& object = *window_.object;
  if (placement.turn) {
    const double reach_m = 0.5 * device_.workspace_width_m / surface_->scale;
    const Eigen::Vector3d middle = object_.to_device(middle_of(object) - centre_m_);
    const Eigen::Vector3d pivot = middle.cwiseMax(-reach_m).cwiseMin(reach_m);
    const Eigen::Vector3d pivot_m = centre_m_ + object_.to_grid(pivot);
    object_.set_turn(*placement.turn);
    centre_m_ = pivot_m - object_.to_grid(pivot);
  }
  if (placement.centre_m) centre_m_ = *placement.centre_m;
  const Eigen::Vector3d towards = object_.to_grid(Eigen::Vector3d::UnitZ());
  if (placement.turn || placement.centre_m) {
    const Eigen::Vector3d middle_m = centre_m_ - object.origin_m;
    const double behind_m = object.box_m.diagonal().norm() + (middle_m - object.box_m.center()).norm();
    const double before_m = depth_behind_m(object, middle_m - behind_m * towards, towards, shape());
    if (before_m > 0.0) centre_m_ += (before_m - behind_m) * towards;
  }
  const double depth_m = depth_behind_m(object, hip_on_object_m(hand_m) - object.origin_m, towards, shape());
  if (depth_m > 0.0) centre_m_ += (depth_m + kClearCells * object.spacing_m) * towards;
}

void HapticRenderer::turn_object(const Eigen::Quaterniond& turn) noexcept {
  if (window_.object == nullptr || !is_turn(turn)) return;
  if (!placement_) placement_.emplace();
  placement_->turn = turn.normalized();
}

// Another view of the same object leaves the proxy's place under the hand. Else the object is placed anew.
void HapticRenderer::swap_object(Command& command) noexcept {
  const ObjectSurface* const old = window_.object;
  const double old_scale = surface_->scale;
  const Eigen::Vector3d held_m = old != nullptr && object_.started()
                                     ? Eigen::Vector3d(old->origin_m + object_.proxy_m())
                                     : hip_on_object_m(hand_m_);
  const Eigen::Vector3d held_device_m = old_scale * object_.to_device(held_m - centre_m_);
  swapped_ = true;
  std::swap(window_, command.window);  // the old surface leaves with the command
  surface_ = window_.surface.get();
  guidance_.interrupt();
  effects_.swap();
  // From one view of an object to another the step is a change of force like any other, and fades.
  if ((old != nullptr) != (window_.object != nullptr)) fade_.watch_always(window_.object != nullptr);
  if (window_.object == nullptr) return leave_object(command);
  const bool same = old != nullptr && same_object(*old, *window_.object);
  if (surface_->scale != old_scale) object_.rescale();
  if (same && !command.move && !command.on) {
    centre_m_ = held_m - object_.to_grid(held_device_m) / surface_->scale;
    return;
  }
  Placement placement = placement_.value_or(Placement{});
  if (!same) {
    object_.let_go();
    object_.set_turn(Eigen::Quaterniond::Identity());
    placement.turn.reset();
    centre_m_ = middle_of(*window_.object);
    placement.centre_m = centre_m_;
  }
  if (command.move && command.centre_m.allFinite()) {
    const double z_m = std::isfinite(command.centre_z_m) ? command.centre_z_m : centre_m_.z();
    placement.centre_m = {command.centre_m.x(), command.centre_m.y(), z_m};
  }
  if (command.on && is_turn(command.turn)) placement.turn = command.turn.normalized();
  placement_ = placement;
}

// From a whole object to one view: its stone comes where the hand is in the air, or lies on it.
void HapticRenderer::leave_object(const Command& command) noexcept {
  placement_.reset();
  object_.let_go();
  object_.set_turn(Eigen::Quaterniond::Identity());
  const bool placed = command.move && command.centre_m.allFinite();
  centre_m_ = point_on(placed ? command.centre_m : Eigen::Vector2d(surface_->centre_m.head<2>()));
  guided_at_m_ = centre_m_;
  proxy_ = {};
  if (!placed_) return;
  lift(hand_m_);
  dragged_ = true;
  fade_.begin(felt_n_, Eigen::Vector3d::Zero(), hand_m_, std::max(stiffness_n_per_m_, 1.0));
}

// The place of the object under the hand stays under it across the view, as far as the object reaches.
void HapticRenderer::drag_object(const Eigen::Vector3d& hand_m) noexcept {
  Eigen::Vector3d way_m = hand_m - hand_m_;
  way_m.z() = 0.0;
  const ObjectSurface& object = *window_.object;
  const Eigen::Vector3d low_m = object.origin_m + object.box_m.min();
  const Eigen::Vector3d high_m = object.origin_m + object.box_m.max();
  centre_m_ = (centre_m_ - object_.to_grid(way_m) / surface_->scale).cwiseMax(low_m).cwiseMin(high_m);
}

}  // namespace sparsha::haptics
