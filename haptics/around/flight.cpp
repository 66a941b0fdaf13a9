// The straight way of a free proxy through the blocks of space and the cells of the sheets in them. A crossing counts
// from outside inwards, wherever the hand is afterwards: depth never decides.
#include "haptics/around/flight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "haptics/proxy/bicubic_descent.h"
#include "haptics/proxy/place.h"
#include "haptics/proxy/ray_march.h"

namespace sparsha::haptics {
namespace {

constexpr double kMiss = std::numeric_limits<double>::infinity();
// Sheets of one surface lie apart by a share of this where they overlap, and by this at most about a worn edge. A hand
// may hover between them: one that is not further inside and goes inwards is stopped where it is.
constexpr double kBetweenSheets = 0.6;  // cells, along the normal
// A way that is so far from a sheet's planes does not meet it. Catmull-Rom patches overshoot the planes.
template <class Surface>
constexpr double kApart = std::is_same_v<Surface, C1Surface> ? kMiss : kBetweenSheets + 0.05;  // cells
constexpr double kOnSurface = 1e-6;  // cells: no deeper, a way begins on a surface
constexpr double kOverlap = 1e-3;    // cells: ways through neighbouring blocks overlap by so much
constexpr double kOnEdge = 1e-3;     // cells: so far outside, a place still counts as inside an edge
// A rim does not reach further out of the sheet beyond an edge: two cells of its side, whose direction the edge's other
// face may have steep under it. What is continued itself says less.
constexpr double kOutsideCells = 4.5;  // cells
constexpr double kOutsideRimCells = 3.2;
constexpr double kAboveCorner = 1.5;     // cells: so far above a hollow corner its wall was measured
constexpr double kOppositeFaces = -0.5;  // cosine under which faces are those of a wall
constexpr double kInsideCells = 4.0;     // cells: nor further in

/// Walks the cells of one sheet under the way from `from` along `w` (cells), between two shares of it.
template <class Surface>
class SheetMarch {
 public:
  SheetMarch(const SheetSurface& sheet, const CellVector& from, const CellVector& w, bool may_hover) noexcept
      : sheet_(sheet), surface_(*sheet.surface), from_(from), w_(w), may_hover_(may_hover) {}

  /// Share of the next crossing in [begin, end] that `accepts` (share, cell) takes; kMiss without one.
  template <typename Accepts>
  [[nodiscard]] double next(double begin, double end, const Accepts& accepts) noexcept {
    if (!clip(from_.x, w_.x, surface_.nx() - 1, begin, end) || !clip(from_.y, w_.y, surface_.ny() - 1, begin, end))
      return kMiss;
    int i = cell_of(from_.x + begin * w_.x, w_.x, surface_.nx());
    int j = cell_of(from_.y + begin * w_.y, w_.y, surface_.ny());
    bool first = true;
    bool was_outside = false;
    double at = begin;
    while (at <= end) {
      const double out_x = exit_of(i, from_.x, w_.x);
      const double out_y = exit_of(j, from_.y, w_.y);
      const double out = std::max(at, std::min({out_x, out_y, end}));
      const std::uint8_t cell = sheet_.cell(i, j);
      if (cell != kNoCell) {
        const double hit = hit_in(i, j, at, out, first, was_outside);
        if (hit <= out && accepts(hit, cell)) return hit;
        if (hit <= out) was_outside = false;
      } else {
        was_outside = false;
      }
      if (out >= end) return kMiss;
      first = false;
      (out_x <= out_y ? i : j) += (out_x <= out_y ? w_.x : w_.y) > 0.0 ? 1 : -1;
      at = out;
    }
    return kMiss;
  }

