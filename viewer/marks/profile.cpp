// A line is read in pieces that span few nodes, so that a long one over a large scene costs no more than its length.
#include "viewer/marks/profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "base/files/files.h"
#include "scene/scene.h"

namespace sparsha::viewer {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMostSamples = 20'000;
constexpr std::size_t kPiece = 64;  // samples whose nodes are read at once

/// Nodes about a stretch of the line.
struct Nodes {
  int i0 = 0, j0 = 0;
  scene::Layers layers;
};

/// In spacings from the first node.
Eigen::Vector2d nodes_along(const scene::Lattice& lattice, const Eigen::Vector2d& place) {
  return (place - lattice.origin_m.head<2>()) / lattice.spacing_m;
}

/// The cell of a place, counted in spacings from the first node: of one beyond the lattice, however far, the outermost.
int cell_of(double nodes_along, int nodes) {
  return static_cast<int>(std::clamp(std::floor(nodes_along), 0.0, std::max(nodes - 2.0, 0.0)));
}

Nodes read_nodes(const scene::Scene& scene, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const scene::Lattice& lattice = scene.description().levels.front();
  const Eigen::Vector2d low = nodes_along(lattice, a.cwiseMin(b)), high = nodes_along(lattice, a.cwiseMax(b));
  Nodes nodes;
  nodes.i0 = cell_of(low.x(), lattice.nx);
  nodes.j0 = cell_of(low.y(), lattice.ny);
  const int i1 = cell_of(high.x(), lattice.nx) + 1;
  const int j1 = cell_of(high.y(), lattice.ny) + 1;
  nodes.layers = scene.read(0, nodes.i0, nodes.j0, i1 - nodes.i0 + 1, j1 - nodes.j0 + 1);
  return nodes;
}

/// Height and state of the bilinear surface at a place.
void sample(const scene::Lattice& whole, const Nodes& nodes, ProfileSample& result) {
  result.at_m.z() = kNaN;
  const Eigen::Vector2d place = nodes_along(whole, result.at_m.head<2>());
  const double u = place.x(), v = place.y();
  constexpr double kRounding = 1e-9;
  if (u < -kRounding || v < -kRounding || u > whole.nx - 1 + kRounding || v > whole.ny - 1 + kRounding) return;
  const int i = cell_of(u, whole.nx), j = cell_of(v, whole.ny);
  const scene::DepthGrid& grid = nodes.layers.grid;
  const double s = std::clamp(u - i, 0.0, 1.0), t = std::clamp(v - j, 0.0, 1.0);
  const std::array<double, 4> weights{(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
  double height_m = 0.0;
  bool filled = false;
  for (int corner = 0; corner < 4; ++corner) {
    const double weight = weights[static_cast<std::size_t>(corner)];
    if (weight <= 0.0) continue;
    const std::size_t k = grid.lattice.index(i + (corner & 1) - nodes.i0, j + (corner >> 1) - nodes.j0);
    if (grid.state[k] == scene::NodeState::unknown) return;
    filled = filled || grid.state[k] == scene::NodeState::filled;
    height_m += weight * static_cast<double>(grid.height_m[k]);
  }
  result.at_m.z() = whole.origin_m.z() + height_m;
  result.state = filled ? scene::NodeState::filled : scene::NodeState::measured;
}

const char* name_of(scene::NodeState state) {
  constexpr std::array kNames{"unknown", "measured", "filled"};
  return kNames[static_cast<std::size_t>(state)];
}

}  // namespace

double surface_height_m(const scene::Scene& scene, double x_m, double y_m) {
  const Eigen::Vector2d place(x_m, y_m);
  if (!place.allFinite()) return kNaN;
  ProfileSample result;
  result.at_m = {x_m, y_m, kNaN};
  sample(scene.description().levels.front(), read_nodes(scene, place, place), result);
  return result.at_m.z();
}

std::vector<ProfileSample> profile_along(const scene::Scene& scene, const Eigen::Vector3d& from_m,
                                         const Eigen::Vector3d& to_m) {
  const scene::Lattice& lattice = scene.description().levels.front();
  const Eigen::Vector2d from = from_m.head<2>(), to = to_m.head<2>();
  const double length_m = (to - from).norm();
  if (!std::isfinite(length_m)) return {};
  const double wanted = std::ceil(std::min(length_m / lattice.spacing_m, 1e9) - 1e-9) + 1.0;
  const std::size_t count = std::clamp(static_cast<std::size_t>(wanted), std::size_t{2}, kMostSamples);
  std::vector<ProfileSample> profile(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(count - 1);
    const Eigen::Vector2d place = from + share * (to - from);
    profile[k].along_m = share * length_m;
    profile[k].at_m = {place.x(), place.y(), kNaN};
  }
  for (std::size_t first = 0; first < count; first += kPiece) {
    const std::size_t end = std::min(first + kPiece, count);
    const Nodes nodes = read_nodes(scene, profile[first].at_m.head<2>(), profile[end - 1].at_m.head<2>());
    for (std::size_t k = first; k < end; ++k) sample(lattice, nodes, profile[k]);
  }
  return profile;
}

void write_profile(const std::vector<ProfileSample>& profile, const std::filesystem::path& file) {
  std::string text = "along_m,x_m,y_m,z_m,state\n";
  for (const ProfileSample& s : profile) {
    text += fmt::format("{:.17g},{:.17g},{:.17g},", s.along_m, s.at_m.x(), s.at_m.y());
    if (std::isfinite(s.at_m.z())) text += fmt::format("{:.17g}", s.at_m.z());
    text += fmt::format(",{}\n", name_of(s.state));
  }
  write_file(file, text);
}

void write_measures(const std::vector<Measure>& measures, const std::filesystem::path& file) {
  std::string text = "kind,value,unit,x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,x3_m,y3_m,z3_m\n";
  for (const Measure& measure : measures) {
    const bool angle = measure.kind == Measure::Kind::angle;
    const double value = value_of(measure) * (angle ? 180.0 / std::numbers::pi : 1.0);
    text += fmt::format("{},{:.17g},{}", viewer::name_of(measure.kind), value, angle ? "degree" : "m");
    for (std::size_t k = 0; k < 3; ++k) {
      if (k >= measure.points_m.size()) {
        text += ",,,";
        continue;
      }
      const Eigen::Vector3d& p = measure.points_m[k];
      text += fmt::format(",{:.17g},{:.17g},{:.17g}", p.x(), p.y(), p.z());
    }
    text += '\n';
  }
  write_file(file, text);
}

}  // namespace sparsha::viewer
