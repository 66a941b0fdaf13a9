// The same functions as a build's: projection, fill and cross-check.
#include "pipeline/suggest/trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/text/text.h"
#include "pipeline/check/check.h"
#include "pipeline/layers/layers.h"
#include "scene/config/filters.h"
#include "scene/config/grid.h"
#include "scene/config/layers.h"
#include "scene/config/orientation.h"

namespace sparsha::pipeline {
namespace {

constexpr double kRoom = 0.9;     // of a limit: the build rounds spacings and judges more points
constexpr double kFewest = 16.0;  // measured nodes: less is no surface
constexpr double kMostNodes = 16.0 * 1024.0 * 1024.0;
constexpr std::int64_t kCheckSamples = 20'000;

}  // namespace

void TrialCloud::add(const ScanStatistics& statistics, double metres) {
  const RawScan& scan = statistics.scan;
  all_ += std::max<std::uint64_t>(scan.points.size(), scan.records - std::min(scan.records, scan.invalid));
  kept_ += scan.points.size();
  ++scans_;
  if (scan.cell) ++rasters_;
  spacing_m_ = std::max(spacing_m_, statistics.spacing * metres);
  if (scan.faces.empty()) {
    for (const Eigen::Vector3d& p : scan.points) loose_m_.add(p * metres);
    for (const SeenStation& seen : statistics.stations) {
      Station& station = stations_.emplace_back(Station{{}, true, seen.place * metres, seen.sample.points(), {}, true});
      for (Eigen::Vector3d& p : station.seen_m) p *= metres;
    }
    return;
  }
  const auto first = static_cast<std::uint32_t>(corners_m_.size());
  for (const Eigen::Vector3d& p : scan.points) corners_m_.emplace_back(p * metres);
  for (const auto& [a, b, c] : scan.faces) faces_.push_back({a + first, b + first, c + first});
}

void TrialCloud::crop(const scene::CropConfig& box) {
  PointSample kept(kMostPoints);
  for (const Eigen::Vector3d& p : loose_m_.points()) {
    if ((p.array() >= box.min_m.array()).all() && (p.array() <= box.max_m.array()).all()) kept.add(p);
  }
  loose_m_ = std::move(kept);
}

void TrialCloud::take_away(const FloorsAndWalls& around) {
  PointSample kept(kMostPoints);
  for (const Eigen::Vector3d& p : loose_m_.points()) {
    if (around.keeps(p)) kept.add(p);
  }
  loose_m_ = std::move(kept);
}

double TrialCloud::share() const {
  const auto most = static_cast<double>(corners_m_.size() + kMostPoints);
  return std::min(static_cast<double>(kept_), most) / std::max(1.0, static_cast<double>(all_));
}

double TrialCloud::neighbour_m() const {
  if (scans_ < 2 || has_faces()) return spacing_m_;
  return median_spacing(loose_m_.points()) * std::sqrt(share());  // scans that overlap are denser together
}

Cloud TrialCloud::finish() {
  Cloud cloud;
  std::vector<Eigen::Vector3d> points_m = loose_m_.points();
  PointSample sample;
  for (const auto* part : {&corners_m_, &points_m}) {
    for (const Eigen::Vector3d& p : *part) sample.add(p);
  }
  cloud.origin_m = common_origin(sample);
  cloud.stations = std::move(stations_);
  cloud.resize_points(corners_m_.size() + points_m.size());
  constexpr auto kGone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> place(corners_m_.size(), kGone);
  std::uint32_t count = 0;
  const auto keep = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3f q = (p - cloud.origin_m).cast<float>();
    if (!(q.cwiseAbs().maxCoeff() < 1e30F)) return kGone;
    std::copy_n(q.data(), 3, cloud.xyz1() + 4 * static_cast<std::size_t>(count));
    return count++;
  };
  for (std::size_t n = 0; n < corners_m_.size(); ++n) place[n] = keep(corners_m_[n]);
  for (const Eigen::Vector3d& p : points_m) (void)keep(p);
  cloud.resize_points(count);
  for (const auto& [a, b, c] : faces_) {
    if (place[a] != kGone && place[b] != kGone && place[c] != kGone) {
      cloud.faces.push_back({place[a], place[b], place[c]});
    }
  }
  corners_m_ = {};
  faces_ = {};
  loose_m_ = PointSample();
  return cloud;
}

