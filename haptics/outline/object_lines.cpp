#include "haptics/outline/object_lines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "haptics/outline/line_joins.h"
#include "haptics/outline/outline.h"
#include "scene/depth_grid.h"
#include "scene/ground/contours.h"
#include "scene/solid/surface_nodes.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using scene::Charts;
using scene::Contour;
using scene::Sheet;
using scene::SideAxes;
using scene::SurfaceNode;
using scene::SurfaceNodes;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kSharp = 0.70710678;  // cosine of 45 degrees: surfaces that differ by more meet in an edge
constexpr double kAbout = 4.0;         // spacings: of nodes that tell what is beyond the end of a sheet
constexpr double kMeets = 2.5;         // spacings to another surface that it meets
constexpr double kBeyond = 2.5;        // spacings from its last node, where the surface would go on
constexpr double kGoesOn = 1.5;        // spacings from there to a node of a surface that does
constexpr double kBeside = 2.5;        // spacings between lines of several sides that are the same one

/// The surface of one sheet; places in node units of the sheet, all results in the grid frame.
class SheetPlaces {
 public:
  SheetPlaces(const Charts& charts, const Sheet& sheet)
      : charts_(charts), sheet_(sheet), axes_(SideAxes::of(sheet.side)) {}

  [[nodiscard]] bool measured(int i, int j) const {
    return i >= 0 && j >= 0 && i < sheet_.nx && j < sheet_.ny && sheet_.measured(sheet_.index(i, j));
  }
  /// Does the surface go on from a node to its neighbour to the right or, `up`, above it?
  [[nodiscard]] bool connected(int i, int j, bool up) const {
    return is_cell(i, j) || (up ? is_cell(i - 1, j) : is_cell(i, j - 1));
  }
  /// Is it a node of any cell?
  [[nodiscard]] bool joined(int i, int j) const {
    return is_cell(i, j) || is_cell(i - 1, j) || is_cell(i, j - 1) || is_cell(i - 1, j - 1);
  }
  [[nodiscard]] LinePlace node(int i, int j) const {
    return {charts_.origin_m + charts_.place_m(sheet_, i, j), Charts::normal(sheet_, i, j)};
  }
  /// Between nodes, of those about it that are measured; empty without any.
  [[nodiscard]] std::optional<LinePlace> between(const Vector2d& place) const {
    const int i = static_cast<int>(std::floor(place.x()));
    const int j = static_cast<int>(std::floor(place.y()));
    double weights = 0.0;
    double height_m = 0.0;
    Vector3d normal = Vector3d::Zero();
    for (int dj = 0; dj <= 1; ++dj)
      for (int di = 0; di <= 1; ++di) {
        const double weight = (1.0 - std::abs(place.x() - i - di)) * (1.0 - std::abs(place.y() - j - dj));
        if (!(weight > 0.0) || !measured(i + di, j + dj)) continue;
        const std::size_t at = sheet_.index(i + di, j + dj);
        const double off_u_m = (place.x() - i - di) * charts_.spacing_m;
        const double off_v_m = (place.y() - j - dj) * charts_.spacing_m;
        const auto slope_u = static_cast<double>(sheet_.slope_u[at]);
        const auto slope_v = static_cast<double>(sheet_.slope_v[at]);
        // With all four nodes the bilinear surface; with fewer the planes of those that there are.
        height_m += weight * (static_cast<double>(sheet_.height_m[at]) + slope_u * off_u_m + slope_v * off_v_m);
        normal += weight * Charts::normal(sheet_, i + di, j + dj);
        weights += weight;
      }
    if (!(weights > 0.0) || !(normal.norm() > 0.0)) return std::nullopt;
    const Vector3d in_chart((sheet_.first_u + place.x()) * charts_.spacing_m,
                            (sheet_.first_v + place.y()) * charts_.spacing_m, height_m / weights);
    return LinePlace{charts_.origin_m + axes_.to_grid(in_chart), normal.normalized()};
  }
  /// Does no other side face a surface of this normal better?
  [[nodiscard]] bool owns(const Vector3d& normal) const {
    return axes_.sign * normal[axes_.w] >= normal.cwiseAbs().maxCoeff() - 1e-9;
  }

 private:
  [[nodiscard]] bool is_cell(int i, int j) const {
    return i >= 0 && j >= 0 && i < sheet_.nx && j < sheet_.ny && (sheet_.mask[sheet_.index(i, j)] & Sheet::kCell) != 0;
  }

