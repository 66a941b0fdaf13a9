// Counted first: only where they are many are they what a camera writes.
#include "pipeline/scan/empty_returns.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>

#include "base/numbers/hash.h"
#include "base/numbers/statistics.h"
#include "pipeline/scan/drop.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint64_t kMostAtOrigin = 16;  // of which one in a thousand is chance no more
constexpr std::uint64_t kOneIn = 1000;
constexpr std::uint64_t kMostAtOriginOfFew = 3;  // of which one in a hundred is
constexpr std::uint64_t kOneInOfFew = 100;

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

double edge_length(const RawScan& scan, const std::array<std::uint32_t, 3>& face, std::size_t k) {
  return (scan.points[face[k]] - scan.points[face[(k + 1) % 3]]).norm();
}

/// Median of some edges, those of no length left out; 0 when there are none.
double usual_edge(const RawScan& scan) {
  constexpr std::size_t kFaces = 1U << 16;
  const std::size_t stride = 1 + scan.faces.size() / kFaces;
  std::vector<double> lengths;
  for (std::size_t f = 0; f < scan.faces.size(); f += stride) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (const double length = edge_length(scan, scan.faces[f], k); length > 0.0) lengths.push_back(length);
    }
  }
  return lengths.empty() ? 0.0 : median(lengths);
}

/// Places where vertices of a sample lie together within `apart`, the fullest first.
std::vector<Eigen::Vector3d> crowded_places(const RawScan& scan, double apart) {
  constexpr std::size_t kSampled = 1U << 16;
  constexpr std::uint64_t kFewest = 2;
  constexpr std::size_t kMostPlaces = 8;
  using Cell = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Cell& cell) const { return static_cast<std::size_t>(hash_cell(cell)); }
  };
  struct Crowd {
    std::size_t first = 0;  ///< vertex
    std::uint64_t count = 0;
  };
  std::unordered_map<Cell, Crowd, Hash> crowds;
  const std::size_t stride = (scan.points.size() / kSampled) | 1U;
  for (std::size_t i = 0; i < scan.points.size(); i += stride) {
    const Eigen::Array3d cell = ((scan.points[i] - scan.points[0]).array() / apart).floor();
    if (!(cell.abs() < 9e18).all()) continue;
    Crowd& crowd = crowds[{static_cast<std::int64_t>(cell[0]), static_cast<std::int64_t>(cell[1]),
                           static_cast<std::int64_t>(cell[2])}];
    if (crowd.count++ == 0) crowd.first = i;
  }
  std::vector<Crowd> fullest;
  const std::uint64_t least = std::max<std::uint64_t>(kFewest, scan.points.size() / stride / (8 * kOneIn));
  for (const auto& [cell, crowd] : crowds) {
    if (crowd.count >= least) fullest.push_back(crowd);
  }
  std::sort(fullest.begin(), fullest.end(),
            [](const Crowd& a, const Crowd& b) { return a.count != b.count ? a.count > b.count : a.first < b.first; });
  if (fullest.size() > kMostPlaces) fullest.resize(kMostPlaces);
  std::vector<Eigen::Vector3d> places;
  for (const Crowd& crowd : fullest) places.push_back(scan.points[crowd.first]);
  return places;
}

/// Whether vertices at one place make spikes: they are many, stand far, in usual edges, from those that faces join them
/// to, and fill a hole or each have faces all around. The copies of a cone's apex have one or two faces each.
bool are_spikes(const RawScan& scan, const std::vector<bool>& there, double far, bool at_zero) {
  constexpr std::uint64_t kFewest = 4;
  constexpr double kFewestFaces = 2.5;
  const auto count = static_cast<std::uint64_t>(std::count(there.begin(), there.end(), true));
  // Where triangles share no vertices, one place has many.
  const bool shared = 2 * scan.faces.size() > there.size() - count;
  if (!shared || count < kFewest || count <= there.size() / kOneIn) return false;
  std::vector<double> to_place;
  std::vector<double> others;
  std::uint64_t within = 0;    // faces
  std::uint64_t touching = 0;  // not within
  for (const auto& face : scan.faces) {
    const int corners = int{there[face[0]]} + int{there[face[1]]} + int{there[face[2]]};
    within += corners == 3 ? 1 : 0;
    touching += corners == 1 || corners == 2 ? 1 : 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const bool from = there[face[k]];
      const bool to = there[face[(k + 1) % 3]];
      const double length = edge_length(scan, face, k);
      if (length > 0.0 && !(from && to)) (from || to ? to_place : others).push_back(length);
    }
  }
  if (to_place.empty()) return at_zero || within == 0;
  return !others.empty() && median(to_place) > far * median(others) &&
         (within > 0 || static_cast<double>(touching) >= kFewestFaces * static_cast<double>(count));
}

/// Vertices that a camera wrote where it saw nothing, and the place of most of them.
struct Spikes {
  std::vector<bool> gone;
  std::uint64_t at_zero = 0;
  std::uint64_t elsewhere = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
};

/// At 0 0 0, and, where a mesh was moved or its vertices rounded, together at another place.
Spikes find_spikes(const RawScan& scan) {
  constexpr double kFarFromZero = 4.0;  // usual edges
  constexpr double kFar = 10.0;
  constexpr double kTogether = 0.01;
  Spikes spikes;
  spikes.gone.assign(scan.points.size(), false);
  std::vector<bool> there(scan.points.size());
  for (std::size_t i = 0; i < there.size(); ++i) there[i] = is_at_scanner(scan.points[i], std::nullopt);
  if (are_spikes(scan, there, kFarFromZero, true)) {
    spikes.gone = there;
    spikes.at_zero = static_cast<std::uint64_t>(std::count(there.begin(), there.end(), true));
  }
  const double apart = kTogether * usual_edge(scan);
  if (!(apart > 0.0)) return spikes;
  for (const Eigen::Vector3d& place : crowded_places(scan, apart)) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < there.size(); ++i) {
      there[i] = !spikes.gone[i] && (scan.points[i] - place).cwiseAbs().maxCoeff() <= 2.0 * apart;
      count += there[i] ? 1 : 0;
    }
    if (!are_spikes(scan, there, kFar, false)) continue;
    for (std::size_t i = 0; i < there.size(); ++i) spikes.gone[i] = spikes.gone[i] || there[i];
    if (spikes.elsewhere == 0) spikes.place = place;
    spikes.elsewhere += count;
  }
  return spikes;
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
  const Spikes spikes = find_spikes(scan);
  std::vector<bool> gone = spikes.gone;
  if (spikes.at_zero + spikes.elsewhere > 0) {
    const std::size_t before = scan.faces.size();
    std::erase_if(scan.faces, [&](const auto& face) {
      return std::any_of(face.begin(), face.end(), [&](std::uint32_t v) { return gone[v]; });
    });
    std::string where = "at 0 0 0";
    if (spikes.elsewhere > 0) {
      where = fmt::format("{}at {:.7g} {:.7g} {:.7g}", spikes.at_zero > 0 ? "at 0 0 0 and " : "together ",
                          spikes.place.x(), spikes.place.y(), spikes.place.z());
    }
    scan.warnings.push_back(
        fmt::format("{} of {} vertices stand {}, far from their neighbours, as depth cameras write them where they saw "
                    "nothing; they and the {} faces on them are left out, which leaves holes",
                    spikes.at_zero + spikes.elsewhere, gone.size(), where, before - scan.faces.size()));
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
  return (at_scanner > kMostAtOrigin && at_scanner > points / kOneIn) ||
         (at_scanner > kMostAtOriginOfFew && at_scanner > points / kOneInOfFew);
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
