// From files to one cloud in metres: units, poses, the common origin.
#include <cmath>
#include <future>

#include <fmt/format.h>

#include "pipeline/base/files.h"
#include "pipeline/base/progress.h"
#include "pipeline/scan/origin.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/units.h"
#include "pipeline/scene/scene.h"

namespace sparsha::pipeline {
namespace {

/// pose * units for one scan, as rotation and translation.
struct Placement {
  Eigen::Matrix3d turn_and_scale = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
  bool trivial = true;

  [[nodiscard]] Eigen::Vector3d operator()(const Eigen::Vector3d& p) const {
    return trivial ? p : Eigen::Vector3d(turn_and_scale * p + shift_m);
  }
};

double longest_side(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d low = points.front();
  Eigen::Vector3d high = low;
  for (const Eigen::Vector3d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).maxCoeff();
}

double scale_of(const ScanConfig& config, const RawScan& scan, Progress& progress) {
  const std::string name = config.file.string();
  const Units& units = config.units;
  if (scan.degrees) {
    throw input_error(name, "its x and y are degrees of longitude and latitude, its z is a length",
                      "projected coordinates in metres or feet; reproject the scan first");
  }
  if (units.unit == LengthUnit::longest_side) {
    const double side = longest_side(scan.points);
    if (!(side > 0.0)) throw input_error(name, "all points are the same, so no longest side can be set", "an extent");
    return units.longest_side_m / side;
  }
  if (units.unit != LengthUnit::automatic) return metres_in(units.unit);
  if (const std::optional<UnitGuess> guess = guess_unit(scan)) {
    progress.warn(fmt::format("{}: no unit is known, metres are taken; {}{}", name, guess->reason,
                              guess->unit == LengthUnit::m
                                  ? "; set 'units' if that is wrong"
                                  : fmt::format("; set 'units: {}' if that is right", to_string(guess->unit))));
  }
  return metres_in(scan.unit.value_or(LengthUnit::m));
}

Placement place(const ScanConfig& config, double scale) {
  Placement placement;
  placement.turn_and_scale = config.pose.topLeftCorner<3, 3>() * scale;
  placement.shift_m = config.pose.topRightCorner<3, 1>();
  placement.trivial = placement.turn_and_scale.isIdentity(0.0) && placement.shift_m.isZero(0.0);
  return placement;
}

struct LoadedScan {
  RawScan raw;
  Placement placement;
};

LoadedScan read_and_place(const ScanConfig& config, Progress& progress) {
  LoadedScan loaded;
  loaded.raw = read_scan(config.file);
  const RawScan& raw = loaded.raw;
  const std::string name = config.file.string();
  for (const std::string& warning : raw.warnings) progress.warn(name + ": " + warning);
  if (raw.points.empty()) {
    throw input_error(
        name, raw.records == 0 ? "the scan has no points" : fmt::format("none of the {} points is valid", raw.records),
        "at least one finite point");
  }
  loaded.placement = place(config, scale_of(config, raw, progress));
  return loaded;
}

/// Appends the points relative to the cloud's origin, each rounded once. Points beyond float32 become invalid, and
/// faces on them go.
void append(LoadedScan& scan, Cloud& cloud, std::size_t& count, bool colour, bool intensity) {
  RawScan& raw = scan.raw;
  const std::size_t first = count;
  float* out = cloud.xyz1() + 4 * count;
  constexpr float kFar = 1e30F;
  std::vector<std::uint32_t> kept;
  const std::size_t n = raw.points.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d p = scan.placement(raw.points[i]) - cloud.origin_m;
    const Eigen::Vector3f q = p.cast<float>();
    if (!(q.cwiseAbs().maxCoeff() < kFar)) {
      if (kept.empty()) {
        kept.resize(n);
        for (std::size_t k = 0; k < i; ++k) kept[k] = static_cast<std::uint32_t>(first + k);
      }
      kept[i] = ~std::uint32_t{0};
      ++cloud.invalid;
      continue;
    }
    if (!kept.empty()) kept[i] = static_cast<std::uint32_t>(count);
    out[0] = q.x();
    out[1] = q.y();
    out[2] = q.z();
    out += 4;
    ++count;
    if (colour) cloud.rgba.push_back(raw.rgba.empty() ? 0xFFFFFFFFU : raw.rgba[i]);
    if (intensity) cloud.intensity.push_back(raw.intensity.empty() ? 0.0F : raw.intensity[i]);
  }
  for (const std::array<std::uint32_t, 3>& face : raw.faces) {
    std::array<std::uint32_t, 3> moved{};
    bool whole = true;
    for (std::size_t k = 0; k < 3; ++k) {
      moved[k] = kept.empty() ? static_cast<std::uint32_t>(first) + face[k] : kept[face[k]];
      whole = whole && moved[k] != ~std::uint32_t{0};
    }
    if (whole) cloud.faces.push_back(moved);
  }
  cloud.invalid += raw.invalid;
  raw = RawScan{};  // gives the memory back before the next scan is copied
}

Cloud merge(std::vector<LoadedScan>& scans, const std::optional<Eigen::Vector3d>& origin_m) {
  Cloud cloud;
  std::size_t points = 0;
  std::size_t faces = 0;
  bool colour = false;
  bool intensity = false;
  PointSample sample;
  for (const LoadedScan& scan : scans) {
    points += scan.raw.points.size();
    faces += scan.raw.faces.size();
    colour = colour || !scan.raw.rgba.empty();
    intensity = intensity || !scan.raw.intensity.empty();
    if (!origin_m) {
      for (const Eigen::Vector3d& p : scan.raw.points) sample.add(scan.placement(p));
    }
  }
  cloud.origin_m = origin_m ? *origin_m : common_origin(sample);
  cloud.resize_points(points);
  cloud.faces.reserve(faces);
  if (colour) cloud.rgba.reserve(points);
  if (intensity) cloud.intensity.reserve(points);
  std::size_t count = 0;
  for (LoadedScan& scan : scans) append(scan, cloud, count, colour, intensity);
  cloud.resize_points(count);
  return cloud;
}

}  // namespace

Cloud load_scan(const ScanConfig& scan, Progress& progress, const std::optional<Eigen::Vector3d>& origin_m) {
  std::vector<LoadedScan> scans;
  scans.push_back(read_and_place(scan, progress));
  return merge(scans, origin_m);
}

Cloud load_scans(const std::vector<ScanConfig>& scans, Progress& progress, std::vector<ScanSource>* sources) {
  std::vector<LoadedScan> loaded;
  loaded.reserve(scans.size());
  for (const ScanConfig& config : scans) {
    progress.throw_if_cancelled();
    // The digest reads the same pages while they are parsed.
    std::future<std::string> digest;
    if (sources != nullptr) {
      digest = std::async(std::launch::async, [file = config.file] { return sha256(MappedFile(file).bytes()); });
    }
    loaded.push_back(read_and_place(config, progress));
    if (sources != nullptr) sources->push_back({config.file, digest.get(), loaded.back().raw.records});
  }
  return merge(loaded, std::nullopt);
}

}  // namespace sparsha::pipeline
