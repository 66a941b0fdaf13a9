// Counted first: only where they are many are they what a camera writes.
#include "pipeline/scan/empty_returns.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

namespace sparsha::pipeline {
namespace {

constexpr std::uint64_t kMostAtOrigin = 16;
constexpr std::uint64_t kOneIn = 1000;

// One flag per point of a scan in memory.
std::vector<bool> flag_points_at_scanner(const RawScan& scan) {
  std::vector<bool> at_scanner(scan.points.size());
  const std::optional<Eigen::Vector3d> unknown;
  const std::optional<Eigen::Vector3d>* station = &unknown;
  std::size_t next = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    while (next < scan.stations.size() && scan.stations[next].first <= i) station = &scan.stations[next++].place;
    at_scanner[i] = is_at_scanner(scan.points[i], *station);
  }
  return at_scanner;
}

template <typename T>
void keep_others(const std::vector<bool>& gone, std::vector<T>& values) {
  if (values.empty()) return;
  std::size_t to = 0;
  for (std::size_t i = 0; i < gone.size(); ++i) {
    if (!gone[i]) values[to++] = values[i];
  }
  values.resize(to);
}

}  // namespace

bool are_empty_returns(std::uint64_t at_scanner, std::uint64_t points) {
  return at_scanner > kMostAtOrigin && at_scanner > points / kOneIn;
}

std::string empty_returns_warning(std::uint64_t at_scanner, std::uint64_t points) {
  return fmt::format(
      "{} of {} points stand at 0 0 0, which depth cameras write where they saw nothing; they are counted as invalid",
      at_scanner, points);
}

void drop_empty_returns(RawScan& scan) {
  if (!scan.faces.empty()) return;
  const std::vector<bool> gone = flag_points_at_scanner(scan);
  const auto count = static_cast<std::uint64_t>(std::count(gone.begin(), gone.end(), true));
  if (!are_empty_returns(count, gone.size())) return;
  scan.warnings.push_back(empty_returns_warning(count, gone.size()));
  scan.invalid += count;
  std::size_t before = 0;
  std::size_t seen = 0;
  for (RawStation& station : scan.stations) {
    for (; seen < station.first; ++seen) before += gone[seen] ? 1 : 0;
    station.first -= before;
  }
  keep_others(gone, scan.points);
  keep_others(gone, scan.rgba);
  keep_others(gone, scan.intensity);
  keep_others(gone, scan.normals);
}

}  // namespace sparsha::pipeline
