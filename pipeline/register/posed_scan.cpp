// Scans are streamed twice, for their extent and for their voxels, so that memory grows with the voxels only.
#include "pipeline/register/posed_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include <fmt/format.h>

#include "base/error.h"
#include "base/files/files.h"
#include "base/numbers/statistics.h"
#include "pipeline/scan/empty_scan.h"
#include "pipeline/scan/origin.h"
#include "pipeline/scan/set.h"
#include "scene/config/config.h"

namespace sparsha::pipeline {
namespace {

constexpr double kInside = 0.01;             // rank at which the box around the points begins
constexpr double kFinestShare = 1.0 / 3000;  // of the longest side: the finest automatic voxel
constexpr double kOutsideSides = 1.5;        // longest sides from the middle beyond which a pose's origin is accepted
constexpr std::size_t kLeastElements = 50;

// The box between the ranks kInside and 1 - kInside along each axis.
struct Extent {
  Eigen::Vector3d low_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d high_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
  double longest_m = 0.0;

  // Strays far away say nothing of a pose, but each keeps a voxel of its own, and moves far when the scan turns.
  [[nodiscard]] bool is_near(const Eigen::Vector3d& p) const {
    return (p.array() >= low_m.array() - longest_m).all() && (p.array() <= high_m.array() + longest_m).all();
  }
};

Extent extent_of(const ScanSet& set, Progress& progress) {
  PointSample sample;
  set.stream(
      [&](const CloudBlock& block) {
        for (const Eigen::Vector3f& p : block.points) sample.add(p.cast<double>());
      },
      progress);
  const std::vector<Eigen::Vector3d> points = sample.points();
  Extent extent;
  for (int axis = 0; axis < 3; ++axis) {
    extent.low_m[axis] = coordinate_quantile(points, axis, kInside);
    extent.high_m[axis] = coordinate_quantile(points, axis, 1.0 - kInside);
  }
  extent.middle_m = 0.5 * (extent.low_m + extent.high_m);
  extent.longest_m = (extent.high_m - extent.low_m).maxCoeff();
  return extent;
}

// Where the scanner stood, in the scan's coordinates relative to its origin: as the file says, else the origin of
// coordinates that a pose moves, when it lies outside of the scan. Several places in one file are none.
std::optional<Eigen::Vector3d> place_of(const ScanSet& set, const scene::ScanConfig& config, const Extent& extent,
                                        bool trusted) {
  const std::vector<Station> stations = set.stations();
  if (stations.size() > 1) return std::nullopt;
  if (stations.size() == 1) return stations.front().place_m - set.origin_m();
  if (!trusted || config.pose.isIdentity(0.0)) return std::nullopt;
  const Eigen::Vector3d place = -set.origin_m();
  if ((place - extent.middle_m).norm() < kOutsideSides * extent.longest_m) return std::nullopt;
  return place;
}

// Whether a scanner at the origin of coordinates can have seen all of a surface that lies around it: in each direction
// there is one depth. Where two stations' points lie in one file, or the place is another, walls stand before walls. An
// object beside the origin, or one side of an object about it, has one depth too, but lies in half of the directions.
bool seen_from_within(const StationSurface& surface, const Eigen::Vector3d& place) {
  constexpr double kCells = 14.0;          // along a unit of direction: 4 degrees
  constexpr double kNotGrazing = 0.5;      // cosine
  constexpr double kOneDepth = 0.75;       // nearest over farthest in a direction
  constexpr double kLeastShare = 0.9;      // of the directions with several elements: of a hall 0.94 to 0.97
  constexpr std::size_t kLeastCells = 50;  // of them
  constexpr double kLeastBehind = 0.1;     // of those, on the other side than most; of a closed room about 0.5
  struct Depths {
    double nearest_m = std::numeric_limits<double>::infinity();
    double farthest_m = 0.0;
    int count = 0;
  };
  std::map<std::array<int, 3>, Depths> cells;
  for (const StationSurface::Element& element : surface.elements()) {
    const Eigen::Vector3d ray = element.point - place;
    const double depth_m = ray.norm();
    if (!(std::fabs(element.normal.dot(ray)) > kNotGrazing * depth_m)) continue;
    const Eigen::Vector3d at = (kCells * ray / depth_m).array().round();
    Depths& depths = cells[{static_cast<int>(at.x()), static_cast<int>(at.y()), static_cast<int>(at.z())}];
    depths.nearest_m = std::min(depths.nearest_m, depth_m);
    depths.farthest_m = std::max(depths.farthest_m, depth_m);
    ++depths.count;
  }
  std::size_t several = 0;
  std::size_t one = 0;
  std::vector<Eigen::Vector3d> directions;
  Eigen::Vector3d most = Eigen::Vector3d::Zero();
  for (const auto& [cell, depths] : cells) {
    if (depths.count < 2) continue;
    ++several;
    if (!(depths.nearest_m > kOneDepth * depths.farthest_m)) continue;
    ++one;
    directions.push_back(Eigen::Vector3d(cell[0], cell[1], cell[2]).normalized());
    most += directions.back();
  }
  const auto behind = std::ranges::count_if(directions, [&](const Eigen::Vector3d& d) { return d.dot(most) < 0.0; });
  return several >= kLeastCells && static_cast<double>(one) >= kLeastShare * static_cast<double>(several) &&
         static_cast<double>(behind) >= kLeastBehind * static_cast<double>(one);
}

// Where somebody far away would stand to see all of the surface: a scan from one place that nobody knows. Its side is
// the one to which the surface bulges. Nothing for a surface that has more than one side, or no side.
std::optional<Eigen::Vector3d> guessed_place(const StationSurface& surface, const Extent& extent) {
  constexpr int kRounds = 10;
  constexpr double kLeastSeen = 0.98;   // share of elements that do not lie edge-on
  constexpr double kEdgeOn = 0.1;       // cosine
  constexpr double kLeastBulge = 0.05;  // mean of normal times direction from the middle
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  std::vector<const StationSurface::Element*> elements;
  for (const StationSurface::Element& element : surface.elements()) {
    if (element.normal.isZero(0.0)) continue;
    elements.push_back(&element);
    middle += element.point;
  }
  if (elements.empty()) return std::nullopt;
  middle /= static_cast<double>(elements.size());
  Eigen::Vector3d view = Eigen::Vector3d::Zero();
  double best = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
    double seen = 0.0;
    for (int round = 0; round < kRounds; ++round) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const StationSurface::Element* e : elements) sum += e->normal.dot(direction) < 0.0 ? -e->normal : e->normal;
      seen = sum.norm();
      direction = sum.normalized();
    }
    if (seen > best) {
      best = seen;
      view = direction;
    }
  }
  std::size_t seen = 0;
  double bulge = 0.0;
  for (const StationSurface::Element* e : elements) {
    const double cosine = e->normal.dot(view);
    if (std::fabs(cosine) > kEdgeOn) ++seen;
    bulge += (cosine < 0.0 ? -1.0 : 1.0) * e->normal.dot((e->point - middle).normalized());
  }
  bulge /= static_cast<double>(elements.size());
  if (static_cast<double>(seen) < kLeastSeen * static_cast<double>(elements.size())) return std::nullopt;
  if (std::fabs(bulge) < kLeastBulge) return std::nullopt;
  return extent.middle_m + (bulge < 0.0 ? -1e3 : 1e3) * extent.longest_m * view;
}

