#include "haptics/around/around_proxy.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <optional>

#include "haptics/around/holding_face.h"
#include "haptics/around/left_sheets.h"
#include "haptics/around/past_edge.h"
#include "haptics/around/unseen_entry.h"

namespace sparsha::haptics {
namespace {

constexpr double kLeaveFacing = 0.5;   // below it the proxy looks for a sheet that faces it better
constexpr double kEnterFacing = 0.58;  // which that one must
constexpr double kNearNormal = 0.5;    // of 60 degrees: the same surface where a sheet ends
constexpr double kCornerNormal = 0.1;  // of 84 degrees: the other face of a hollow corner
constexpr double kSameGap = 0.5;       // cells between two sheets of one surface
constexpr double kEndGap = 1.5;        // the same where a sheet ends
constexpr double kMostShift = 2.0;     // cells along a sheet's side that the proxy moves when it goes over
constexpr double kBetterFacing = 0.2;  // of the rim of another sheet, beyond that of the own
constexpr double kRimGap = 0.5;        // cells: that such a rim counts further away
constexpr double kHeldGap = 0.6;       // cells: so near a sheet may hold a proxy that leaves another
constexpr double kHeldDepth = 0.5;     // cells: of the hand below that sheet's tangent plane, at least
constexpr double kNearer = 1e-3;       // cells: that a proxy has come nearer to the hand
constexpr double kBelow = 1e-9;        // cells: the solver lifts the proxy onto the surface
constexpr double kLiftOff = 4e-9;      // cells: distance from the surface at which a flight begins
constexpr int kMostTakeOffs = 8;       // a tick
constexpr double kCreaseStep = 0.5;    // cells
constexpr double kCreaseRest = 1e-7;   // cells
constexpr int kFewSteps = 12;          // of the solver
constexpr double kOneLook = 0.5;       // cells: a way that needs but one look about
constexpr double kMeasuredLook = 2.0;  // cells: the same for one that ends where the sheet was measured
constexpr int kLongRun = 16;           // cells: the solver may divide the hand's way

bool is_hand(const ObjectSurface& object, const Eigen::Vector3d& hip_m) noexcept {
  constexpr double kFarthest = 1e12;  // cells, as for one surface
  return hip_m.allFinite() && hip_m.cwiseAbs().maxCoeff() < kFarthest * object.spacing_m;
}

class Course {
 public:
  Course(const ObjectSurface& object, const Eigen::Vector3d& hip_m, AroundState& state,
         const SolverOptions& options) noexcept
      : object_(object),
        hip_m_(hip_m),
        state_(state),
        options_(options),
        begin_m_(state.position_m),
        begin_sheet_(state.sheet) {
    if (begin_sheet_ != kNoSheet) begin_ = view_of(sheet(), begin_m_);
  }

  AroundUpdate run() noexcept {
    while (found_.segments < options_.segment_limit) {
      if (state_.sheet == kNoSheet ? !fly_on() : !slide_on()) return finish();
    }
    found_.unfinished = true;
    return finish();
  }

 private:
  enum class Look { stays, moves, leaves };

  [[nodiscard]] const SheetSurface& sheet() const noexcept { return object_.sheets[state_.sheet]; }
  [[nodiscard]] std::uint8_t cell_here() const noexcept {
    return sheet().cell(state_.proxy.cell.i, state_.proxy.cell.j);
  }

  /// True when there is more to do.
  bool fly_on() noexcept {
    ++found_.segments;
    const Eigen::Vector3d from = off_surface();
    const Flight flight = fly(object_, from, hip_m_, take_offs_ > 0, options_.shape);
    if (flight.crossing) {
      land(*flight.crossing);
      return true;
    }
    state_.position_m = flight.share >= 1.0 ? hip_m_ : Eigen::Vector3d(from + flight.share * (hip_m_ - from));
    found_.unfinished = flight.share < 1.0;
    if (!found_.unfinished) hold_by(entered_unseen(object_, hip_m_, state_.free));
    return false;
  }