  const Charts& charts_;
  const Sheet& sheet_;
  SideAxes axes_;
};

/// The runs of a contour whose points have places: `place(point)` is an optional corner. The last run of a closed
/// contour goes on in its first one.
template <class Place>
void add_runs(const Contour& contour, const Place& place, std::vector<ObjectLine>& lines) {
  const std::size_t first = lines.size();
  bool open = false;
  for (const Vector2d& point : contour.points) {
    const std::optional<LinePlace> corner = place(point);
    if (corner && !open) lines.emplace_back();
    open = corner.has_value();
    if (open) lines.back().push_back(*corner);
  }
  if (!contour.closed() || !open || lines.size() < first + 2) return;
  ObjectLine& begin = lines[first];
  ObjectLine& end = lines.back();
  end.insert(end.end(), begin.begin() + 1, begin.end());  // the closing point is the first once more
  begin = std::move(end);
  lines.pop_back();
}

/// Of all sheets: where the best side is missing, others are all there is.
std::vector<SurfaceNode> all_nodes(const Charts& charts) {
  std::vector<SurfaceNode> nodes;
  for (const Sheet& sheet : charts.sheets)
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i)
        if (sheet.measured(sheet.index(i, j)))
          nodes.push_back({charts.place_m(sheet, i, j), Charts::normal(sheet, i, j)});
  return nodes;
}

/// What lies beyond the last nodes of a sheet.
class SheetEnds {
 public:
  explicit SheetEnds(const Charts& charts)
      : spacing_m_(charts.spacing_m),
        origin_m_(charts.origin_m),
        nodes_(all_nodes(charts), kAbout * charts.spacing_m) {}

  /// Of a sheet's last node and the way out of the sheet: a place of an edge or of a rim; empty where the surface goes
  /// on.
  [[nodiscard]] std::optional<LinePlace> line_at(const LinePlace& last, const Vector3d& out) {
    const Vector3d at_m = last.place_m - origin_m_;
    const Vector3d beyond_m = at_m + kBeyond * spacing_m_ * out;
    nodes_.near(nodes_.cube_of(at_m), about_);
    const SurfaceNode* meets = nullptr;
    double least_m = kMeets * spacing_m_;
    bool goes_on = false;
    for (const SurfaceNode& node : about_) {
      const double alike = node.normal.dot(last.normal);
      if (alike > kSharp && (node.place_m - beyond_m).norm() < kGoesOn * spacing_m_) goes_on = true;
      if (alike > kSharp || alike < -kSharp) continue;
      if (const double distance_m = (node.place_m - at_m).norm(); distance_m < least_m) {
        least_m = distance_m;
        meets = &node;
      }
    }
    if (goes_on) return std::nullopt;
    if (meets == nullptr) return LinePlace{last.place_m, last.normal};
    return edge(at_m, last.normal, *meets);
  }

 private:
  /// Where the planes of two nodes meet, as near as can be to the first one.
  [[nodiscard]] LinePlace edge(const Vector3d& at_m, const Vector3d& normal, const SurfaceNode& other) const {
    const double alike = normal.dot(other.normal);
    const double off_m = other.normal.dot(other.place_m - at_m);
    const Vector3d way = (other.normal - alike * normal) / (1.0 - alike * alike);
    const Vector3d meets_m = off_m * way;
    const Vector3d between = normal + other.normal;
    return LinePlace{origin_m_ + at_m + (meets_m.norm() <= kMeets * spacing_m_ ? meets_m : Vector3d::Zero()),
                     between.norm() > 0.0 ? Vector3d(between.normalized()) : normal};
  }

  double spacing_m_;
  Vector3d origin_m_;
  SurfaceNodes nodes_;
  std::vector<SurfaceNode> about_;
};

