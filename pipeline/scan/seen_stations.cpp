#include "pipeline/scan/seen_stations.h"

#include <cstddef>
#include <span>

#include "pipeline/scan/empty_returns.h"

namespace sparsha::pipeline {

void add_to_stations(const PointBlock& block, std::vector<SeenStation>& stations) {
  constexpr std::size_t kMost = 256;
  if (!block.station) return;
  if (stations.empty() || stations.back().place != *block.station) {
    if (stations.size() == kMost) return;
    stations.push_back({*block.station, PointSample(), PointSample(), {}});
  }
  SeenStation& station = stations.back();
  for (const Eigen::Vector3d& p : block.points)
    (is_at_scanner(p, block.station) ? station.at_scanner : station.sample).add(p);
  station.steps.add(block.points, station.place);
}

void add_to_stations(const RawScan& scan, std::vector<SeenStation>& stations) {
  const std::span points(scan.points);
  for (std::size_t s = 0; s < scan.stations.size(); ++s) {
    const std::size_t first = scan.stations[s].first;
    const std::size_t end = s + 1 < scan.stations.size() ? scan.stations[s + 1].first : points.size();
    add_to_stations({points.subspan(first, end - first), {}, {}, scan.stations[s].place, {}}, stations);
  }
}

}  // namespace sparsha::pipeline