  /// Where a flight begins. The solver leaves a crease by the cell that the way leads into; rounding may have put the
  /// place into the cell behind, which the way would enter at once. At a crease that goes along with the way it takes
  /// more: the step grows with the take-offs of a tick.
  [[nodiscard]] Eigen::Vector3d off_surface() const noexcept {
    const Eigen::Vector3d pull = hip_m_ - state_.position_m;
    const double lift_off_m = std::ldexp(kLiftOff * object_.spacing_m, 2 * take_offs_);
    if (take_offs_ == 0 || pull.norm() <= lift_off_m) return state_.position_m;
    return state_.position_m + lift_off_m * pull.normalized();
  }

  void land(const Crossing& crossing) noexcept {
    state_.sheet = crossing.sheet;
    state_.proxy = {};
    state_.proxy.contact = true;
    state_.proxy.sticking = true;
    place(crossing.local_m);
  }

  /// Puts the proxy on its sheet, a hair below, so that the solver lifts it onto the surface.
  void place(const Eigen::Vector3d& local_m) noexcept {
    ProxyState& proxy = state_.proxy;
    const double height = touched_height(*sheet().surface, local_m.x(), local_m.y(), options_.shape);
    proxy.position = {local_m.x(), local_m.y(), height - kBelow * object_.spacing_m};
    proxy.cell = {};
    proxy.cell.i = static_cast<int>(std::floor(local_m.x() / object_.spacing_m));
    proxy.cell.j = static_cast<int>(std::floor(local_m.y() / object_.spacing_m));
    state_.position_m = sheet().to_object(proxy.position);
  }

  void take_off(const Eigen::Vector3d& from_m) noexcept {
    state_.sheet = kNoSheet;
    state_.position_m = from_m;
  }

  /// One run of the solver on the sheet, as far as it may go unwatched; true when there is more to do.
  bool slide_on() noexcept {
    const Eigen::Vector3d from_m = sheet().to_object(state_.proxy.position);
    const std::uint8_t cell = cell_here();
    const int run = cell >= kOpenCell ? cell - kLookCell : 1;
    if (run < kLongRun) state_.proxy.track.known = false;
    found_.in_crease = false;
    slide(cell, run);
    found_.segments += std::max(1, slid_.segments);
    state_.position_m = sheet().to_object(state_.proxy.position);
    if (!slid_.contact) return leave(kNoSheet);
    const bool more = slid_.unfinished;
    if (cell_here() >= kOpenCell && cell >= kOpenCell) return more;
    switch (look_about(from_m)) {
      case Look::stays:
        return more;
      case Look::moves:
        return found_.hand_overs + found_.edges < kMostHandOvers || stop_unfinished();
      case Look::leaves:
        return false;
    }
    return false;
  }

  /// Over at most `run` cells. The solver first gets the steps that it mostly needs to rest: most ticks go less than a
  /// cell, and what has gone further is done again.
  void slide(std::uint8_t cell, int run) noexcept {
    SolverOptions options = options_;
    options.flies = false;
    const Eigen::Vector3d hip_m = sheet().to_local(hip_m_);
    if (cell >= kLookCell && run < kFewSteps) {
      const ProxyState before = state_.proxy;
      options.segment_limit = std::min(kFewSteps, options_.segment_limit);
      slid_ = update_exact(*sheet().surface, hip_m, state_.proxy, options);
      const Eigen::Vector3d way_m = state_.proxy.position - before.position;
      const double length = way_m.head<2>().cwiseAbs().maxCoeff() / object_.spacing_m;
      const bool measured = slid_.contact && cell_here() >= kLookCell;
      if (length <= std::max(measured ? kMeasuredLook : kOneLook, run - 1.0) && !slid_.unfinished) return;
      state_.proxy = before;
    }
    options.segment_limit = std::min(run, options_.segment_limit);
    slid_ = update_exact(*sheet().surface, hip_m, state_.proxy, options);
  }

  bool stop_unfinished() noexcept {
    found_.unfinished = true;
    return false;
  }

