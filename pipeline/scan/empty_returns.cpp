// Counted first: only where they are many are they what a camera writes.
#include "pipeline/scan/empty_returns.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "base/numbers/statistics.h"
#include "pipeline/scan/drop.h"

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

/// Flags the vertices at 0 0 0 when they are many and stand far from those that faces join them to.
std::vector<bool> flag_spikes(const RawScan& scan) {
  constexpr std::uint64_t kFewest = 4;
  constexpr double kFar = 4.0;  // median edges
  std::vector<bool> at_zero(scan.points.size());
  for (std::size_t i = 0; i < at_zero.size(); ++i) at_zero[i] = is_at_scanner(scan.points[i], std::nullopt);
  const auto count = static_cast<std::uint64_t>(std::count(at_zero.begin(), at_zero.end(), true));
  // Where triangles share no vertices, one place has many.
  const bool shared = 2 * scan.faces.size() > at_zero.size() - count;
  if (!shared || count < kFewest || count <= at_zero.size() / kOneIn) return std::vector<bool>(at_zero.size(), false);
  std::vector<double> to_zero;
  std::vector<double> others;
  for (const auto& face : scan.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = face[k];
      const std::uint32_t b = face[(k + 1) % 3];
      const double length = (scan.points[a] - scan.points[b]).norm();
      if (length > 0.0) (at_zero[a] || at_zero[b] ? to_zero : others).push_back(length);
    }
  }
  const bool spikes = to_zero.empty() || (!others.empty() && median(to_zero) > kFar * median(others));
  return spikes ? at_zero : std::vector<bool>(at_zero.size(), false);
}

/// Flags the vertices of no face.
std::vector<bool> flag_unused(const RawScan& scan) {
  std::vector<bool> unused(scan.points.size(), true);
  for (const auto& face : scan.faces) {
    for (const std::uint32_t v : face) unused[v] = false;
  }
  return unused;
}

std::uint64_t count_of(const std::vector<bool>& flags) {
  return static_cast<std::uint64_t>(std::count(flags.begin(), flags.end(), true));
}

void drop_from_mesh(RawScan& scan) {
  std::vector<bool> gone = flag_spikes(scan);
  if (const std::uint64_t zeros = count_of(gone); zeros > 0) {
    const std::size_t before = scan.faces.size();
    std::erase_if(scan.faces, [&](const auto& face) {
      return std::any_of(face.begin(), face.end(), [&](std::uint32_t v) { return gone[v]; });
    });
    scan.warnings.push_back(fmt::format(
        "{} of {} vertices stand at 0 0 0, far from their neighbours, as depth cameras write them where they saw "
        "nothing; they and the {} faces on them are left out, which leaves holes",
        zeros, gone.size(), before - scan.faces.size()));
  }
  const std::vector<bool> unused = flag_unused(scan);
  const std::uint64_t loose = count_of(unused) - count_of(gone);
  if (loose > 0 && 2 * loose > gone.size()) {
    scan.warnings.push_back(fmt::format("{} of {} vertices belong to no face; they are taken as points beside the mesh",
                                        loose, gone.size()));
  } else if (loose > 0) {
    scan.warnings.push_back(fmt::format("{} of {} vertices belong to no face; they are left out", loose, gone.size()));
    gone = unused;
  }
  const std::uint64_t all = count_of(gone);
  if (all == 0) return;
  scan.invalid += all;
  drop_points(scan, gone);
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

void drop_what_is_no_surface(RawScan& scan) {
  if (!scan.faces.empty()) {
    drop_from_mesh(scan);
    return;
  }
  const std::vector<bool> gone = flag_points_at_scanner(scan);
  const std::uint64_t count = count_of(gone);
  if (!are_empty_returns(count, gone.size())) return;
  scan.warnings.push_back(empty_returns_warning(count, gone.size()));
  scan.invalid += count;
  drop_points(scan, gone);
}

}  // namespace sparsha::pipeline