 private:
  /// Keeps the shares of the way that lie over the sheet's box.
  [[nodiscard]] static bool clip(double from, double w, int cells, double& begin, double& end) noexcept {
    if (w == 0.0) return from >= 0.0 && from <= cells;
    const double a = -from / w;
    const double b = (cells - from) / w;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
    return begin <= end;
  }
  [[nodiscard]] static int cell_of(double x, double w, int nodes) noexcept {
    const double low = std::floor(x);
    const int cell = static_cast<int>(low) - (low == x && w < 0.0 ? 1 : 0);
    return std::clamp(cell, 0, nodes - 2);
  }
  /// Where the way leaves the cells of one column or row.
  [[nodiscard]] static double exit_of(int cell, double from, double w) noexcept {
    if (w == 0.0) return kMiss;
    return ((w > 0.0 ? cell + 1 : cell) - from) / w;
  }

  /// Share of the crossing in this cell; afterwards `was_outside` tells of its end.
  [[nodiscard]] double hit_in(int i, int j, double at, double out, bool first, bool& was_outside) const noexcept {
    const auto patch = surface_.patch(i, j);
    CellPoint p;
    p.i = i;
    p.j = j;
    p.s = std::clamp(from_.x + at * w_.x - i, 0.0, 1.0);
    p.t = std::clamp(from_.y + at * w_.y - j, 0.0, 1.0);
    p.z = from_.z + at * w_.z;
    const double gap = p.z - patch.height(p.s, p.t);
    const double s = std::clamp(from_.x + out * w_.x - i, 0.0, 1.0);
    const double t = std::clamp(from_.y + out * w_.y - j, 0.0, 1.0);
    const double gap_out = from_.z + out * w_.z - patch.height(s, t);
    const bool came_outside = was_outside;
    was_outside = gap_out > 0.0;
    if (gap <= 0.0) {
      const double fs = patch.slope_s(p.s, p.t);
      const double ft = patch.slope_t(p.s, p.t);
      const bool inwards = w_.z - fs * w_.x - ft * w_.y < 0.0;
      const bool hovering =
          first && may_hover_ && gap * gap <= kBetweenSheets * kBetweenSheets * (1.0 + fs * fs + ft * ft);
      if (came_outside || (hovering && inwards)) return at;
      // A way that leaves the surface may meet it again in the same cell.
      if (inwards || !first || gap < -kOnSurface) return kMiss;
      const double again = ray_patch_hit(patch, p, w_, out - at, true);
      return again <= out - at ? at + again : kMiss;
    }
    const double hit = ray_patch_hit(patch, p, w_, out - at, false);
    if (hit <= out - at) return at + hit;
    return gap_out <= 0.0 ? out : kMiss;
  }

