// Where the window is: swaps, scrolling and dragging; of one view and of whole objects.
#include <algorithm>
#include <cmath>
#include <utility>

#include "haptics/servo/haptic_renderer.h"
#include "haptics/state/vectors.h"

namespace sparsha::haptics {
namespace {

constexpr double kSamePlace_m = 1e-9;

}  // namespace

Eigen::Vector3d HapticRenderer::point_on(const Eigen::Vector2d& centre_m) const noexcept {
  const scene::Lattice& lattice = surface_->lattice;
  const double z = surface_->height(centre_m.x() - lattice.origin_m.x(), centre_m.y() - lattice.origin_m.y());
  return {centre_m.x(), centre_m.y(), lattice.origin_m.z() + z};
}

// The hand and the surface under it keep their places in the device frame, so that a swap is not felt as a step:
// c' = g_p - d_p / scale' across, and along z the new surface comes to where the old one was (ALGORITHMS "Pyramid and
// window"). The rest of the way the proxy slides, and the force fades to its new value.
void HapticRenderer::swap(Command& command) noexcept {
  if (window_.object != nullptr || command.window.object != nullptr) return swap_object(command);
  const MongeSurface& old = *surface_;
  const Eigen::Vector3d proxy_grid_m = proxy_.position + old.lattice.origin_m;
  const Eigen::Vector3d proxy_device_m = (proxy_grid_m - centre_m_) * old.scale;
  const double below_m = proxy_.contact ? proxy_grid_m.z()
                                        : old.lattice.origin_m.z() +
                                              touched_height(old, proxy_.position.x(), proxy_.position.y(), shape());
  const double surface_device_m = (below_m - centre_m_.z()) * old.scale;
  const double old_scale = old.scale;
  const Eigen::Vector2d old_centre_m = centre_m_.head<2>();

  swapped_ = true;
  std::swap(window_, command.window);  // the old surface leaves with the command
  surface_ = window_.surface.get();
  const MongeSurface& fresh = *surface_;
  if (command.move && command.centre_m.allFinite())
    centre_m_.head<2>() = command.centre_m;
  else
    centre_m_.head<2>() = proxy_grid_m.head<2>() - proxy_device_m.head<2>() / fresh.scale;
  // Fresh tiles of the same view leave the hand where it is on the line; any other view does not.
  const double moved_m = fresh.scale * (centre_m_.head<2>() - old_centre_m).norm();
  if (fresh.scale != old_scale || moved_m > kSamePlace_m) guidance_.interrupt();
  guided_at_m_ = centre_m_;
  if (!placed_) {
    centre_m_ = point_on(centre_m_.head<2>());
    return;
  }
  const Eigen::Vector2d place = centre_m_.head<2>() + proxy_device_m.head<2>() / fresh.scale;
  const Eigen::Vector2d local = place - fresh.lattice.origin_m.head<2>();
  const double height = touched_height(fresh, local.x(), local.y(), shape());
  centre_m_.z() = fresh.lattice.origin_m.z() + height - surface_device_m / fresh.scale;
  const double z = centre_m_.z() + proxy_device_m.z() / fresh.scale - fresh.lattice.origin_m.z();
  move_proxy(proxy_, {local.x(), local.y(), proxy_.contact ? height : std::max(z, height)}, old_scale / fresh.scale);
  effects_.swap();
  if (!dragging_) begin_fade();
}

// What the new surface gives for the same hand tells how far the force is to go. Where it is another force, static
// friction holds no longer: a hand that breaks loose later feels a second step. The proxy stays where it is; the next
// tick finds its way, in a replay too.
void HapticRenderer::begin_fade() noexcept {
  const Eigen::Vector3d hip_local = centre_m_ + hand_m_ / surface_->scale - surface_->lattice.origin_m;
  const auto force_n = [&](ProxyState proxy) -> Eigen::Vector3d {
    const ProxyUpdate fresh = solve(hip_local, proxy);
    if (!fresh.contact) return Eigen::Vector3d::Zero();
    return stiffness_n_per_m_ * surface_->scale * (fresh.position - hip_local);
  };
  Eigen::Vector3d fresh_n = force_n(proxy_);
  if (proxy_.sticking && SwapFade::is_felt(felt_n_, fresh_n)) {
    proxy_.sticking = false;
    fresh_n = force_n(proxy_);
  }
  fade_.begin(felt_n_, fresh_n, hand_m_, stiffness_n_per_m_);
}

// What was felt fades, as after a swap.
void HapticRenderer::set_dragging(bool on) noexcept {
  if (on && !dragging_ && placed_)
    fade_.begin(felt_n_, Eigen::Vector3d::Zero(), hand_m_, std::max(stiffness_n_per_m_, 1.0));
  if (on) guidance_.interrupt();
  dragging_ = on;
  if (!on) letting_go_ = false;
}

// The place of the scene under the hand stays under it, as far as the level reaches.
void HapticRenderer::drag(const Eigen::Vector3d& hand_m) noexcept {
  if (window_.object != nullptr) return drag_object(hand_m);
  centre_m_.head<2>() -= (hand_m - hand_m_).head<2>() / surface_->scale;
  const scene::Lattice& lattice = surface_->lattice;
  const Eigen::Vector2d low = lattice.origin_m.head<2>() - Eigen::Vector2d(window_.i0, window_.j0) * lattice.spacing_m;
  const Eigen::Vector2d nodes(window_.level_nx > 0 ? window_.level_nx : lattice.nx,
                              window_.level_ny > 0 ? window_.level_ny : lattice.ny);
  const Eigen::Vector2d high = low + (nodes - Eigen::Vector2d::Ones()) * lattice.spacing_m;
  centre_m_.head<2>() = centre_m_.head<2>().cwiseMax(low).cwiseMin(high);
}

// A hand that would be inside lies on the surface.
void HapticRenderer::lift(const Eigen::Vector3d& hand_m) noexcept {
  const Eigen::Vector3d hip_local = centre_m_ + hand_m / surface_->scale - surface_->lattice.origin_m;
  const double height = touched_height(*surface_, hip_local.x(), hip_local.y(), shape());
  centre_m_.z() += std::max(0.0, height - hip_local.z());
}

// The stone comes back where the hand is in the air.
void HapticRenderer::let_go(const Eigen::Vector3d& hand_m) noexcept {
  if (window_.object != nullptr)
    place_object(hand_m);
  else
    lift(hand_m);
  set_dragging(false);
}

// Ticks that were missed do not let the window jump.
void HapticRenderer::scroll() noexcept {
  Eigen::Vector3d step = scroll_m_per_s_ * step_s();
  if (window_.object != nullptr) {
    const Eigen::Vector3d normal = to_vector(record_.state.normal);  // zero when free
    step -= std::min(0.0, step.dot(normal)) * normal;
  } else if (proxy_.contact) {
    step.z() = std::max(0.0, step.z());  // the window never presses the hand into the stone
  }
  centre_m_ += step;
}

}  // namespace sparsha::haptics
