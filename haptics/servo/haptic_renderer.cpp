#include "haptics/servo/haptic_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "haptics/state/stone_gives.h"
#include "haptics/state/vectors.h"

namespace sparsha::haptics {
namespace {

constexpr double kSlipFilter_s = 0.005;   // time constant of the published slip speed
constexpr double kFarthestHand_m = 10.0;  // no hand is so far from its device

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
      centre_m_(point_on(surface_->centre_m.head<2>())),
      wish_n_per_m_(options.stiffness_n_per_m),
      stiffness_n_per_m_(0.0),
      governor_(device.limits),
      looks_(usable(device.limits).encoder_step_m) {
  if (window_.object != nullptr) {
    centre_m_ = window_.object->origin_m + window_.object->box_m.center();
    placement_ = Placement{std::nullopt, centre_m_};
    fade_.watch_always(true);
  }
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
    case Command::Kind::turn:
      turn_object(command.turn);
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
  input.repeated = repeated_;
  input.contact = found_.contact;
  input.gives_way = window_.object != nullptr;
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
  if (window_.object != nullptr) tick.device_from_grid = &object_.device_from_grid();
  tick.outside = (place_flags_ & kFlagOutside) != 0;
  tick.unknown = (place_flags_ & kFlagUnknownArea) != 0;
  tick.touch = event_ && event_->kind == ContactEvent::Kind::touch;
  if (tick.touch) tick.approach_m_per_s = event_->normal_speed_m_per_s;
  const EffectForces::Output added = effects_.update(tick, effects);
  if (effects == nullptr) return;
  input.force_n += added.force_n;
  input.effects_n = added.force_n;
  input.spring_energy_j += added.stored_j;
}

// The user's, or that of the part under the hand.
double HapticRenderer::wished_stiffness() noexcept {
  const SurfaceEffects* effects = surface_->effects.get();
  if (!placed_ || effects == nullptr || !effects->has_stiffness()) return wish_n_per_m_;
  const double share = options_.stiffness_n_per_m > 0.0 ? wish_n_per_m_ / options_.stiffness_n_per_m : 0.0;
  return effects_.stiffness(wish_n_per_m_, share, to_vector(record_.state.place_m), *effects);
}

HapticRenderer::Touched HapticRenderer::touch_view() noexcept {
  const scene::Lattice& lattice = surface_->lattice;
  Touched touched;
  // In the grid frame first: `trace` starts from the same number.
  touched.hip_m = centre_m_ + hand_m_ / surface_->scale;
  const Eigen::Vector3d hip_local = touched.hip_m - lattice.origin_m;
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
  touched.away = found_.contact ? Eigen::Vector3d(found_.position - hip_local) : Eigen::Vector3d::Zero();
  touched.travelled = found_.position - before;
  touched.normal = found_.normal;
  // A free proxy is the hand itself, to the last bit.
  touched.proxy_m = found_.position == hip_local ? touched.hip_m : Eigen::Vector3d(found_.position + lattice.origin_m);
  return touched;
}

void HapticRenderer::render(const DeviceSample& sample) noexcept {
  State& state = record_.state;
  const Touched touched = window_.object != nullptr ? touch_object() : touch_view();
  const Eigen::Vector3d force_n = stiffness_n_per_m_ * surface_->scale * touched.away;

  state.penetration_m = surface_->scale * touched.away.norm();
  state.hip_m = to_array(touched.hip_m);
  state.proxy_m = to_array(touched.proxy_m);
  state.normal = to_array(touched.normal);
  state.force_n = to_array(force_n);
  state.friction_coefficient = found_.mu_dynamic;
  state.contact = found_.contact ? 1 : 0;
  const std::array<double, 3> touched_m = touched_place(state);
  state.place_m = place_of({touched_m[0], touched_m[1], touched_m[2]});

  ContactEvents::Input contact;
  contact.time_s = sample.time_s;
  contact.hand_m = hand_m_;
  contact.proxy_m = touched.proxy_m;
  contact.place_m = state.place_m;
  contact.normal = found_.normal;
  contact.stiffness_n_per_m = stiffness_n_per_m_;
  contact.encoder_step_m = governor_.encoder_step_m();
  contact.level = static_cast<std::uint64_t>(surface_->level);
  contact.contact = found_.contact;
  contact.sticking = found_.sticking;
  const bool news = sample.fresh && !repeated_;
  if (news) event_ = events_.update(contact);  // a stale place says nothing about speed

  const Eigen::Vector3d moved_m =
      found_.contact ? Eigen::Vector3d(surface_->scale * touched.travelled) : Eigen::Vector3d::Zero();
  GovernorInput input = governor_input(sample, surface_->scale * touched.away, force_n);
  add_effects(input, moved_m);
  add_guide(input, touched.hip_m, news);
  state.cues = effects_.cues().counts();
  state.away_m = away_m(touched.hip_m);
  const GovernorOutput output = governor_.update(input);
  armed_ = output.armed;
  // A swap's fade takes from the surface's force, the governor from the whole.
  state.given_share = share_of(felt_n_, force_n) * share_of(output.force_n, input.force_n);
  if (event_ && !output.armed) event_->peak_force_n = 0.0;

  const double travel_m = found_.contact ? surface_->scale * touched.travelled.norm() : 0.0;
  slip_speed_ += (travel_m / record_.period_s - slip_speed_) * std::min(1.0, record_.period_s / kSlipFilter_s);
  state.slip_speed_m_per_s = found_.contact ? slip_speed_ : 0.0;
  state.commanded_force_n = to_array(output.force_n);
  place_flags_ = window_.object != nullptr ? find_place_on_object() : find_place(found_.position);
  state.flags |= place_flags_;
  if (found_.sticking) state.flags |= kFlagSticking;
  if (found_.unfinished) state.flags |= kFlagUnfinished;
  if (output.saturated) state.flags |= kFlagSaturated;
  if (output.armed) state.flags |= kFlagArmed;
  if (!sample.fresh) state.flags |= kFlagStale;
  if (repeated_) state.flags |= kFlagRepeated;
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
  const bool found_hand = sample.homed && is_place(sample);
  if (placement_ && found_hand)
    place_object(sample.position_m);
  else if (!swapped_ && !dragging_)
    scroll();
  if (dragging_ && placed_ && found_hand) {
    drag(sample.position_m);
    if (letting_go_) let_go(sample.position_m);
  }
  unheard_s_ += record_.period_s;
  repeated_ = sample.fresh && found_hand && looks_.repeats(sample.position_m, std::exchange(unheard_s_, 0.0));
  stiffness_n_per_m_ = governor_.stiffness(wished_stiffness(), nominal_period_s, looks_.pace_s());
  const bool fault = std::exchange(fault_, false) || record_.period_s > nominal_period_s + options_.longest_gap_s;
  tick(sample, fault);
}

void HapticRenderer::replay(const DeviceSample& sample, const RecordedTick& recorded) noexcept {
  set_dragging((recorded.flags & kFlagDragged) != 0);
  placement_.reset();
  repeated_ = (recorded.flags & kFlagRepeated) != 0;
  if (window_.object != nullptr && (recorded.flags & kFlagPlaced) != 0) release();
  if (window_.object != nullptr) object_.set_turn(recorded.turn);
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
  const Eigen::Vector4d turn = object_.turn().coeffs();
  state.turn = {turn.x(), turn.y(), turn.z(), turn.w()};
  state.flags &= static_cast<std::uint64_t>(kFlagRealTime);
  if (sample.homed) state.flags |= kFlagHomed;
  if (window_.object != nullptr) state.flags |= kFlagAround;
  if (std::exchange(placed_anew_, false)) state.flags |= kFlagPlaced;
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
  if (window_.object != nullptr) return rehearse_object();
  const Eigen::Vector3d hip_local = centre_m_ + hand_m_ / surface_->scale - surface_->lattice.origin_m;
  ProxyState proxy = proxy_;
  const ProxyUpdate found = solve(hip_local, proxy);
  govern_once_more(found, found.position - hip_local);
}

// `away`: from the hand to the proxy, as in Touched.
void HapticRenderer::govern_once_more(const ProxyUpdate& found, const Eigen::Vector3d& away) const noexcept {
  GovernorInput input;
  input.position_m = hand_m_;
  input.contact = found.contact;
  input.normal = found.normal;
  if (found.contact) input.force_n = stiffness_n_per_m_ * surface_->scale * away;
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
  // Before this tick's force takes the place of the last one's.
  for (std::size_t axis = 0; axis < 3; ++axis)
    record_.applied_force_n[axis] = sample.tells_applied ? sample.applied_n[static_cast<Eigen::Index>(axis)]
                                                         : record_.device_share * state.commanded_force_n[axis];
  record_.device_share = sample.force_share;
  record_.measured_delay_s = sample.delay_s;
  state.orientation = unit_or_none(sample.orientation);
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
    if (window_.object != nullptr && !placement_) placement_.emplace();
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
  state.given_share *= sample.force_share;
  if (stone_gives(state)) state.touched_s = state.time_s;
}

}  // namespace sparsha::haptics
