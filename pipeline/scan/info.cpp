// What `sparsha info` and `sparsha new` say of a scan without building it.
#include <algorithm>
#include <array>
#include <vector>

#include "pipeline/scan/doubts.h"
#include "pipeline/scan/empty_returns.h"
#include "pipeline/scan/inspect.h"
#include "pipeline/scan/origin.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/statistics.h"
#include "pipeline/scan/units.h"

namespace sparsha::pipeline {
namespace {

/// Valid points less the number of different ones.
std::uint64_t count_duplicates(const std::vector<Eigen::Vector3d>& points) {
  std::vector<std::array<double, 3>> sorted;
  sorted.reserve(points.size());
  for (const Eigen::Vector3d& p : points) sorted.push_back({p.x(), p.y(), p.z()});
  std::sort(sorted.begin(), sorted.end());
  std::uint64_t count = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) count += sorted[i] == sorted[i - 1] ? 1 : 0;
  return count;
}

}  // namespace

ScanInfo inspect_scan(const std::filesystem::path& file, const Progress* progress) {
  return inspect_scan(file, progress, [](const auto&, double) {});
}

ScanInfo inspect_scan(const std::filesystem::path& file, const Progress* progress, const LookAtPoints& look) {
  ReadOptions options;
  options.tally = ReadOptions::Tally::all;
  RawScan scan = read_scan(file, progress, options);
  drop_what_is_no_surface(scan);
  add_doubts(scan);
  ScanInfo info;
  info.format = scan.format;
  info.points = scan.records;
  info.invalid = scan.invalid;
  info.notes = scan.notes;
  info.fields = scan.fields;
  info.tallies = std::move(scan.tallies);
  info.units = scan.degrees ? "degrees" : scan.unit ? to_string(*scan.unit) : "unknown";
  info.scans = scan.scans;
  info.viewpoint = scan.viewpoint;
  info.warnings = scan.warnings;
  if (!scan.pieces.empty()) info.warnings.push_back(scan.pieces);
  const double scale = scene::metres_in(scan.unit.value_or(scene::LengthUnit::automatic));
  if (scan.points.empty()) return info;
  Eigen::Vector3d low = scan.points.front();
  Eigen::Vector3d high = low;
  for (const Eigen::Vector3d& p : scan.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  info.min_m = low * scale;
  info.max_m = high * scale;
  PointSample sample;
  for (const Eigen::Vector3d& p : scan.points) sample.add(p * scale);
  info.sample_m = sample.points();
  info.triangles = scan.faces.size();
  info.duplicates = count_duplicates(scan.points);
  if (scan.faces.empty() && !scan.degrees) look(scan.points, scale);
  info.spacing_m = (scan.cell ? scan.cell->minCoeff() : median_spacing(scan.points)) * scale;
  if (const std::optional<UnitGuess> guess = guess_unit(scan)) info.warnings.push_back("unit: " + guess->reason);
  return info;
}

}  // namespace sparsha::pipeline
