// The lattice follows from the extent and the spacing, the rules of the nodes from noise and spacing.
#include "pipeline/projection/plan.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/error.h"
#include "pipeline/projection/lattice.h"
#include "pipeline/projection/sampling.h"
#include "pipeline/projection/surface_statistics.h"

namespace sparsha::pipeline {

namespace {

// Of neighbourhoods in space, flat ones: where more are steep, points belong to a closed object.
constexpr double kSteepShare = 0.2;
// A plate, a coin or a tablet has a second layer at most places, so near that a window over a slope holds both.
constexpr double kLayeredShare = 0.4;
// Where such an object has so much steep surface, it is closed, though few of its points lie on sparse sides; and where
// its layers lean, less is enough.
constexpr double kSteepArea = 0.25;
constexpr double kSteepAreaTilted = 0.1;
constexpr double kThin = 30.0;      // point spacings between layers
constexpr double kThinNodes = 3.0;  // node spacings
constexpr double kFewPoints = 1.3;  // point spacings between nodes
constexpr double kTilted = 0.1;     // mean slope
// Where points on lines, or of a cloud without planes, are this sparse at more places, discs would miss them.
constexpr double kMostSparse = 0.15;
// Where at more places sparse points lie in a plane, discs are wider there.
constexpr double kSomeSparse = 0.04;
constexpr double kStillMore = 0.02;  // and wider still, where that finds so many more of them
// Where at more places points are sparse however wide one looks, they are scattered in space.
constexpr double kSomeScattered = 0.01;
constexpr double kWidestTimes = 4.0;  // as wide, at most
constexpr double kSparse = 2.0;       // medians between points of sparse regions
// Where places have another layer below the highest, a hole may show it.
constexpr double kSomeLayered = 0.1;
// Where more of what is seen first faces away, something else than holes is the reason.
constexpr double kMostTurnedAway = 0.2;

// Whether windows in x and y could take one side of the object for another. A window over many points tells two layers
// apart where it looks straight at them, and reliefs with steps are better seen by windows.
bool has_several_sides(const SpaceStatistics& statistics, const scene::GridConfig& config, const Extent& extent) {
  if (!(statistics.surface_spacing_m > 0.0)) return false;
  if (statistics.steep_share > kSteepShare) return true;
  const double steep_area = statistics.tilt > kTilted ? kSteepAreaTilted : kSteepArea;
  if (statistics.layered_share > kLayeredShare && statistics.steep_area > steep_area) return true;
  const double apart_m = statistics.layers_apart_m;
  if (statistics.layered_share < kLayeredShare || apart_m > kThin * statistics.surface_spacing_m) return false;
  const double longer_m = std::max(extent.width_m(), extent.height_m());
  const double node_m = config.spacing_m > 0.0 ? config.spacing_m
                        : config.size > 1      ? longer_m / (config.size - 1)
                                               : statistics.surface_spacing_m;
  return node_m < kFewPoints * statistics.surface_spacing_m || statistics.tilt > kTilted ||
         apart_m < kThinNodes * node_m;
}

// A sheet must not be taken for the one behind it: of thin objects more points are looked at.
double facing_samples(const SpaceStatistics& statistics, double spacing_m, std::uint64_t points) {
  constexpr double kSamples = 40000.0;
  constexpr double kMostTimes = 10.0;
  constexpr double kApart = 3.0;  // sample spacings
  if (statistics.steep_share > kSteepShare || !(statistics.layers_apart_m > 0.0)) return kSamples;
  const double thinned = std::max(1.0, static_cast<double>(points) / kSamples);
  const double wanted = kApart * spacing_m / statistics.layers_apart_m;
  return kSamples * std::clamp(wanted * wanted * thinned, 1.0, kMostTimes);
}

// A pose does not promise that its scan's origin is the scanner, and estimated normals are turned over in places.
bool is_certain(const Station& station) { return station.proved || (station.declared && station.normals.empty()); }

void name_lying_stations(const FacingField& facing, const OrientedStations& oriented, ProjectionPlan& plan) {
  for (const std::size_t station : facing.lying_stations()) {
    const Station& lying = oriented.stations[station];
    if (!lying.declared) continue;  // a pose says where points are, not where from
    std::vector<std::string>& scans = lying.normals.empty() ? plan.lying_stations : plan.lying_normals;
    if (scans.empty() || scans.back() != lying.scan) scans.push_back(lying.scan);
  }
}

// Whether a hole in the front may show a back where windows decide.
bool may_show_back(const SpaceStatistics& statistics, const std::vector<Station>& stations) {
  if (!(statistics.surface_spacing_m > 0.0)) return false;
  return statistics.layered_share > kSomeLayered || std::any_of(stations.begin(), stations.end(), is_certain);
}

/// A surface, and how much wider than evenly scanned ones its sparse regions need the discs.
struct UnevenSurface {
  SurfaceStatistics surface;
  double times = 1.0;
  double wider_share = 0.0;  ///< of places that need them
  bool scattered = false;    ///< places are sparse however wide one looks
};

// Regions that were scanned from afar have fewer points than neighbourhoods of the median spacing need: these are
// looked at again, wider, until they are found. Where dense regions have no planes, there is no surface to be found.
// Scattered points are sparse, too, but few of them lie in a plane by chance: they need no wider discs.
UnevenSurface uneven_surface(const OrientedPieces& pieces, const Extent& extent, double spacing_m, bool on_lines,
                             ThreadPool& pool) {
  UnevenSurface result{surface_statistics(pieces, extent, spacing_m, on_lines, pool)};
  double sparse_share = result.surface.sparse_share;
  if (!result.surface.flat || on_lines || sparse_share <= kSomeSparse) return result;
  double found = 0.0;
  for (double times = 2.0; times <= kWidestTimes; times *= 2.0) {
    const SurfaceStatistics wide =
        surface_statistics(pieces, extent, times * spacing_m, on_lines, pool, kSparse * spacing_m);
    // Only what still more places need is worth the reach.
    const double needed = found > 0.0 ? found + kStillMore : kSomeSparse;
    if (wide.flat && wide.sparse_flat_share > needed && sparse_share > kSomeSparse) {
      result.times = times;
      found = wide.sparse_flat_share;
    }
    sparse_share = wide.flat ? wide.sparse_share : 1.0;
  }
  result.scattered = sparse_share > kSomeScattered;
  if (result.times > 1.0) result.wider_share = result.surface.sparse_share;
  result.surface.sparse_share = 0.0;  // wider discs find what is surface
  return result;
}

void find_sides(const OrientedPieces& pieces, const PointTotals& totals, const Extent& extent,
                const OrientedStations& oriented, double spacing_m, double samples, SideEvidence evidence,
                ThreadPool& pool, const std::function<void(std::uint64_t bytes)>& approve, ProjectionPlan& plan) {
  plan.facing_samples = samples;
  if (approve) approve(ProjectionNeeds{0, 0, samples, 0.0}.side_bytes(static_cast<double>(totals.count)));
  auto facing = std::make_shared<FacingField>(pieces, totals, extent, spacing_m, samples,
                                              station_views(oriented, evidence), evidence, pool);
  name_lying_stations(*facing, oriented, plan);
  plan.facing_asked = true;
  if (facing->share_turned_away() <= kMostTurnedAway) plan.facing = std::move(facing);
}

}  // namespace

std::vector<StationView> station_views(const OrientedStations& oriented, SideEvidence evidence) {
  const auto place = [&](const Eigen::Vector3d& p) -> Eigen::Vector3f {
    return ((oriented.scan_to_grid * p.homogeneous()).head<3>() - oriented.origin_m).cast<float>();
  };
  // Normals stay across the surface when it is sheared or scaled.
  const Eigen::Matrix3d of_normals = oriented.scan_to_grid.topLeftCorner<3, 3>().inverse().transpose();
  std::vector<StationView> views;
  for (const Station& station : oriented.stations) {
    StationView& view = views.emplace_back();
    if (evidence == SideEvidence::certain && !is_certain(station)) continue;
    view.normals = !station.normals.empty();
    view.proved = station.proved;
    view.stood = place(station.place_m);
    for (std::size_t k = 0; k < station.seen_m.size(); ++k) {
      view.seen.push_back(place(station.seen_m[k]));
      view.towards.push_back(station.normals.empty()
                                 ? (view.stood - view.seen.back()).normalized()
                                 : (of_normals * station.normals[k].cast<double>()).cast<float>().normalized());
    }
  }
  return views;
}

DiscRule disc_rule(const SurfaceStatistics& surface, bool on_lines) {
  DiscRule rule;
  rule.spacing_m = surface.spacing_m * static_cast<double>(surface.scale);
  rule.noise_m = surface.noise_m;
  rule.lines = on_lines;
  rule.neighbours *= static_cast<int>(surface.scale * surface.scale);
  return rule;
}

ProjectionPlan plan_projection(const OrientedPieces& pieces, const PointTotals& totals, const Extent& extent,
                               const OrientedStations& oriented, bool only_mesh, const scene::GridConfig& config,
                               double resolution_m, ThreadPool& pool,
                               const std::function<void(std::uint64_t bytes)>& approve_sides) {
  const Eigen::Vector3d& origin_m = oriented.origin_m;
  CloudStatistics statistics = sample_cloud(pieces, extent, pool);
  const SpaceStatistics& in_space = statistics.in_space;
  ProjectionPlan plan;
  // Discs, of `space`; of several sides what is seen tells which faces out. False where they would not find the
  // surface, and where it has one side once one looks farther than its noise.
  const auto use_discs = [&](const SpaceStatistics& space, bool on_lines, bool several) {
    const auto [surface, times, wider_share, scattered] =
        uneven_surface(pieces, extent, space.surface_spacing_m, on_lines, pool);
    if (!(surface.spacing_m > 0.0) || surface.sparse_share > kMostSparse || (on_lines && !surface.flat)) {
      plan.sparse_share = surface.sparse_share;
      return false;
    }
    if (several && !on_lines && surface.scale > 1) {
      statistics.in_space = space_statistics(pieces, extent, surface.spacing_m, surface.scale, pool);
      if (!has_several_sides(statistics.in_space, config, extent)) return false;
    }
    statistics.noise_m = surface.noise_m;
    statistics.point_spacing_m = surface.spacing_m;
    plan.front_spacing_m = surface.front_spacing_m;
    plan.discs = disc_rule(surface, on_lines);
    plan.discs->most_spacings *= times;
    plan.discs->scattered = scattered;
    plan.sparse_share = wider_share;
    plan.closed = several;
    if (several || may_show_back(space, oriented.stations)) {
      find_sides(pieces, totals, extent, oriented, surface.spacing_m,
                 facing_samples(space, surface.spacing_m, totals.count),
                 several ? SideEvidence::views : SideEvidence::certain, pool, approve_sides, plan);
    }
    return true;
  };
  if (only_mesh) {
    statistics.noise_m = 0.0;
  } else {
    bool decided = false;
    if (const auto& lines = statistics.on_lines; lines && lines->surface_spacing_m > 0.0) {
      decided = use_discs(*lines, true, has_several_sides(*lines, config, extent));
    }
    if (!decided && has_several_sides(in_space, config, extent)) {
      decided = use_discs(in_space, false, true);
    }
    if (!decided && may_show_back(in_space, oriented.stations)) {
      const double spacing_m = in_space.surface_spacing_m;
      find_sides(pieces, totals, extent, oriented, spacing_m, facing_samples(in_space, spacing_m, totals.count),
                 SideEvidence::certain, pool, approve_sides, plan);
    }
  }
  if (config.noise_m) statistics.noise_m = *config.noise_m;

  plan.origin_m = origin_m;
  plan.layers_apart_m = (plan.discs && plan.discs->lines ? *statistics.on_lines : in_space).layers_apart_m;
  plan.point_spacing_m = statistics.point_spacing_m;
  plan.gap_m = layer_gap_m(statistics.noise_m, statistics.point_spacing_m);
  if (!(plan.front_spacing_m > 0.0)) plan.front_spacing_m = statistics.point_spacing_m;
  plan.lattice = choose_lattice(config, extent, origin_m, plan.front_spacing_m, resolution_m);
  plan.bins = {plan.lattice.nx, plan.lattice.ny, plan.lattice.spacing_m, plan.lattice.origin_m.x() - origin_m.x(),
               plan.lattice.origin_m.y() - origin_m.y()};
  // Of a bin with many points the front has many more than chance brings.
  constexpr double kCrowded = 16.0;  // point spacings between nodes
  if (!only_mesh && (plan.discs || plan.lattice.spacing_m < kCrowded * statistics.point_spacing_m)) {
    const double times = plan.discs ? plan.discs->most_spacings / DiscRule::kMostSpacings : 1.0;
    // What scatters as far as the noise reaches is the surface's own.
    const double apart_m = std::max(statistics.point_spacing_m, statistics.noise_m);
    plan.scatter = find_scatter(pieces, totals, extent, times * apart_m);
  }
  const double finer = statistics.point_spacing_m / plan.lattice.spacing_m;
  plan.rule = {statistics.noise_m, static_cast<int>(std::clamp(std::ceil(6.0 * finer), 3.0, 24.0))};
  return plan;
}

std::uint64_t ProjectionNeeds::side_bytes(double of_points) const {
  return static_cast<std::uint64_t>(std::min(wanted_samples, of_points)) * FacingField::kBytesOfSample;
}

std::uint64_t ProjectionNeeds::kept_side_bytes(double of_points) const {
  return static_cast<std::uint64_t>(std::min(wanted_samples, of_points)) * FacingField::kKeptOfSample;
}

ProjectionNeeds ProjectionPlan::needs(std::uint64_t points) const {
  ProjectionNeeds needs;
  needs.bytes_per_point = bytes_per_point();
  if (discs) needs.column_bytes = kColumnBytes * disc_columns(bins, *discs).bin_count();
  needs.wanted_samples = facing_samples;
  needs.points = static_cast<double>(points);
  return needs;
}

Projection ProjectionPlan::empty_projection() const {
  Projection projection;
  projection.noise_m = rule.noise_m;
  projection.point_spacing_m = front_spacing_m;
  projection.gap_m = gap_m;
  projection.closed = closed;
  projection.discs = discs.has_value();
  projection.sparse_share = sparse_share;
  projection.facing_asked = facing_asked;
  projection.facing_known = facing != nullptr;
  projection.lying_stations = lying_stations;
  projection.lying_normals = lying_normals;
  projection.grid = scene::DepthGrid(lattice);
  return projection;
}

void require_a_measured_node(const scene::DepthGrid& grid) {
  if (std::find(grid.state.begin(), grid.state.end(), scene::NodeState::measured) != grid.state.end()) return;
  throw input_error({}, "no node of the depth grid can be measured: too few points near each other",
                    "four points around a node; a larger grid.spacing_mm, other bounds or another orientation");
}

}  // namespace sparsha::pipeline