  const SheetSurface& sheet_;
  Surface surface_;
  CellVector from_, w_;
  bool may_hover_;  // the way may begin between two sheets
};

/// What measured faces beside a sheet's own say of a place: all of them that it is inside, one that it is outside, or
/// nothing. The other face of a wall is none of them.
Held held_by_measured(const ObjectSurface& object, std::uint32_t own, const Eigen::Vector3d& place_m,
                      const Eigen::Vector3d& normal) noexcept {
  Held held = Held::unknown;
  for (const Passing& other : object.blocks.sheets_at(place_m)) {
    if (other.sheet == own) continue;
    const SheetView view = view_of(object.sheets[other.sheet], place_m);
    const double gap = view.gap_m / object.spacing_m;
    if (view.cell < kLookCell || gap > kOutsideCells || gap < -kInsideCells) continue;
    if (view.normal.dot(normal) < kOppositeFaces) continue;
    if (gap > kOnEdge) return Held::outside;
    held = Held::inside;
  }
  return held;
}

/// The rim belongs to the object only where another sheet says that its place is inside, or that one just behind it,
/// where the other sheet begins. What was measured says it before what is continued.
bool is_edge(const ObjectSurface& object, std::uint32_t own, const Eigen::Vector3d& place_m,
             const Eigen::Vector3d& cell_ahead_m) noexcept {
  const Eigen::Vector3d normal = view_of(object.sheets[own], place_m).normal;
  for (const double share : {0.0, 0.5, 1.0}) {
    Held held = held_by_measured(object, own, place_m + share * cell_ahead_m, normal);
    if (held == Held::unknown) held = held_at(object, own, place_m + share * cell_ahead_m);
    if (held != Held::unknown) return held == Held::inside;
  }
  return false;
}

template <class Surface>
void cross_sheet(const ObjectSurface& object, std::uint32_t number, const Eigen::Vector3d& from_m,
                 const Eigen::Vector3d& way_m, double begin, double end, bool may_hover, Crossing& first,
                 bool& refused) noexcept {
  const SheetSurface& sheet = object.sheets[number];
  const double cells_per_m = 1.0 / object.spacing_m;
  const Eigen::Vector3d from = cells_per_m * sheet.to_local(from_m);
  const Eigen::Vector3d w = cells_per_m * sheet.axes.to_chart(way_m);
  const Eigen::Vector3d cell_ahead_m = way_m / w.norm();
  SheetMarch<Surface> march(sheet, {from.x(), from.y(), from.z()}, {w.x(), w.y(), w.z()}, may_hover);
  const double share = march.next(begin, std::min(end, first.share), [&](double at, std::uint8_t cell) {
    const Eigen::Vector3d place_m = from_m + at * way_m;
    const bool counts = cell == kRimCell
                            ? is_edge(object, number, place_m, cell_ahead_m)
                            : !may_hover || at > begin || held_at(object, number, place_m) != Held::outside;
    refused = refused || !counts;
    return counts;
  });
  if (!(share < first.share)) return;
  first.sheet = number;
  first.share = share;
  first.local_m = sheet.to_local(from_m + share * way_m);
}

/// Visits the blocks along a way in their order (Amanatides & Woo 1987).
class BlockWalk {
 public:
  BlockWalk(const BlockIndex& blocks, const Eigen::Vector3d& from_m, const Eigen::Vector3d& way_m) noexcept
      : block_(blocks.block_of(from_m)) {
    for (int axis = 0; axis < 3; ++axis) {
      const double w = way_m[axis];
      step_[axis] = w > 0.0 ? 1 : -1;
      const double edge = (block_[axis] + (w > 0.0 ? 1 : 0)) * blocks.block_m();
      next_[axis] = w == 0.0 ? kMiss : std::max(0.0, (edge - from_m[axis]) / w);
      delta_[axis] = w == 0.0 ? kMiss : blocks.block_m() / std::abs(w);
    }
  }
  [[nodiscard]] const BlockPlace& block() const noexcept { return block_; }
  /// Share of the way where it leaves the block.
  [[nodiscard]] double exit() const noexcept { return next_.minCoeff(); }
  void step() noexcept {
    int axis = 0;
    next_.minCoeff(&axis);
    block_[axis] += step_[axis];
    next_[axis] += delta_[axis];
  }

