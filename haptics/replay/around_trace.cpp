#include "haptics/replay/around_trace.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "haptics/around/around_proxy.h"

namespace sparsha::haptics {
namespace {

using Clock = std::chrono::steady_clock;

/// The update in the frame of its sheet, for the judge of rests.
ProxyUpdate on_sheet(const AroundUpdate& found, const SheetSurface& sheet) {
  ProxyUpdate local;
  local.position = sheet.to_local(found.position_m);
  local.normal = sheet.axes.to_chart(found.normal);
  local.contact = found.contact;
  local.sticking = found.sticking;
  local.unfinished = found.unfinished;
  return local;
}

}  // namespace

double distance_away_m(const ObjectSurface& object, const Eigen::Vector3d& place_m) {
  if (!place_m.allFinite()) return 0.0;
  const double distance_m = object.box_m.exteriorDistance(place_m);
  return distance_m > object.box_m.sizes().maxCoeff() ? distance_m : 0.0;
}

TraceResult trace_around(const ObjectSurface& object, const std::vector<HipSample>& path,
                         const Eigen::Matrix4d& scan_from_grid, const scene::HapticsConfig& haptics,
                         const SolverOptions& solver, Progress* progress) {
  SolverOptions options = solver;
  if (haptics.surface == scene::HapticsConfig::Surface::c1) options.shape = CellShape::c1;
  TraceRecorder recorder(path.size(), progress);
  const Eigen::Matrix4d grid_from_scan = scan_from_grid.inverse();
  const Eigen::Matrix3d turn = scan_from_grid.topLeftCorner<3, 3>();
  const double scale = std::cbrt(std::abs(turn.determinant()));
  const Eigen::Matrix3d force_from_grid = turn / scale;
  const auto to_scan = [&](const Eigen::Vector3d& object_m) -> Eigen::Vector3d {
    return turn * (object_m + object.origin_m) + scan_from_grid.topRightCorner<3, 1>();
  };
  AroundSummary around;
  around.sheets = object.charted;
  std::vector<bool> touched(object.charted, false);
  AroundState state;
  for (const HipSample& sample : path) {
    const Eigen::Vector3d hip = (grid_from_scan * sample.position_m.homogeneous()).head<3>() - object.origin_m;
    const Clock::time_point begin = Clock::now();
    const AroundUpdate found = update_around(object, hip, state, options);
    const Clock::time_point end = Clock::now();

    TraceRow row;
    row.t_s = sample.t_s;
    row.hip_m = sample.position_m;
    row.proxy_m = found.position_m == hip ? sample.position_m : to_scan(found.position_m);
    row.force_n = found.contact
                      ? Eigen::Vector3d(haptics.stiffness_n_per_m * (force_from_grid * (found.position_m - hip)))
                      : Eigen::Vector3d::Zero();
    row.contact = found.contact;
    row.tick_ns = std::chrono::duration<double, std::nano>(end - begin).count();
    around.hand_overs += static_cast<std::uint64_t>(found.hand_overs);
    around.edges += static_cast<std::uint64_t>(found.edges);
    around.releases += found.released ? 1 : 0;
    if (found.contact) {
      const SheetSurface& sheet = object.sheets[found.sheet];
      row.sheet = sheet.number;
      touched[sheet.number] = true;
      if (found.in_crease)
        recorder.add(row, found.unfinished);
      else
        recorder.add(row, *sheet.surface, on_sheet(found, sheet), sheet.to_local(hip), options.shape);
    } else {
      recorder.add(row, found.unfinished);
    }
    if (const double away_m = distance_away_m(object, hip); away_m > 0.0) recorder.outside(scale * away_m, true);
  }
  around.touched = static_cast<std::uint64_t>(std::count(touched.begin(), touched.end(), true));
  TraceResult result = std::move(recorder).finish();
  result.summary.around = around;
  return result;
}

}  // namespace sparsha::haptics