// A leaf that evens out a scan from one station, whose points lie hundreds of times denser near it than far away: the
// median spacing would be that of the nearest walls, and what lies beyond would count as no surface.
double even_leaf_m(const std::vector<Eigen::Vector3d>& points, double least_m) {
  constexpr double kFar = 0.9;     // rank of the spacings that count
  constexpr double kEven = 0.5;    // of these
  constexpr double kUneven = 3.0;  // medians: an even scan has no spacing beyond
  std::vector<double> spacings = nearest_distances(thinned_to(points, kFinePoints, least_m));
  if (spacings.empty()) return least_m;
  const double far_m = sparsha::quantile(spacings, kFar);
  return far_m > kUneven * median(spacings) ? std::max(least_m, kEven * far_m) : least_m;
}

PosedScan read_one(const scene::ScanConfig& config, double voxel_m, bool trusted, const Context& context) {
  PosedScan scan;
  scan.name = config.file.string();
  scene::ScanConfig unposed = config;
  unposed.pose.setIdentity();
  const ScanSet set({unposed}, ScanSet::Keep::quickest, false, context.progress);
  scan.origin_m = set.origin_m();
  const Extent extent = extent_of(set, context.progress);
  scan.longest_m = extent.longest_m;
  if (!(extent.longest_m > 0.0)) {
    throw input_error(scan.name, "the points of the scan lie in one place, which cannot be registered", "a surface");
  }
  const double leaf_m = voxel_m > 0.0 ? voxel_m : extent.longest_m * kFinestShare;
  VoxelMeans means(leaf_m);
  set.stream(
      [&](const CloudBlock& block) {
        for (const Eigen::Vector3f& point : block.points) {
          const Eigen::Vector3d p = point.cast<double>();
          if (extent.is_near(p)) means.add(p);
        }
      },
      context.progress);
  std::optional<Eigen::Vector3d> place = place_of(set, config, extent, trusted);
  std::vector<Eigen::Vector3d> points = means.points();
  if (!(voxel_m > 0.0)) points = thinned(points, even_leaf_m(points, leaf_m));
  const auto make = [&](std::size_t most) {
    points = thinned_to(points, most, leaf_m);
    return std::make_unique<StationSurface>(points, place, context);
  };
  scan.middle_m = extent.middle_m;
  if (!place) {
    const StationSurface surface(thinned_to(points, kMediumPoints, leaf_m), std::nullopt, context);
    if (trusted && set.stations().empty() && seen_from_within(surface, -set.origin_m())) place = -set.origin_m();
    if (!place) place = guessed_place(surface, extent);
    if (place) scan.guessed_view = (*place - extent.middle_m).normalized();
  }
  scan.place = place;
  scan.fine = make(voxel_m > 0.0 ? points.size() : kFinePoints);
  scan.medium = make(kMediumPoints);
  scan.coarse = make(kCoarsePoints);
  const auto& elements = scan.medium->elements();
  const auto planes = std::count_if(elements.begin(), elements.end(),
                                    [](const StationSurface::Element& e) { return !e.normal.isZero(0.0); });
  if (static_cast<std::size_t>(planes) < kLeastElements) {
    throw input_error(
        scan.name,
        fmt::format("only {} of {} thinned points lie on a surface, too few to be registered", planes, elements.size()),
        fmt::format("at least {}; denser points or a smaller register.voxel_mm", kLeastElements));
  }
  return scan;
}

}  // namespace