 private:
  BlockPlace block_;
  Eigen::Vector3i step_;
  Eigen::Vector3d next_, delta_;
};

template <class Surface>
Flight fly_over(const ObjectSurface& object, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                bool leaving) noexcept {
  const Eigen::Vector3d way_m = to_m - from_m;
  const double length_m = way_m.norm();
  if (!(length_m > 0.0)) return {};
  const double overlap = kOverlap * object.spacing_m / length_m;
  BlockWalk walk(object.blocks, from_m, way_m);
  double begin = 0.0;
  bool refused = false;
  for (int k = 0; k < kMostBlocks; ++k) {
    const double exit = walk.exit();
    const double end = std::min(1.0, exit + overlap);
    Crossing first;
    const Eigen::Vector3d enters_m = from_m + begin * way_m, leaves_m = from_m + end * way_m;
    for (const Passing& passing : object.blocks.sheets(walk.block()))
      if (!passing.is_apart(enters_m, leaves_m, kApart<Surface> * object.spacing_m))
        cross_sheet<Surface>(object, passing.sheet, from_m, way_m, begin, end, k == 0 && !leaving, first, refused);
    if (first.sheet != kNoSheet) return {first, first.share};
    if (exit >= 1.0) {
      const bool came_in = refused && (leaving || held_at(object, kNoSheet, from_m) != Held::inside);
      return {came_in ? surface_over(object, to_m) : std::nullopt, 1.0};
    }
    begin = std::max(0.0, exit - overlap);
    walk.step();
  }
  return {{}, begin};
}

/// Does a sheet that a proxy runs into stop it, where the proxy's own surface has this normal? Over a rim only where
/// the sheet itself begins on the outer side: in a hollow corner, and not at an edge.
bool stops(const SheetSurface& sheet, std::uint8_t cell, const Eigen::Vector3d& place_m, const Eigen::Vector3d& normal,
           double spacing_m) noexcept {
  const SheetView view = view_of(sheet, place_m);
  const double cosine = view.normal.dot(normal);
  if (view.cell == kNoCell || cosine >= kSameNormal) return false;
  if (cell >= kLookCell) return true;
  const Eigen::Vector3d up = (normal - cosine * view.normal).normalized();
  return view_of(sheet, place_m + kAboveCorner * spacing_m * up).cell >= kLookCell;
}

/// Is a sheet the same surface as the proxy's own at a place?
bool is_same(const SheetSurface& sheet, const Eigen::Vector3d& place_m, const Eigen::Vector3d& normal,
             double spacing_m) noexcept {
  const SheetView view = view_of(sheet, place_m);
  return view.cell >= kLookCell && std::abs(view.gap_m) <= kBetweenSheets * spacing_m &&
         view.normal.dot(normal) >= kSameNormal;
}

template <class Surface>
std::optional<Crossing> stop_over(const ObjectSurface& object, std::uint32_t own, const Eigen::Vector3d& from_m,
                                  const Eigen::Vector3d& to_m, const Eigen::Vector3d& normal) noexcept {
  const Eigen::Vector3d way_m = to_m - from_m;
  const double cells_per_m = 1.0 / object.spacing_m;
  Crossing first;
  const double kept = way_m.norm() < kPassingReach * object.spacing_m ? kApart<Surface> : kMiss;
  for (const Passing& passing : object.blocks.sheets_at(from_m)) {
    const std::uint32_t other = passing.sheet;
    if (other == own || passing.is_apart(from_m, to_m, kept * object.spacing_m)) continue;
    const SheetSurface& sheet = object.sheets[other];
    // Where sheets overlap they are one surface at both ends of the way, and stop nothing between.
    if (is_same(sheet, to_m, normal, object.spacing_m) && is_same(sheet, from_m, normal, object.spacing_m)) continue;
    const Eigen::Vector3d from = cells_per_m * sheet.to_local(from_m);
    const Eigen::Vector3d w = cells_per_m * sheet.axes.to_chart(way_m);
    SheetMarch<Surface> march(sheet, {from.x(), from.y(), from.z()}, {w.x(), w.y(), w.z()}, true);
    const double share = march.next(0.0, std::min(1.0, first.share), [&](double at, std::uint8_t cell) {
      return stops(sheet, cell, from_m + at * way_m, normal, object.spacing_m);
    });
    if (share < first.share) first = {other, share, sheet.to_local(from_m + share * way_m)};
  }
  if (first.sheet == kNoSheet) return {};
  return first;
}

}  // namespace

Held held_at(const ObjectSurface& object, std::uint32_t own, const Eigen::Vector3d& place_m) noexcept {
  Held held = Held::unknown;
  for (const Passing& other : object.blocks.sheets_at(place_m)) {
    if (other.sheet == own) continue;
    const SheetView view = view_of(object.sheets[other.sheet], place_m);
    const double gap = view.gap_m / object.spacing_m;
    const double most = view.cell == kRimCell ? kOutsideRimCells : kOutsideCells;
    if (view.cell == kNoCell || gap > most || gap < -kInsideCells) continue;
    if (gap > kOnEdge) return Held::outside;
    held = Held::inside;
  }
  return held;
}

bool is_within_edge(const ObjectSurface& object, const Eigen::Vector3d& place_m) noexcept {
  std::array<Eigen::Vector3d, 4> normals;
  std::size_t count = 0;
  bool meet = false;
  for (const Passing& passing : object.blocks.sheets_at(place_m)) {
    const SheetView view = view_of(object.sheets[passing.sheet], place_m);
    const double gap = view.gap_m / object.spacing_m;
    if (view.cell < kLookCell || gap > kOutsideCells || gap < -kInsideCells) continue;
    if (gap > kOnEdge) return false;
    for (std::size_t k = 0; k < count; ++k) {
      const double cosine = normals[k].dot(view.normal);
      meet = meet || (cosine > kOppositeFaces && cosine < kSameNormal);
    }
    if (count < normals.size()) normals[count++] = view.normal;
  }
  return meet;
}

bool is_outside(const ObjectSurface& object, const Eigen::Vector3d& hand_m, const Eigen::Vector3d& proxy_m) noexcept {
  const auto says = [&](const Eigen::Vector3d& near_m, double most) {
    Held held = Held::unknown;
    for (const Passing& passing : object.blocks.sheets_at(near_m)) {
      const SheetView view = view_of(object.sheets[passing.sheet], hand_m);
      const double gap = view.gap_m / object.spacing_m;
      if (view.cell < kLookCell || std::abs(gap) > most) continue;
      if (gap <= kOnEdge) return Held::inside;
      held = Held::outside;
    }
    return held;
  };
  // Of a thin object the other face is far from a hand that is outside, and says inside.
  const Held near_hand = says(hand_m, kInsideCells);
  return (near_hand != Held::unknown ? near_hand : says(proxy_m, kMiss)) == Held::outside;
}

std::optional<Crossing> surface_over(const ObjectSurface& object, const Eigen::Vector3d& place_m) noexcept {
  Crossing nearest;
  double least = kInsideCells * object.spacing_m;
  for (const Passing& passing : object.blocks.sheets_at(place_m)) {
    const std::uint32_t sheet = passing.sheet;
    const SheetView view = view_of(object.sheets[sheet], place_m);
    const double most = view.cell == kRimCell ? kOutsideRimCells : kOutsideCells;
    if (view.cell == kNoCell || view.gap_m > most * object.spacing_m) continue;
    if (view.gap_m > kOnEdge * object.spacing_m) return {};
    if (view.cell == kRimCell || -view.gap_m >= least) continue;
    least = -view.gap_m;
    nearest = {sheet, 1.0, view.local};
  }
  if (nearest.sheet == kNoSheet) return {};
  return nearest;
}

std::optional<Crossing> stopped_by(const ObjectSurface& object, std::uint32_t own, const Eigen::Vector3d& from_m,
                                   const Eigen::Vector3d& to_m, const Eigen::Vector3d& normal,
                                   CellShape shape) noexcept {
  if (shape == CellShape::rounded) return stop_over<RoundedSurface>(object, own, from_m, to_m, normal);
  if (shape == CellShape::c1) return stop_over<C1Surface>(object, own, from_m, to_m, normal);
  return stop_over<BilinearSurface>(object, own, from_m, to_m, normal);
}

Flight fly(const ObjectSurface& object, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, bool leaving,
           CellShape shape) noexcept {
  if (shape == CellShape::rounded) return fly_over<RoundedSurface>(object, from_m, to_m, leaving);
  if (shape == CellShape::c1) return fly_over<C1Surface>(object, from_m, to_m, leaving);
  return fly_over<BilinearSurface>(object, from_m, to_m, leaving);
}

}  // namespace sparsha::haptics