  /// Off the surface, unless another sheet at this place holds the hand back: worn edges have normals of many
  /// directions. Where only a sheet that was left in this tick holds it back, the proxy waits on that
  /// sheet until the next tick. True when there is more to do.
  bool leave(std::uint32_t but) noexcept {
    if (is_outside(object_, hip_m_, state_.position_m)) return fly_off();
    if (is_past_edge()) {
      take_off(hip_m_);
      return false;
    }
    const double h = object_.spacing_m;
    const Eigen::Vector3d pull = hip_m_ - state_.position_m;
    const SheetView own = view_of(sheet(), state_.position_m);
    std::uint32_t best = kNoSheet, left = kNoSheet;
    SheetView there, before;
    double deepest = kHeldDepth * h, deepest_left = deepest;
    for (const Passing& passing : object_.blocks.sheets_at(state_.position_m)) {
      const std::uint32_t other = passing.sheet;
      if (other == state_.sheet || other == but) continue;
      const SheetView view = view_of(object_.sheets[other], state_.position_m);
      if (view.cell == kNoCell || std::abs(view.gap_m) > kHeldGap * h || -pull.dot(view.normal) <= deepest) continue;
      if (!may_enter(other)) {
        if (view.cell < kLookCell || own.cell == kNoCell || view.normal.dot(own.normal) < kNearNormal) continue;
        if (-pull.dot(view.normal) <= deepest_left) continue;
        deepest_left = -pull.dot(view.normal);
        left = other;
        before = view;
        continue;
      }
      deepest = -pull.dot(view.normal);
      best = other;
      there = view;
    }
    if (best == kNoSheet && left != kNoSheet) {
      move_to(left, before);
      return stop_unfinished();
    }
    if (best == kNoSheet) return fly_off();
    ++found_.edges;
    move_to(best, there);
    return found_.hand_overs + found_.edges < kMostHandOvers || stop_unfinished();
  }

  bool fly_off() noexcept {
    take_off(state_.position_m);
    return ++take_offs_ <= kMostTakeOffs || stop_unfinished();
  }

  /// Tested once for a place and tick; where it is true the tick ends.
  [[nodiscard]] bool is_past_edge() noexcept {
    if (asked_sheet_ == state_.sheet && asked_m_ == state_.position_m) return false;
    asked_sheet_ = state_.sheet, asked_m_ = state_.position_m;
    return is_hand_past_edge(object_, state_.sheet, state_.position_m, hip_m_, options_.shape);
  }

  /// Where the proxy has come to a place that is not open.
  Look look_about(const Eigen::Vector3d& from_m) noexcept {
    const std::uint8_t cell = cell_here();
    normal_ = sheet().turn_to_object(slid_.normal);
    if (cell < kLookCell) {
      // What is continued has no normal of its own, and what is not even that has no place.
      const SheetView before = view_of(sheet(), from_m);
      if (before.cell >= kLookCell) normal_ = before.normal;
      if (cell == kNoCell) place(sheet().to_local(from_m));
    }
    if (const auto stop = stopped_by(object_, state_.sheet, from_m, state_.position_m, normal_, options_.shape))
      return turn_at_crease(*stop, from_m);
    if (cell >= kLookCell && slid_.normal.z() >= kLeaveFacing) return Look::stays;
    if (move_to_same_surface(cell)) return Look::moves;
    if (cell >= kLookCell) return Look::stays;
    const Look at_edge = pass_edge();
    if (at_edge != Look::stays) return at_edge;
    if (cell == kRimCell) return pass_rim();
    if (left_.any()) return stop_unfinished() ? Look::moves : Look::leaves;
    if (fall_beyond_edge()) return Look::moves;
    if (hold_from_over()) return Look::moves;
    // The surface has ended: the proxy is let go.
    take_off(hip_m_);
    found_.released = held_at(object_, kNoSheet, hip_m_) != Held::outside;
    return Look::leaves;
  }

  /// A proxy may have gone on further beyond an edge than pass_edge() looks: what lies on its way to the hand is
  /// entered from outside. False where nothing does, or where it would be the sheet itself.
  bool fall_beyond_edge() noexcept {
    const Flight flight = fly(object_, state_.position_m, hip_m_, true, options_.shape);
    return flight.crossing && go_over(*flight.crossing, kRimCell);
  }

