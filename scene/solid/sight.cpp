#include "scene/solid/sight.h"

#include <cmath>
#include <limits>
#include <vector>

#include "scene/solid/stretch.h"

namespace sparsha::scene {
namespace {

using Eigen::Vector3d;

Eigen::AlignedBox3d box_of_nodes(const Charts& charts) {
  Eigen::AlignedBox3d box;
  for (const Sheet& sheet : charts.sheets)
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i)
        if (sheet.measured(sheet.index(i, j))) box.extend(charts.place_m(sheet, i, j));
  return box;
}

}  // namespace

Sight::Sight(const Charts& charts)
    : origin_m_(charts.origin_m),
      spacing_m_(charts.spacing_m),
      box_m_(box_of_nodes(charts)),
      nodes_(charts, kReach * charts.spacing_m, 1, [](const Sheet&, std::size_t) { return 0.0; }) {}

// Cube after cube of space along the line. A node's disc lies in its own cube or a neighbour of it.
std::optional<Sight::Place> Sight::along(const Vector3d& from_m, const Vector3d& direction) const {
  constexpr double kDisc = 1.25;  // spacings: nodes of a face that leans by 45 degrees along both axes are 1.73 apart
  constexpr double kFlattest = 0.02;  // sine of the angle below which a face is not met
  const Vector3d way = direction.normalized();
  if (box_m_.isEmpty() || !from_m.allFinite() || !way.allFinite() || way.isZero()) return std::nullopt;
  const Vector3d from = from_m - origin_m_;
  Eigen::AlignedBox3d room_m = box_m_;
  room_m.min().array() -= spacing_m_;
  room_m.max().array() += spacing_m_;
  const Stretch stretch = stretch_in(room_m, from, way);
  const double step_m = 0.5 * kReach * spacing_m_;
  std::vector<SurfaceNode> about;
  std::optional<Eigen::Vector3i> last;
  for (double at_m = stretch.first; at_m <= stretch.last + step_m; at_m += step_m) {
    const Eigen::Vector3i cube = nodes_.cube_of(from + at_m * way);
    if (last == cube) continue;
    last = cube;
    nodes_.near(cube, about);
    double first_m = std::numeric_limits<double>::infinity(), least_m = first_m;
    Place met;
    for (const SurfaceNode& node : about) {
      const double towards = -node.normal.dot(way);
      if (towards < kFlattest) continue;
      const double meets_m = node.normal.dot(from - node.place_m) / towards;
      const double off_m = (from + meets_m * way - node.place_m).norm();
      if (meets_m < 0.0 || off_m > kDisc * spacing_m_ || meets_m > first_m + spacing_m_) continue;
      // Of the discs of one face about the line that of the nearest node.
      if (meets_m > first_m - spacing_m_ && off_m >= least_m) continue;
      first_m = meets_m;
      least_m = off_m;
      met = {origin_m_ + from + meets_m * way, node.normal};
    }
    if (std::isfinite(first_m)) return met;
  }
  return std::nullopt;
}

std::optional<Sight::Place> Sight::nearest(const Vector3d& at_m) const {
  const Vector3d at = at_m - origin_m_;
  std::vector<SurfaceNode> about;
  if (!at.allFinite()) return std::nullopt;
  nodes_.near(nodes_.cube_of(at), about);
  std::optional<Place> place;
  double least_m = kReach * spacing_m_;
  for (const SurfaceNode& node : about)
    if (const double distance_m = (node.place_m - at).norm(); distance_m < least_m) {
      least_m = distance_m;
      place = Place{at_m - node.normal.dot(at - node.place_m) * node.normal, node.normal};
    }
  return place;
}

}  // namespace sparsha::scene
