#include "haptics/servo/haptic_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "haptics/state/vectors.h"

namespace sparsha::haptics {
namespace {

constexpr double kSlipFilter_s = 0.005;   // time constant of the published slip speed
constexpr double kFarthestHand_m = 10.0;  // no hand is so far from its device
constexpr double kSamePlace_m = 1e-9;

Eigen::Vector3d point_on(const MongeSurface& surface, const Eigen::Vector2d& centre_m) noexcept {
  const scene::Lattice& lattice = surface.lattice;
  const double z = surface.height(centre_m.x() - lattice.origin_m.x(), centre_m.y() - lattice.origin_m.y());
  return {centre_m.x(), centre_m.y(), lattice.origin_m.z() + z};
}

/// How much of `whole` is in `part`, along it, 0 to 1; 1 of nothing.
double share_of(const Eigen::Vector3d& part, const Eigen::Vector3d& whole) noexcept {
  const double squared = whole.squaredNorm();
  return squared > 0.0 ? std::clamp(part.dot(whole) / squared, 0.0, 1.0) : 1.0;
}

}  // namespace

HapticRenderer::HapticRenderer(const DeviceInfo& device, const RendererOptions& options, HapticWindow window)
    : device_(device),
      options_(options),
      window_(std::move(window)),
      surface_(window_.surface.get()),
      centre_m_(point_on(*surface_, surface_->centre_m.head<2>())),
      wish_n_per_m_(options.stiffness_n_per_m),
      stiffness_n_per_m_(0.0),
      governor_(device.limits) {
  record_.state.centre_m = to_array(centre_m_);
  record_.state.scale = surface_->scale;
}

ProxyUpdate HapticRenderer::solve(const Eigen::Vector3d& hip_local, ProxyState& proxy) const noexcept {
  return options_.solver == scene::HapticsConfig::Solver::paper
             ? update_paper(*surface_, hip_local, proxy, options_.solver_options)
             : update_exact(*surface_, hip_local, proxy, options_.solver_options);
}

CellShape HapticRenderer::shape() const noexcept {
  return options_.solver == scene::HapticsConfig::Solver::paper ? CellShape::bilinear : options_.solver_options.shape;
}

// Cell flags at the proxy and nearness to the window's border; the cell goes into the record.
std::uint64_t HapticRenderer::find_place(const Eigen::Vector3d& local) noexcept {
  const scene::Lattice& lattice = surface_->lattice;
  const double u = local.x() / lattice.spacing_m;
  const double v = local.y() / lattice.spacing_m;
  const double last_u = lattice.nx - 1;
  const double last_v = lattice.ny - 1;
  std::uint64_t flags = 0;
  if (!(u > 1.0 && v > 1.0 && u < last_u - 1.0 && v < last_v - 1.0)) flags |= kFlagWindowBorder;
  const double end_u = window_.level_nx > 0 ? window_.level_nx - 1 : last_u;
  const double end_v = window_.level_ny > 0 ? window_.level_ny - 1 : last_v;
  if (u + window_.i0 < 0.0 || v + window_.j0 < 0.0 || u + window_.i0 > end_u || v + window_.j0 > end_v)
    flags |= kFlagOutside;
  const int i = static_cast<int>(std::clamp(u, 0.0, last_u - 1.0));
  const int j = static_cast<int>(std::clamp(v, 0.0, last_v - 1.0));
  record_.cell_i = window_.i0 + i;
  record_.cell_j = window_.j0 + j;
  record_.cell_m = lattice.spacing_m;
  const std::size_t cell =
      static_cast<std::size_t>(j) * static_cast<std::size_t>(lattice.nx - 1) + static_cast<std::size_t>(i);
  const unsigned cell_flags = surface_->cell_flags.empty() ? 0U : surface_->cell_flags[cell];
  if ((cell_flags & kCellFilled) != 0) flags |= kFlagFilledArea;
  if ((cell_flags & kCellUnknown) != 0) flags |= kFlagUnknownArea;
  if ((cell_flags & kCellOutside) != 0) flags |= kFlagOutside;
  return flags;
}

// The hand and the surface under it keep their places in the device frame, so that a swap is not felt as a step:
// c' = g_p - d_p / scale' across, and along z the new surface comes to where the old one was (ALGORITHMS "Pyramid and
// window"). The rest of the way the proxy slides, and the force fades to its new value.
void HapticRenderer::swap(Command& command) noexcept {
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
  guided_at_m_ = centre_m_.head<2>();
  if (!placed_) {
    centre_m_ = point_on(fresh, centre_m_.head<2>());
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

SurfacePointer HapticRenderer::apply(Command& command) noexcept {
  SurfacePointer retired;
  switch (command.kind) {
    case Command::Kind::swap:
      swap(command);
      retired = std::move(command.window.surface);
      break;
    case Command::Kind::scroll:
      scroll_m_per_s_ = command.scroll_m_per_s.allFinite() ? command.scroll_m_per_s : Eigen::Vector3d::Zero();
      break;
    case Command::Kind::stiffness:
      wish_n_per_m_ = command.stiffness_n_per_m;
      break;
    case Command::Kind::guide:
      guidance_.set(std::move(command.guide));
      break;
    case Command::Kind::drag:
      letting_go_ = dragging_ && !command.on;
      if (command.on) set_dragging(true);
      break;
  }
  record_.state.command = command.sequence;
  return retired;
}

bool HapticRenderer::is_place(const DeviceSample& sample) noexcept {
  return sample.position_m.allFinite() && sample.position_m.cwiseAbs().maxCoeff() < kFarthestHand_m;
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
  centre_m_.head<2>() -= (hand_m - hand_m_).head<2>() / surface_->scale;
  const scene::Lattice& lattice = surface_->lattice;
  const Eigen::Vector2d low = lattice.origin_m.head<2>() - Eigen::Vector2d(window_.i0, window_.j0) * lattice.spacing_m;
  const Eigen::Vector2d nodes(window_.level_nx > 0 ? window_.level_nx : lattice.nx,
                              window_.level_ny > 0 ? window_.level_ny : lattice.ny);
  const Eigen::Vector2d high = low + (nodes - Eigen::Vector2d::Ones()) * lattice.spacing_m;
  centre_m_.head<2>() = centre_m_.head<2>().cwiseMax(low).cwiseMin(high);
}

// The stone comes back where the hand is in the air; a hand that would be inside lies on the surface.
void HapticRenderer::let_go(const Eigen::Vector3d& hand_m) noexcept {
  const Eigen::Vector3d hip_local = centre_m_ + hand_m / surface_->scale - surface_->lattice.origin_m;
  const double height = touched_height(*surface_, hip_local.x(), hip_local.y(), shape());
  centre_m_.z() += std::max(0.0, height - hip_local.z());
  set_dragging(false);
}

// A position that cannot be used: no force, no rendering, and no force again before the hand has been in free space.
void HapticRenderer::render_invalid_sample(const DeviceSample& sample) noexcept {
  make_safe();
  State& state = record_.state;
  state.force_n = {};
  state.normal = {};
  state.penetration_m = 0.0;
  state.slip_speed_m_per_s = 0.0;
  state.friction_coefficient = 0.0;
  state.contact = 0;
  if (!placed_) {
    state.hip_m = to_array(centre_m_ + hand_m_ / surface_->scale);
    state.proxy_m = state.hip_m;
    state.place_m = place_of(centre_m_ + hand_m_ / surface_->scale);
  }
  if (!sample.fresh) state.flags |= kFlagStale;
}

std::array<double, 3> HapticRenderer::place_of(const Eigen::Vector3d& grid_m) const noexcept {
  if (!window_.turned) return to_array(grid_m);
  const scene::RegionFrame& frame = window_.region_from_grid;
  return to_array(frame.leftCols<3>() * grid_m + frame.col(3));
}

void HapticRenderer::make_safe() noexcept {
  fade_.end();
  effects_.reset();
  guidance_.interrupt();
  armed_ = false;
  record_.state.guide_n = {};
  record_.state.guide_stored_j = record_.state.guide_supplied_j = 0.0;
  felt_n_.setZero();
  governor_.stop();
  events_.reset();
  record_.state.commanded_force_n = {};
  record_.state.given_share = 0.0;
  record_.state.flags &= ~static_cast<std::uint64_t>(kFlagSaturated | kFlagArmed);
}

void HapticRenderer::fail() noexcept {
  State& state = record_.state;
  if ((state.flags & kFlagFault) != 0) return;
  state.flags |= kFlagFault;
  ++faults_;
  make_safe();
  event_.reset();
}

// The rendered force, or what a swap has left of the one before it: then as a spring to where that force stands.
GovernorInput HapticRenderer::governor_input(const DeviceSample& sample, const Eigen::Vector3d& away_m,
                                             const Eigen::Vector3d& force_n) noexcept {
  GovernorInput input;
  input.force_n = force_n;
  input.position_m = hand_m_;
  input.proxy_m = hand_m_ + away_m;
  input.normal = found_.normal;
  input.stiffness_n_per_m = stiffness_n_per_m_;
  input.delay_s = sample.delay_s;
  const double depth_m = away_m.norm();
  input.spring_energy_j = 0.5 * stiffness_n_per_m_ * depth_m * depth_m;
  input.period_s = record_.period_s;
  input.nominal_period_s = record_.nominal_period_s;
  input.fresh = sample.fresh;
  input.contact = found_.contact;
  felt_n_ = force_n;
  if (!fade_.active()) return input;
  felt_n_ = fade_.apply(force_n, hand_m_, stiffness_n_per_m_, step_s());
  const double felt = felt_n_.norm();
  if (!(felt > 0.0 && stiffness_n_per_m_ > 0.0)) return input;
  input.force_n = felt_n_;
  input.proxy_m = hand_m_ + felt_n_ / stiffness_n_per_m_;
  input.spring_energy_j = 0.5 * felt * felt / stiffness_n_per_m_;
  input.normal = found_.contact ? found_.normal : Eigen::Vector3d(felt_n_ / felt);
  input.contact = true;
  return input;
}

// Impact and grain, on top of what the surface gives.
void HapticRenderer::add_effects(GovernorInput& input, const Eigen::Vector3d& moved_m) noexcept {
  const SurfaceEffects* effects = surface_->effects.get();
  EffectForces::Input tick;
  tick.period_s = record_.period_s;
  tick.pace_s = pace_s_;
  tick.hand_m = hand_m_;
  tick.place_m = to_vector(record_.state.place_m);
  tick.moved_m = moved_m;
  tick.normal = found_.normal;
  tick.force_n = input.force_n;
  tick.delay_ticks = static_cast<std::size_t>(std::max(0, device_.limits.delay_ticks));
  tick.contact = found_.contact;
  tick.time_s = record_.state.time_s;
  tick.scale = surface_->scale;
  tick.outside = (place_flags_ & kFlagOutside) != 0;
  tick.unknown = (place_flags_ & kFlagUnknownArea) != 0;
  tick.touch = event_ && event_->kind == ContactEvent::Kind::touch;
  if (tick.touch) tick.approach_m_per_s = event_->normal_speed_m_per_s;
  const EffectForces::Output added = effects_.update(tick, effects);
  if (effects == nullptr) return;
  input.force_n += added.force_n;
  input.spring_energy_j += added.stored_j;
}

// The user's, or that of the part under the hand.
double HapticRenderer::wished_stiffness() noexcept {
  const SurfaceEffects* effects = surface_->effects.get();
  if (!placed_ || effects == nullptr || !effects->has_stiffness()) return wish_n_per_m_;
  const double share = options_.stiffness_n_per_m > 0.0 ? wish_n_per_m_ / options_.stiffness_n_per_m : 0.0;
  return effects_.stiffness(wish_n_per_m_, share, to_vector(record_.state.place_m), *effects);
}

void HapticRenderer::render(const DeviceSample& sample) noexcept {
  State& state = record_.state;
  const scene::Lattice& lattice = surface_->lattice;
  // In the grid frame first: `trace` starts from the same number.
  const Eigen::Vector3d hip_m = centre_m_ + hand_m_ / surface_->scale;
  const Eigen::Vector3d hip_local = hip_m - lattice.origin_m;
  if (!placed_) {
    proxy_ = start_proxy(*surface_, hip_local);
    placed_ = true;
  }
  if (dragging_ || dragged_) {  // the hand was in the air all the while
    proxy_ = {};
    proxy_.position = hip_local;
  }
  dragged_ = dragging_;
  const Eigen::Vector3d before = proxy_.position;
  found_ = dragging_ ? ProxyUpdate{.position = hip_local} : solve(hip_local, proxy_);
  const Eigen::Vector3d away = found_.contact ? Eigen::Vector3d(found_.position - hip_local) : Eigen::Vector3d::Zero();
  const Eigen::Vector3d force_n = stiffness_n_per_m_ * surface_->scale * away;
  // A free proxy is the hand itself, to the last bit.
  const Eigen::Vector3d proxy_m =
      found_.position == hip_local ? hip_m : Eigen::Vector3d(found_.position + lattice.origin_m);

  state.penetration_m = surface_->scale * away.norm();
  state.hip_m = to_array(hip_m);
  state.proxy_m = to_array(proxy_m);
  state.normal = to_array(found_.normal);
  state.force_n = to_array(force_n);
  state.friction_coefficient = found_.mu_dynamic;
  state.contact = found_.contact ? 1 : 0;
  const std::array<double, 3> touched_m = touched_place(state);
  state.place_m = place_of({touched_m[0], touched_m[1], touched_m[2]});

  ContactEvents::Input contact;
  contact.time_s = sample.time_s;
  contact.hand_m = hand_m_;
  contact.proxy_m = proxy_m;
  contact.place_m = state.place_m;
  contact.normal = found_.normal;
  contact.stiffness_n_per_m = stiffness_n_per_m_;
  contact.encoder_step_m = governor_.encoder_step_m();
  contact.level = static_cast<std::uint64_t>(surface_->level);
  contact.contact = found_.contact;
  contact.sticking = found_.sticking;
  if (sample.fresh) event_ = events_.update(contact);  // a stale place says nothing about speed

  const Eigen::Vector3d moved_m =
      found_.contact ? Eigen::Vector3d(surface_->scale * (found_.position - before)) : Eigen::Vector3d::Zero();
  GovernorInput input = governor_input(sample, surface_->scale * away, force_n);
  add_effects(input, moved_m);
  add_guide(input, hip_m, sample.fresh);
  state.cues = effects_.cues().counts();
  state.away_m = away_m(hip_m);
  const GovernorOutput output = governor_.update(input);
  armed_ = output.armed;
  // A swap's fade takes from the surface's force, the governor from the whole.
  state.given_share = share_of(felt_n_, force_n) * share_of(output.force_n, input.force_n);
  if (event_ && !output.armed) event_->peak_force_n = 0.0;

  const double travel_m = found_.contact ? surface_->scale * (found_.position - before).norm() : 0.0;
  slip_speed_ += (travel_m / record_.period_s - slip_speed_) * std::min(1.0, record_.period_s / kSlipFilter_s);
  state.slip_speed_m_per_s = found_.contact ? slip_speed_ : 0.0;
  state.commanded_force_n = to_array(output.force_n);
  place_flags_ = find_place(found_.position);
  state.flags |= place_flags_;
  if (found_.sticking) state.flags |= kFlagSticking;
  if (found_.unfinished) state.flags |= kFlagUnfinished;
  if (output.saturated) state.flags |= kFlagSaturated;
  if (output.armed) state.flags |= kFlagArmed;
  if (!sample.fresh) state.flags |= kFlagStale;
}

// Ticks that were missed do not let the window jump.
void HapticRenderer::scroll() noexcept {
  Eigen::Vector3d step = scroll_m_per_s_ * step_s();
  if (proxy_.contact) step.z() = std::max(0.0, step.z());  // the window never presses the hand into the stone
  centre_m_ += step;
}

void HapticRenderer::update(const DeviceSample& sample, double nominal_period_s) noexcept {
  record_.nominal_period_s = nominal_period_s;
  record_.period_s = nominal_period_s;
  if (std::isfinite(sample.time_s)) {
    if (has_time_ && sample.time_s > last_time_s_) record_.period_s = sample.time_s - last_time_s_;
    has_time_ = true;
    last_time_s_ = sample.time_s;
  }
  pace_s_ = governor_.pace_s(nominal_period_s);
  if (!swapped_ && !dragging_) scroll();
  if (dragging_ && placed_ && sample.homed && is_place(sample)) {
    drag(sample.position_m);
    if (letting_go_) let_go(sample.position_m);
  }
  stiffness_n_per_m_ = governor_.stiffness(wished_stiffness(), nominal_period_s);
  const bool fault = std::exchange(fault_, false) || record_.period_s > nominal_period_s + options_.longest_gap_s;
  tick(sample, fault);
}

void HapticRenderer::replay(const DeviceSample& sample, const RecordedTick& recorded) noexcept {
  set_dragging((recorded.flags & kFlagDragged) != 0);
  centre_m_ = recorded.centre_m;
  stiffness_n_per_m_ = recorded.stiffness_n_per_m;
  record_.period_s = recorded.period_s;
  record_.nominal_period_s = recorded.nominal_period_s;
  pace_s_ = governor_.pace_s(recorded.nominal_period_s);
  recorded_guide_ = Guidance::Output{recorded.guide_n, recorded.guide_stored_j, recorded.guide_supplied_j};
  record_.state.command = recorded.command;
  record_.state.flags = recorded.flags & static_cast<std::uint64_t>(kFlagRealTime);
  CellShape& shape = options_.solver_options.shape;
  if (shape != CellShape::c1) shape = (recorded.flags & kFlagRounded) != 0 ? CellShape::rounded : CellShape::bilinear;
  tick(sample, (recorded.flags & kFlagFault) != 0);
}

// What is known of a tick before anything is rendered.
void HapticRenderer::describe_tick(const DeviceSample& sample) noexcept {
  State& state = record_.state;
  ++state.tick;
  state.time_s = sample.time_s;
  for (std::size_t button = 0; button < state.button_presses.size(); ++button)
    state.button_presses[button] += (sample.buttons & ~state.buttons) >> button & 1U;
  state.buttons = sample.buttons;
  state.level = static_cast<std::uint64_t>(surface_->level);
  state.surface_id = window_.id;
  state.scene = window_.scene;
  state.scale = surface_->scale;
  state.centre_m = to_array(centre_m_);
  state.flags &= static_cast<std::uint64_t>(kFlagRealTime);
  if (sample.homed) state.flags |= kFlagHomed;
  if (window_.effects.texture) state.flags |= kFlagTexture;
  if (window_.effects.friction) state.flags |= kFlagFriction;
  if (shape() == CellShape::rounded) state.flags |= kFlagRounded;
  if (surface_->beyond != scene::HapticsConfig::Beyond::continued) state.flags |= kFlagFalls;
  if (surface_->beyond == scene::HapticsConfig::Beyond::rim) state.flags |= kFlagRim;
  if (dragging_) state.flags |= kFlagDragged;
  if (surface_->effects && surface_->effects->impact) state.flags |= kFlagImpact;
  if (surface_->effects && surface_->effects->grain) state.flags |= kFlagGrain;
  if (surface_->effects && surface_->effects->cues) state.flags |= kFlagCues;
  state.workspace_m = device_.workspace_width_m;
  state.stiffness_n_per_m = stiffness_n_per_m_;
  state.stiffness_limit_n_per_m = governor_.limit_n_per_m();
  state.tip_radius_m = surface_->tip_radius_m;
  state.window = {window_.i0, window_.j0, surface_->lattice.nx, surface_->lattice.ny};
}

void HapticRenderer::rehearse() const noexcept {
  if (!placed_) return;
  const Eigen::Vector3d hip_local = centre_m_ + hand_m_ / surface_->scale - surface_->lattice.origin_m;
  ProxyState proxy = proxy_;
  const ProxyUpdate found = solve(hip_local, proxy);
  GovernorInput input;
  input.position_m = hand_m_;
  input.contact = found.contact;
  input.normal = found.normal;
  if (found.contact) input.force_n = stiffness_n_per_m_ * surface_->scale * (found.position - hip_local);
  input.proxy_m = hand_m_ + input.force_n / std::max(stiffness_n_per_m_, 1.0);
  input.stiffness_n_per_m = stiffness_n_per_m_;
  input.period_s = record_.nominal_period_s;
  input.nominal_period_s = record_.nominal_period_s;
  Governor governor = governor_;
  static_cast<void>(governor.stiffness(wish_n_per_m_, record_.nominal_period_s));
  static_cast<void>(governor.update(input));
}

void HapticRenderer::tick(const DeviceSample& sample, bool fault) noexcept {
  State& state = record_.state;
  event_.reset();
  swapped_ = false;
  record_.raw_device_m = to_array(sample.position_m);
  describe_tick(sample);

  const bool finite = is_place(sample);
  if (finite)
    hand_m_ = sample.position_m;
  else
    ++bad_positions_;
  state.device_m = to_array(hand_m_);
  fault = fault || !finite || !sample.connected;
  if (fault && sample.homed) {
    state.flags |= kFlagFault;
    ++faults_;
  }
  if (!sample.homed) {
    // Counts from power-up say nothing: not even the renderer may use them, and the proxy starts anew after homing.
    placed_ = false;
    render_invalid_sample(sample);
  } else if (!finite) {
    render_invalid_sample(sample);
  } else {
    render(sample);
    stale_s_ = sample.fresh ? 0.0 : stale_s_ + record_.period_s;
    if (stale_s_ > std::max(options_.longest_gap_s, kLongestGapTicks * pace_s_)) make_safe();
    if (fault) {
      make_safe();
      event_.reset();
    }
  }
}

}  // namespace sparsha::haptics