/// Edges and rims: where a sheet ends and its surface with it.
void find_ends(const Charts& charts, const Sheet& sheet, SheetEnds& ends, std::vector<ObjectLine>& lines) {
  const SheetPlaces places(charts, sheet);
  const auto inside = [&](int i, int j) { return places.joined(i, j); };
  for (const Contour& border : trace_border(sheet.nx, sheet.ny, inside))
    add_runs(
        border,
        [&](const Vector2d& point) -> std::optional<LinePlace> {
          // The nearest node of the sheet, and the way out of it along its surface.
          const int i = static_cast<int>(std::lround(point.x()));
          const int j = static_cast<int>(std::lround(point.y()));
          int found_i = -1, found_j = -1;
          double least = std::numeric_limits<double>::infinity();
          for (int dj = -1; dj <= 1; ++dj)
            for (int di = -1; di <= 1; ++di)
              if (const double off = (Vector2d(i + di, j + dj) - point).squaredNorm();
                  off < least && places.joined(i + di, j + dj)) {
                least = off;
                found_i = i + di;
                found_j = j + dj;
              }
          if (found_i < 0) return std::nullopt;
          Vector2d way = Vector2d::Zero();
          for (int dj = -2; dj <= 2; ++dj)
            for (int di = -2; di <= 2; ++di)
              if (!places.joined(found_i + di, found_j + dj)) way += Vector2d(di, dj);
          if (!(way.norm() > 0.0)) return std::nullopt;
          const LinePlace last = places.node(found_i, found_j);
          const SideAxes axes = SideAxes::of(sheet.side);
          const Vector3d across = axes.to_grid(Vector3d(way.x(), way.y(), 0.0));
          const Vector3d out = across - across.dot(last.normal) * last.normal;
          if (!(out.norm() > 0.0)) return std::nullopt;
          return ends.line_at(last, out.normalized());
        },
        lines);
}

/// Steps, ridges and grooves of a sheet.
void find_sheet_creases(const Charts& charts, const Sheet& sheet, double noise_m, int stride,
                        std::vector<ObjectLine>& lines) {
  scene::DepthGrid grid;
  grid.lattice.nx = (sheet.nx - 1) / stride + 1;
  grid.lattice.ny = (sheet.ny - 1) / stride + 1;
  grid.lattice.spacing_m = stride * charts.spacing_m;
  grid.height_m.reserve(grid.lattice.count());
  grid.state.reserve(grid.lattice.count());
  for (int j = 0; j < grid.lattice.ny; ++j)
    for (int i = 0; i < grid.lattice.nx; ++i) {
      const std::size_t node = sheet.index(i * stride, j * stride);
      grid.height_m.push_back(sheet.height_m[node]);
      grid.state.push_back(sheet.measured(node) ? scene::NodeState::measured : scene::NodeState::unknown);
    }
  const SheetPlaces places(charts, sheet);
  for (const Line& crease : find_creases(grid, noise_m)) {
    // As a contour of the sheet's own nodes, at most one apart.
    Contour contour;
    for (std::size_t k = 0; k < crease.size(); ++k) {
      const Vector2d to = crease[k] / charts.spacing_m;
      if (k > 0) {
        const Vector2d from = crease[k - 1] / charts.spacing_m;
        const int pieces = std::max(1, static_cast<int>(std::ceil((to - from).norm())));
        for (int piece = 1; piece < pieces; ++piece)
          contour.points.emplace_back(from + (static_cast<double>(piece) / pieces) * (to - from));
      }
      contour.points.push_back(to);
    }
    add_runs(
        contour, [&](const Vector2d& point) { return places.between(point); }, lines);
  }
}

/// Of lines beside each other, found on several sides, those of the side that faces the surface best. `facing`: of each
/// line's side, its outward direction.
std::vector<ObjectLine> best_facing(const std::vector<ObjectLine>& lines, const std::vector<Vector3d>& facing,
                                    double beside_m) {
  std::vector<SurfaceNode> places;
  for (std::size_t line = 0; line < lines.size(); ++line)
    for (const LinePlace& corner : lines[line])
      places.push_back({corner.place_m, corner.normal, 1.0, static_cast<double>(line)});
  const SurfaceNodes nodes(std::move(places), beside_m);
  std::vector<SurfaceNode> about;
  std::vector<ObjectLine> best;
  for (std::size_t line = 0; line < lines.size(); ++line) {
    const auto wins = [&](const LinePlace& corner) {
      nodes.near(nodes.cube_of(corner.place_m), about);
      const double own = corner.normal.dot(facing[line]);
      return std::none_of(about.begin(), about.end(), [&](const SurfaceNode& other) {
        const Vector3d& side = facing[static_cast<std::size_t>(other.value)];
        return side != facing[line] && other.normal.dot(side) > own &&
               (other.place_m - corner.place_m).norm() < beside_m && other.normal.dot(corner.normal) > kSharp;
      });
    };
    bool open = false;
    for (const LinePlace& corner : lines[line]) {
      const bool won = wins(corner);
      if (won && !open) best.emplace_back();
      open = won;
      if (open) best.back().push_back(corner);
    }
  }
  return best;
}

}  // namespace