  /// To another sheet that is crossed on the way to the hand, in a cell worth `least` or more.
  bool go_over(const Crossing& crossing, std::uint8_t least) noexcept {
    if (crossing.sheet == state_.sheet || !may_enter(crossing.sheet)) return false;
    const SheetSurface& other = object_.sheets[crossing.sheet];
    const SheetView there = view_of(other, other.to_object(crossing.local_m));
    if (there.cell < least) return false;
    ++found_.edges;
    move_to(crossing.sheet, there);
    return true;
  }

  /// On a rim that pass_edge() found nothing about: the proxy goes over to what was measured between it and the hand;
  /// off it goes where it is outside of what lies beyond the edge, with a hand that is outside too and nothing between.
  Look pass_rim() noexcept {
    const Flight flight = fly(object_, state_.position_m, hip_m_, true, options_.shape);
    ++found_.segments;
    if (flight.crossing) return go_over(*flight.crossing, kLookCell) ? Look::moves : Look::stays;
    if (is_past_edge()) {
      take_off(hip_m_);
      return Look::leaves;
    }
    if (flight.share < 1.0 || !is_outside(object_, hip_m_, state_.position_m)) return Look::stays;
    if (held_at(object_, state_.sheet, state_.position_m) != Held::outside) return Look::stays;
    take_off(hip_m_);
    return Look::leaves;
  }

  /// A hand that is inside is held by the nearest sheet over it, if that pushes it the way that it was pushed: no hand
  /// goes over to the other face of a thin wall. False where there is none.
  bool hold_from_over() noexcept {
    const auto over = surface_over(object_, hip_m_);
    if (!over || over->sheet == state_.sheet || !may_enter(over->sheet)) return false;
    const SheetView there = view_of(object_.sheets[over->sheet], hip_m_);
    if (there.normal.dot(state_.position_m - hip_m_) <= 0.0 || there.normal.dot(normal_) < -kSameNormal) return false;
    ++found_.edges;
    move_to(over->sheet, there);
    return true;
  }

  /// The nearest sheet that goes on with this surface, if there is one.
  bool move_to_same_surface(std::uint8_t cell) noexcept {
    const bool ends = cell < kLookCell;
    std::uint32_t best = kNoSheet;
    SheetView there;
    double least = (ends ? kEndGap : kSameGap) * object_.spacing_m;
    for (const Passing& passing : object_.blocks.sheets_at(state_.position_m)) {
      const std::uint32_t other = passing.sheet;
      if (other == state_.sheet) continue;
      const SheetView view = view_of(object_.sheets[other], state_.position_m);
      // Where both are continued, the one that faces the surface better is off by less.
      const bool rim = view.cell == kRimCell && cell == kRimCell;
      if (rim && (!(view.gap_m > 0.0) || view.facing < slid_.normal.z() + kBetterFacing)) continue;
      const double gap_m = std::abs(view.gap_m) + (rim ? kRimGap * object_.spacing_m : 0.0);
      if (view.cell < (cell < kLookCell ? kRimCell : kLookCell) || gap_m > least) continue;
      // Past the line where the faces of a hollow corner meet, a sheet lies behind the other.
      const bool behind = ends && view.cell >= kLookCell && view.gap_m < 0.0;
      const double nearest = behind ? kCornerNormal : ends ? kNearNormal : kSameNormal;
      if (view.normal.dot(normal_) < nearest || !may_enter(other)) continue;
      if ((!ends && view.facing < kEnterFacing) || gap_m > kMostShift * object_.spacing_m * view.facing) continue;
      least = gap_m;
      best = other;
      there = view;
    }
    if (best == kNoSheet) return false;
    ++found_.hand_overs;
    if (!slid_.unfinished && found_.hand_overs == 1) rested_m_ = state_.position_m;
    move_to(best, there);
    return true;
  }