std::string digest_of(const PosedScan& scan) {
  std::vector<double> numbers;
  const auto add = [&](const Eigen::Vector3d& v) { numbers.insert(numbers.end(), v.begin(), v.end()); };
  add(scan.middle_m);
  add(scan.guessed_view);
  add(scan.place.value_or(Eigen::Vector3d::Zero()));
  numbers.insert(numbers.end(), {scan.longest_m, scan.place ? 1.0 : 0.0});
  for (const StationSurface* surface : {scan.fine.get(), scan.medium.get(), scan.coarse.get()}) {
    const StationSurface& level = *surface;
    numbers.insert(numbers.end(), {level.spacing_m(), level.roughness_m(), level.signed_normals() ? 1.0 : 0.0,
                                   static_cast<double>(level.elements().size())});
    for (const StationSurface::Element& element : level.elements()) {
      add(element.point);
      add(element.normal);
      numbers.push_back(element.border ? 1.0 : 0.0);
    }
  }
  return sha256(std::as_bytes(std::span<const double>(numbers)));
}

// The scans of one object lie behind each other's surfaces, as seen from where they were made.
void turn_views(std::vector<PosedScan>& scans) {
  constexpr double kClear = 0.1;  // longest sides by which the others lie in front
  for (PosedScan& scan : scans) {
    if (scan.guessed_view.isZero(0.0)) continue;
    Eigen::Vector3d others = Eigen::Vector3d::Zero();
    for (const PosedScan& other : scans)
      if (&other != &scan) others += other.pose * other.middle_m;
    others /= static_cast<double>(std::max<std::size_t>(1, scans.size() - 1));
    const double in_front = (scan.pose.linear() * scan.guessed_view).dot(others - scan.pose * scan.middle_m);
    if (in_front < kClear * scan.longest_m) continue;
    for (StationSurface* surface : {scan.fine.get(), scan.medium.get(), scan.coarse.get()}) surface->flip();
    scan.guessed_view = -scan.guessed_view;
    scan.place = 2.0 * scan.middle_m - *scan.place;
  }
}

double PosedScans::longest_m() const {
  double longest = 0.0;
  for (const PosedScan& scan : scans) longest = std::max(longest, scan.longest_m);
  return longest;
}

double PosedScans::spacing_m(std::unique_ptr<StationSurface> PosedScan::*level) const {
  double spacing = 0.0;
  for (const PosedScan& scan : scans) spacing = std::max(spacing, (scan.*level)->spacing_m());
  return spacing;
}

Eigen::Matrix4d PosedScans::pose_of(std::size_t scan, const Eigen::Isometry3d& pose) const {
  Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
  result.topLeftCorner<3, 3>() = pose.linear();
  result.topRightCorner<3, 1>() = pose.translation() + origin_m - pose.linear() * scans[scan].origin_m;
  return result;
}

PosedScans read_posed_scans(const std::vector<scene::ScanConfig>& scans, double voxel_m, bool trusted,
                            const Context& context) {
  PosedScans result;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    try {
      result.scans.push_back(read_one(scans[s], voxel_m, trusted, context));
      result.places.push_back(s);
    } catch (const EmptyScan& empty) {
      context.progress.warn(left_out_warning(empty));
    }
    context.progress.at(static_cast<double>(s + 1) / static_cast<double>(scans.size()));
  }
  for (std::size_t k = 0; k < result.scans.size(); ++k) {
    PosedScan& scan = result.scans[k];
    const Eigen::Affine3d given(scans[result.places[k]].pose);
    const Eigen::Vector3d place = given * scan.origin_m;
    if (k == 0) result.origin_m = place;
    scan.pose.linear() = given.rotation();  // the nearest: a matrix of a configuration is rigid to three digits only
    scan.pose.translation() = place - result.origin_m;
  }
  if (trusted) turn_views(result.scans);
  return result;
}

}  // namespace sparsha::pipeline
