#include "bench/pipeline/contest.h"

#include <memory>
#include <utility>

#include "bench/pipeline/pcl_mls.h"
#include "bench/report/turns.h"

namespace sparsha::bench {

std::vector<ContestRow> contest(const std::vector<Contestant>& contestants, int rounds, int slow_rounds) {
  std::vector<ContestRow> rows(contestants.size());
  std::vector<Turn> methods;
  for (std::size_t n = 0; n < rows.size(); ++n)
    methods.push_back({[&own = contestants[n], &grid = rows[n].grid] {
                         scene::DepthGrid heights;
                         const double seconds = seconds_of([&] { heights = own.run(); });
                         grid = std::move(heights);
                         return seconds;
                       },
                       contestants[n].slow});
  const std::vector<TurnTimes> taken = take_turns(methods, rounds, slow_rounds);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    rows[n].method = contestants[n].method;
    rows[n].rounds = static_cast<int>(taken[n].times.size());
    rows[n].seconds = taken[n].best();
    rows[n].ratio = taken[n].ratio;
    rows[n].ratio_low = taken[n].ratio_low;
    rows[n].ratio_high = taken[n].ratio_high;
  }
  return rows;
}

std::vector<Contestant> contestants_of(const pipeline::Cloud& cloud, const std::vector<std::array<double, 3>>& points,
                                       const scene::GridConfig& config, double resolution_m,
                                       const scene::Lattice& lattice, double point_spacing_m) {
  std::vector<Contestant> all;
  const auto pool = std::make_shared<ThreadPool>(1);
  all.push_back(
      {"sparsha", false, [&cloud, config, resolution_m, pool] {
         Progress progress;
         return pipeline::project(cloud, Eigen::Matrix4d::Identity(), config, resolution_m, {*pool, progress}).grid;
       }});
  for (const RasterRule rule : {RasterRule::max, RasterRule::mean, RasterRule::median, RasterRule::inverse_distance})
    all.push_back({name_of(rule), false, [&points, lattice, rule] { return raster(points, lattice, rule); }});
  for (const RasterRule rule : {RasterRule::mean, RasterRule::max})
    all.push_back({std::string("PCL MLS + ") + name_of(rule), true, [&cloud, lattice, rule, point_spacing_m] {
                     std::vector<std::array<double, 3>> smoothed = by_pcl_mls(cloud, 3.0 * point_spacing_m);
                     for (auto& p : smoothed)
                       for (int axis = 0; axis < 3; ++axis) p[static_cast<std::size_t>(axis)] += cloud.origin_m[axis];
                     return raster(smoothed, lattice, rule);
                   }});
  return all;
}

}  // namespace sparsha::bench