std::string Trial::complaint() const {
  if (!error.empty()) return error;
  if (measured < kFewest) return fmt::format("only {:.0f} nodes of the grid can be measured", measured);
  if (doubts.unproven) return "no four measured nodes lie side by side: there is no surface to compare the points with";
  if (doubts.not_theirs || (!fits && !doubts.fine && !doubts.far)) {
    return fmt::format("{} farther than {} from the surface, and the grid spacing is {}", half_of(against),
                       length_text(median_m), length_text(spacing_m));
  }
  if (doubts.far) {
    return fmt::format("{} farther than {} from the surface, and noise explains {}", half_of(against),
                       length_text(median_m), length_text(doubts.explained_m));
  }
  if (doubts.fine) {
    return fmt::format("the grid spacing, {}, is much finer than the points, which are {} apart",
                       length_text(spacing_m), length_text(point_spacing_m));
  }
  if (doubts.unfacing) return "much of what is seen first seems to face away";
  if (doubts.noisy) {
    return fmt::format("the noise, {}, is more than half the distance between points, {}", length_text(noise_m),
                       length_text(point_spacing_m));
  }
  return {};
}

Trials::Trials(TrialCloud& points, double resolution_m, Progress& progress)
    : pool_(0), resolution_m_(resolution_m), progress_(progress), cloud_(points.finish()) {
  if (cloud_.size() > 0) projector_.emplace(cloud_, pool_);
}

Trial Trials::run(const View& view, double spacing_m) { return run(view, spacing_m, {}); }

Trial Trials::run_at_own_spacing(const View& view, double least_m) {
  struct TooFine {};
  constexpr double kClearly = 1.2;
  try {
    return run(view, 0.0, [&](const scene::Lattice& lattice) {
      if (kClearly * lattice.spacing_m < least_m) throw TooFine();
    });
  } catch (const TooFine&) {
    return run(view, least_m);
  }
}

Trial Trials::run(const View& view, double spacing_m, const std::function<void(const scene::Lattice&)>& approve) {
  Trial trial;
  trial.view = view;
  trial.spacing_m = spacing_m;
  if (!projector_) {
    trial.error = "no point lies within reach of the others";
    return trial;
  }
  try {
    scene::GridConfig grid;
    grid.spacing_m = spacing_m;
    const Eigen::Matrix4d scan_to_grid = scene::look_from(view.look_from, view.up, 1.0);
    Projection projection = projector_->project(
        scan_to_grid, grid, resolution_m_, {pool_, progress_},
        {{}, [&](const scene::Lattice& lattice, const ProjectionNeeds&) {
           if (approve) approve(lattice);
           if (static_cast<double>(lattice.count()) <= kMostNodes) return;
           throw usage_error(fmt::format("the grid would have {} x {} nodes", lattice.nx, lattice.ny));
         }});
    const scene::Lattice lattice = projection.grid.lattice;
    trial.measured = static_cast<double>(
        std::count(projection.grid.state.begin(), projection.grid.state.end(), scene::NodeState::measured));
    const scene::FillConfig fill{5.0 * lattice.spacing_m};
    fill_gaps(projection.grid, fill, projection.gap_m, pool_);
    Progress quiet;  // its fractions are not those of the trials
    const CheckResult check =
        cross_check(cloud_, scan_to_grid, projection, fill, scene::CheckConfig{kCheckSamples}, {pool_, quiet});
    progress_.throw_if_cancelled();
    trial.against = check.against;
    trial.doubts = surface_doubts(projection, lattice, check);
    trial.spacing_m = lattice.spacing_m;
    trial.point_spacing_m = projection.point_spacing_m;
    trial.noise_m = projection.noise_m;
    trial.median_m = check.cloud_to_surface.median_m;
    trial.nodes = static_cast<double>(lattice.count());
    trial.seen = static_cast<double>(projection.used);
    trial.coverage = trial.measured / trial.nodes;
    trial.area_m2 = trial.measured * lattice.spacing_m * lattice.spacing_m;
    trial.fits = !trial.doubts.fine && check.cloud_to_surface.samples > 0 && trial.measured >= kFewest &&
                 trial.median_m <= kRoom * lattice.spacing_m &&
                 (projection.only_mesh || trial.median_m <= kRoom * trial.doubts.explained_m);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    trial.error = error.wrong();
  }
  return trial;
}

}  // namespace sparsha::pipeline