std::vector<ObjectLine> find_object_outlines(const Charts& charts, double noise_m, int stride) {
  std::vector<ObjectLine> ends, creases;
  std::vector<Vector3d> facing;
  SheetEnds beyond(charts);
  for (const Sheet& sheet : charts.sheets) {
    find_ends(charts, sheet, beyond, ends);
    find_sheet_creases(charts, sheet, noise_m, stride, creases);
    facing.resize(creases.size(), SideAxes::of(sheet.side).to_grid(Vector3d(0.0, 0.0, 1.0)));
  }
  std::vector<ObjectLine> lines = finished(std::move(ends), charts.spacing_m);
  const double beside_m = kBeside * stride * charts.spacing_m;
  for (ObjectLine& crease : finished(best_facing(creases, facing, beside_m), stride * charts.spacing_m))
    lines.push_back(std::move(crease));
  std::stable_sort(lines.begin(), lines.end(),
                   [](const ObjectLine& a, const ObjectLine& b) { return length_m(a) > length_m(b); });
  return lines;
}

std::vector<ObjectLine> find_object_borders(const Charts& charts,
                                            const std::function<double(const Vector3d& place_m)>& inside_m) {
  std::vector<ObjectLine> lines;
  for (const Sheet& sheet : charts.sheets) {
    const SheetPlaces places(charts, sheet);
    std::vector<double> inside(sheet.count(), kNan);
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i)
        if (places.measured(i, j)) inside[sheet.index(i, j)] = inside_m(places.node(i, j).place_m);
    const auto contours = scene::trace_contours(sheet.nx, sheet.ny, [&](int i, int j, bool up) {
      if (!places.connected(i, j, up)) return kNan;
      return scene::zero_between(inside[sheet.index(i, j)], inside[sheet.index(i + (up ? 0 : 1), j + (up ? 1 : 0))]);
    });
    for (const Contour& contour : contours)
      add_runs(
          contour,
          [&](const Vector2d& point) {
            std::optional<LinePlace> corner = places.between(point);
            return corner && places.owns(corner->normal) ? corner : std::nullopt;
          },
          lines);
  }
  return finished(std::move(lines), charts.spacing_m);
}

ObjectLine on_surface(const Charts& charts, const std::vector<Vector3d>& drawn_m, double reach_m) {
  const SurfaceNodes nodes(charts, reach_m, 1, [](const Sheet&, std::size_t) { return 0.0; });
  std::vector<SurfaceNode> about;
  const auto moved = [&](const Vector3d& place_m) -> std::optional<LinePlace> {
    const Vector3d at_m = place_m - charts.origin_m;
    nodes.near(nodes.cube_of(at_m), about);
    const SurfaceNode* nearest = nullptr;
    double least_m = reach_m;
    for (const SurfaceNode& node : about)
      if (const double distance_m = (node.place_m - at_m).norm(); distance_m <= least_m) {
        least_m = distance_m;
        nearest = &node;
      }
    if (nearest == nullptr) return std::nullopt;
    const double off_m = nearest->normal.dot(at_m - nearest->place_m);
    return LinePlace{place_m - off_m * nearest->normal, nearest->normal};
  };
  Contour steps;  // along the drawn line: its piece, and the share of it
  for (std::size_t k = 0; k + 1 < drawn_m.size(); ++k) {
    const double way_m = (drawn_m[k + 1] - drawn_m[k]).norm();
    const double pieces = std::max(1.0, std::ceil(way_m / charts.spacing_m));
    for (double piece = 0.0; piece < pieces; ++piece) steps.points.emplace_back(static_cast<double>(k), piece / pieces);
  }
  if (steps.points.empty()) return {};
  const bool closed = drawn_m.size() > 3 && drawn_m.front() == drawn_m.back();
  steps.points.emplace_back(closed ? 0.0 : static_cast<double>(drawn_m.size() - 2), closed ? 0.0 : 1.0);
  std::vector<ObjectLine> lines;
  add_runs(
      steps,
      [&](const Vector2d& step) {
        const auto k = static_cast<std::size_t>(step.x());
        return moved(drawn_m[k] + step.y() * (drawn_m[k + 1] - drawn_m[k]));
      },
      lines);
  const auto longest = std::max_element(
      lines.begin(), lines.end(), [](const ObjectLine& a, const ObjectLine& b) { return length_m(a) < length_m(b); });
  return longest == lines.end() ? ObjectLine{} : std::move(*longest);
}

}  // namespace sparsha::haptics
