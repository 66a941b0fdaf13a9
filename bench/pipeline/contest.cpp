#include "contest.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include "base/statistics.h"
#include "pcl_mls.h"

namespace sparsha::bench {

std::vector<ContestRow> contest(const std::vector<Contestant>& contestants, int rounds, int slow_rounds) {
  const std::size_t count = contestants.size();
  std::vector<ContestRow> rows(count);
  std::vector<std::vector<double>> ratios(count);
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> seconds(count, -1.0);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t n = (k + static_cast<std::size_t>(round)) % count;
      if (contestants[n].slow && round >= slow_rounds) continue;
      const auto began = std::chrono::steady_clock::now();
      pipeline::DepthGrid grid = contestants[n].run();
      seconds[n] = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
      rows[n].seconds = rows[n].rounds == 0 ? seconds[n] : std::min(rows[n].seconds, seconds[n]);
      ++rows[n].rounds;
      rows[n].grid = std::move(grid);
    }
    for (std::size_t n = 0; n < count; ++n)
      if (seconds[n] >= 0.0) ratios[n].push_back(seconds[n] / seconds[0]);
  }
  for (std::size_t n = 0; n < count; ++n) {
    rows[n].method = contestants[n].method;
    if (ratios[n].empty()) continue;
    rows[n].ratio_low = *std::min_element(ratios[n].begin(), ratios[n].end());
    rows[n].ratio_high = *std::max_element(ratios[n].begin(), ratios[n].end());
    rows[n].ratio = median(ratios[n]);
  }
  return rows;
}

std::vector<Contestant> contestants_of(const pipeline::Cloud& cloud, const std::vector<std::array<double, 3>>& points,
                                       const pipeline::GridConfig& config, double resolution_m,
                                       const pipeline::Lattice& lattice, double point_spacing_m) {
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
    all.push_back({std::string("PCL MLS, ") + name_of(rule), true, [&cloud, lattice, rule, point_spacing_m] {
                     std::vector<std::array<double, 3>> smoothed = by_pcl_mls(cloud, 3.0 * point_spacing_m);
                     for (auto& p : smoothed)
                       for (int axis = 0; axis < 3; ++axis) p[static_cast<std::size_t>(axis)] += cloud.origin_m[axis];
                     return raster(smoothed, lattice, rule);
                   }});
  return all;
}

}  // namespace sparsha::bench