  /// Beyond an edge the proxy goes on on the other sheet, or into the air when the hand is outside of that. The wall of
  /// a hollow corner, which every hand over the floor is outside of, is no such sheet.
  Look pass_edge() noexcept {
    std::uint32_t best = kNoSheet;
    SheetView there;
    double least = kEdgeGap * object_.spacing_m;
    for (const Passing& passing : object_.blocks.sheets_at(state_.position_m)) {
      const std::uint32_t other = passing.sheet;
      if (other == state_.sheet) continue;
      const SheetView view = view_of(object_.sheets[other], state_.position_m);
      if (view.cell == kNoCell) continue;
      const bool same = view.normal.dot(normal_) >= kSameNormal;
      if (same && std::abs(view.gap_m) <= kSameGap * object_.spacing_m) return Look::stays;  // the surface goes on
      if (same || !(view.gap_m > 0.0) || view.gap_m > least || !may_enter(other)) continue;
      if (is_wall_of_corner(object_, other, view, state_.position_m, normal_)) continue;
      least = view.gap_m;
      best = other;
      there = view;
    }
    if (best == kNoSheet) return Look::stays;
    const Eigen::Vector3d pull = hip_m_ - object_.sheets[best].to_object(there.local);
    if (pull.dot(there.normal) >= 0.0) return leave(best) ? Look::moves : Look::leaves;
    ++found_.edges;
    move_to(best, there);
    return Look::moves;
  }

  [[nodiscard]] bool may_enter(std::uint32_t other) const noexcept {
    return left_.may_enter(other, (hip_m_ - state_.position_m).norm() + kNearer * object_.spacing_m);
  }

  /// Puts the proxy on another sheet; friction's state turns with the chart.
  void move_to(std::uint32_t other, const SheetView& there) noexcept {
    left_.add(state_.sheet, (hip_m_ - state_.position_m).norm());
    const SheetSurface& old = sheet();
    const SheetSurface& fresh = object_.sheets[other];
    ProxyState& proxy = state_.proxy;
    HandTrack track = proxy.track;
    track.hand = fresh.to_local(old.to_object(track.hand));
    track.normal = fresh.axes.to_chart(old.turn_to_object(track.normal));
    proxy.contact = true;
    proxy.track = track;
    state_.sheet = other;
    place(there.local);
    proxy.track.proxy = proxy.position;
    slid_.normal = fresh.axes.to_chart(there.normal);
  }

  /// A sheet stands in the way of the sliding proxy: it goes on on that sheet, or along the crease between the two.
  Look turn_at_crease(const Crossing& stop, const Eigen::Vector3d& from_m) noexcept {
    const SheetSurface& wall = object_.sheets[stop.sheet];
    const Eigen::Vector3d place = from_m + stop.share * (state_.position_m - from_m);
    const SheetView there = view_of(wall, place);
    const Eigen::Vector3d pull = hip_m_ - place;
    const Eigen::Vector3d along_wall = pull - pull.dot(there.normal) * there.normal;
    if (along_wall.dot(normal_) >= 0.0 && may_enter(stop.sheet)) {
      ++found_.edges;
      move_to(stop.sheet, there);
      return Look::moves;
    }
    return slide_in_crease(place, there, stop.sheet, pull);
  }

  /// Both sheets hold the proxy: it moves along the line where they meet, as far as that brings it nearer to the hand.
  Look slide_in_crease(const Eigen::Vector3d& place_m, const SheetView& there, std::uint32_t wall,
                       const Eigen::Vector3d& pull) noexcept {
    const double h = object_.spacing_m;
    const Eigen::Vector3d line = normal_.cross(there.normal).normalized();
    const double wish = pull.dot(line);
    const double held = slid_.mu_dynamic * (pull - wish * line).norm();
    const double step =
        std::clamp(std::copysign(std::max(0.0, std::abs(wish) - held), wish), -kCreaseStep * h, kCreaseStep * h);
    Eigen::Vector3d next = place_m + step * line;
    for (int k = 0; k < 3; ++k) {
      const SheetView view = view_of(object_.sheets[wall], next);
      if (view.cell != kNoCell) next += std::max(0.0, -view.gap_m) * view.normal;
      const SheetView own = view_of(sheet(), next);
      if (own.cell != kNoCell) next = sheet().to_object(own.local);
    }
    const bool nearer = (hip_m_ - next).squaredNorm() < pull.squaredNorm();
    const bool rests = std::abs(step) <= kCreaseRest * h || !nearer;
    if (rests) next = place_m;
    place(sheet().to_local(next));
    found_.in_crease = true;
    slid_.normal = sheet().axes.to_chart(Eigen::Vector3d(-pull.normalized()));
    return rests ? Look::leaves : Look::moves;
  }

  /// What two sheets of one surface differ by is no step of the force: it fades over the proxy's next cells.
  void fade_seam() noexcept {
    SeamFade& seam = state_.seam;
    if (state_.sheet == kNoSheet || found_.edges > 0) {
      seam = {};
      return;
    }
    const double arm_m = (state_.position_m - hip_m_).norm();
    seam.go_on((state_.position_m - begin_m_).norm() / object_.spacing_m);
    if (found_.hand_overs > 0 && rested_m_) {
      // A hand that rests on the sheet before was there: the force goes on from what it was.
      const Eigen::Vector3d apart_m = seam.felt_m(arm_m) + *rested_m_ - state_.position_m;
      seam = SeamFade::of(apart_m, arm_m, object_.spacing_m);
    }
    found_.position_m += seam.felt_m(arm_m);
  }

  /// A hand that was let go, but lies within the object, is held by the nearest face that it lies under, on the side
  /// that it was pushed to. Deep under a corner it lies under none: the proxy waits where it was.
  void hold_within() noexcept {
    hold_by(holding_face(object_, hip_m_, {begin_sheet_, begin_m_, begin_, found_.released}, options_.shape));
  }
  void hold_by(const std::optional<Crossing>& face) noexcept {
    if (!face) return;
    land(*face);
    slid_.normal = sheet().axes.to_chart(view_of(sheet(), state_.position_m).normal);
    found_.released = found_.unfinished = false;
    ++found_.edges;
  }

  AroundUpdate finish() noexcept {
    if (state_.sheet != kNoSheet && cell_here() < kOpenCell && is_past_edge()) {
      take_off(hip_m_);
      found_.unfinished = false;
    }
    if (begin_sheet_ != kNoSheet && state_.sheet == kNoSheet) hold_within();
    found_.position_m = state_.position_m;
    if (state_.seam.left > 0.0 || rested_m_) fade_seam();
    found_.sheet = state_.sheet;
    found_.contact = state_.sheet != kNoSheet;
    if (!found_.contact) return found_;
    state_.free = {};
    found_.normal = sheet().turn_to_object(slid_.normal);
    found_.sticking = slid_.sticking;
    found_.mu_dynamic = slid_.mu_dynamic;
    found_.mu_static = slid_.mu_static;
    found_.cell_flags = slid_.cell_flags;
    return found_;
  }

  const ObjectSurface& object_;
  const Eigen::Vector3d& hip_m_;
  AroundState& state_;
  const SolverOptions& options_;
  AroundUpdate found_;
  ProxyUpdate slid_;
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();
  int take_offs_ = 0;
  Eigen::Vector3d begin_m_;  ///< the proxy before
  std::uint32_t begin_sheet_;
  SheetView begin_;                          ///< of the sheet that it was on
  std::optional<Eigen::Vector3d> rested_m_;  ///< the proxy on the sheet that it left first, at rest there
  LeftSheets left_;
  /// Where is_past_edge() was asked last.
  std::uint32_t asked_sheet_ = kNoSheet;
  Eigen::Vector3d asked_m_;
};

}  // namespace

AroundUpdate update_around(const ObjectSurface& object, const Eigen::Vector3d& hip_m, AroundState& state,
                           const SolverOptions& options) noexcept {
  AroundUpdate nothing;
  nothing.position_m = state.position_m;
  if (!is_hand(object, hip_m)) return nothing;
  if (!state.started) {
    state = {};
    state.started = true;
    state.position_m = hip_m;
    nothing.position_m = hip_m;
    return nothing;
  }
  return Course(object, hip_m, state, options).run();
}

}  // namespace sparsha::haptics
