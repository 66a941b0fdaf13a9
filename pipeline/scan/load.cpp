// From files to one cloud in metres: units, poses, the common origin.
#include <cmath>
#include <future>
#include <limits>

#include <fmt/format.h>

#include "pipeline/base/files.h"
#include "pipeline/base/progress.h"
#include "pipeline/scan/origin.h"
#include "pipeline/scan/read_bytes.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/units.h"
#include "pipeline/scene/scene.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint32_t kWhite = 0xFFFFFFFFU;
constexpr std::uint32_t kGone = std::numeric_limits<std::uint32_t>::max();

/// pose * units for one scan.
struct Placement {
  Eigen::Matrix3d turn_and_scale = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
  bool trivial = true;

  [[nodiscard]] Eigen::Vector3d operator()(const Eigen::Vector3d& p) const {
    return trivial ? p : Eigen::Vector3d(turn_and_scale * p + shift_m);
  }
};

/// A scan looked at once: everything but its points, which are kept in double or streamed from the file again.
struct LoadedScan {
  std::filesystem::path file;
  RawScan raw;
  bool streamed = false;
  std::uint64_t valid = 0;
  bool colour = false;
  bool intensity = false;
  PointSample sample;  ///< file units
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  Placement placement;

  void look(const PointBlock& block, bool bounds) {
    valid += block.points.size();
    colour = colour || !block.rgba.empty();
    intensity = intensity || !block.intensity.empty();
    for (const Eigen::Vector3d& p : block.points) sample.add(p);
    if (!bounds) return;
    for (const Eigen::Vector3d& p : block.points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  void for_each_block(const PointSink& sink) const {
    if (streamed) {
      (void)stream_scan(file, sink);
    } else {
      sink({raw.points, raw.rgba, raw.intensity});
    }
  }
};

double scale_of(const ScanConfig& config, const LoadedScan& scan, Progress& progress) {
  const std::string name = config.file.string();
  const Units& units = config.units;
  if (scan.raw.degrees) {
    throw input_error(name, "its x and y are degrees of longitude and latitude, its z is a length",
                      "projected coordinates in metres or feet; reproject the scan first");
  }
  if (units.unit == LengthUnit::longest_side) {
    const double side = (scan.high - scan.low).maxCoeff();
    if (!(side > 0.0)) throw input_error(name, "all points are the same, so no longest side can be set", "an extent");
    return units.longest_side_m / side;
  }
  if (units.unit != LengthUnit::automatic) return metres_in(units.unit);
  if (scan.raw.unit) return metres_in(*scan.raw.unit);
  if (const std::optional<UnitGuess> guess = doubt_metres(scan.sample)) {
    progress.warn(fmt::format("{}: no unit is known, metres are taken; {}{}", name, guess->reason,
                              guess->unit == LengthUnit::m
                                  ? "; set 'units' if that is wrong"
                                  : fmt::format("; set 'units: {}' if that is right", to_string(guess->unit))));
  }
  return 1.0;
}

Placement place(const ScanConfig& config, double scale) {
  Placement placement;
  placement.turn_and_scale = config.pose.topLeftCorner<3, 3>() * scale;
  placement.shift_m = config.pose.topRightCorner<3, 1>();
  placement.trivial = placement.turn_and_scale.isIdentity(0.0) && placement.shift_m.isZero(0.0);
  return placement;
}

LoadedScan look_at(const ScanConfig& config, Progress& progress) {
  LoadedScan scan;
  scan.file = config.file;
  scan.streamed = is_quick_to_stream(config.file);
  const bool bounds = config.units.unit == LengthUnit::longest_side;
  if (scan.streamed) {
    scan.raw = stream_scan(config.file, [&](const PointBlock& block) { scan.look(block, bounds); });
  } else {
    scan.raw = read_scan(config.file);
    scan.look({scan.raw.points, scan.raw.rgba, scan.raw.intensity}, bounds);
  }
  const std::string name = config.file.string();
  for (const std::string& warning : scan.raw.warnings) progress.warn(name + ": " + warning);
  if (scan.valid == 0) {
    throw input_error(name,
                      scan.raw.records == 0 ? "the scan has no points"
                                            : fmt::format("none of the {} points is valid", scan.raw.records),
                      "at least one finite point");
  }
  scan.placement = place(config, scale_of(config, scan, progress));
  return scan;
}

/// Appends scans to a cloud whose origin is fixed and whose points have room for all.
class Appender {
 public:
  Appender(Cloud& cloud, bool colour, bool intensity) : cloud_(cloud), colour_(colour), intensity_(intensity) {}

  /// Each point is rounded once, from double, relative to the origin. Points beyond float32 become invalid, and faces
  /// on them go.
  void append(LoadedScan& scan) {
    std::vector<std::uint32_t> moved;
    const bool faces = !scan.raw.faces.empty();
    if (faces) moved.reserve(static_cast<std::size_t>(scan.valid));
    std::uint64_t seen = 0;
    scan.for_each_block([&](const PointBlock& block) {
      seen += block.points.size();
      if (seen > scan.valid) throw changed(scan);
      add_points(scan.placement, block, faces ? &moved : nullptr);
    });
    if (seen != scan.valid) throw changed(scan);
    for (const std::array<std::uint32_t, 3>& face : scan.raw.faces) {
      const std::array<std::uint32_t, 3> corners = {moved[face[0]], moved[face[1]], moved[face[2]]};
      if (corners[0] != kGone && corners[1] != kGone && corners[2] != kGone) cloud_.faces.push_back(corners);
    }
    cloud_.invalid += scan.raw.invalid;
    scan.raw = RawScan{};  // gives the memory back before the next scan is copied
  }

  void finish() { cloud_.resize_points(count_); }

 private:
  static Error changed(const LoadedScan& scan) {
    return input_error(scan.file.string(), "the file changed while it was read", "a file that nobody writes to");
  }

  void add_points(const Placement& placement, const PointBlock& block, std::vector<std::uint32_t>* moved) {
    constexpr float kFar = 1e30F;
    float* out = cloud_.xyz1() + 4 * count_;
    for (std::size_t i = 0; i < block.points.size(); ++i) {
      const Eigen::Vector3f q = (placement(block.points[i]) - cloud_.origin_m).cast<float>();
      const bool near = std::fabs(q.x()) < kFar && std::fabs(q.y()) < kFar && std::fabs(q.z()) < kFar;
      if (moved != nullptr) moved->push_back(near ? static_cast<std::uint32_t>(count_) : kGone);
      if (!near) {
        ++cloud_.invalid;
        continue;
      }
      out[0] = q.x();
      out[1] = q.y();
      out[2] = q.z();
      out += 4;
      ++count_;
      if (colour_) cloud_.rgba.push_back(block.rgba.empty() ? kWhite : block.rgba[i]);
      if (intensity_) cloud_.intensity.push_back(block.intensity.empty() ? 0.0F : block.intensity[i]);
    }
  }

  Cloud& cloud_;
  std::size_t count_ = 0;
  bool colour_;
  bool intensity_;
};

Cloud join(std::vector<LoadedScan>& scans, const std::optional<Eigen::Vector3d>& origin_m) {
  Cloud cloud;
  std::uint64_t points = 0;
  std::size_t faces = 0;
  bool colour = false;
  bool intensity = false;
  PointSample sample;
  for (const LoadedScan& scan : scans) {
    points += scan.valid;
    faces += scan.raw.faces.size();
    colour = colour || scan.colour;
    intensity = intensity || scan.intensity;
    if (!origin_m) sample.merge(scan.sample, scan.placement);
  }
  cloud.origin_m = origin_m ? *origin_m : common_origin(sample);
  cloud.resize_points(static_cast<std::size_t>(points));
  cloud.faces.reserve(faces);
  if (colour) cloud.rgba.reserve(cloud.size());
  if (intensity) cloud.intensity.reserve(cloud.size());
  Appender appender(cloud, colour, intensity);
  for (LoadedScan& scan : scans) appender.append(scan);
  appender.finish();
  return cloud;
}

}  // namespace

Cloud load_scan(const ScanConfig& scan, Progress& progress, const std::optional<Eigen::Vector3d>& origin_m) {
  std::vector<LoadedScan> scans;
  scans.push_back(look_at(scan, progress));
  return join(scans, origin_m);
}

Cloud load_scans(const std::vector<ScanConfig>& scans, Progress& progress, std::vector<ScanSource>* sources) {
  std::vector<LoadedScan> loaded;
  loaded.reserve(scans.size());
  std::vector<std::future<std::string>> digests;
  for (const ScanConfig& config : scans) {
    progress.throw_if_cancelled();
    if (sources != nullptr) {
      // The digest reads the same pages while they are decoded.
      digests.push_back(
          std::async(std::launch::async, [file = config.file] { return sha256(MappedFile(file).bytes()); }));
    }
    loaded.push_back(look_at(config, progress));
  }
  std::vector<std::uint64_t> records;
  for (const LoadedScan& scan : loaded) records.push_back(scan.raw.records);
  Cloud cloud = join(loaded, std::nullopt);
  for (std::size_t i = 0; i < digests.size(); ++i) {
    sources->push_back({scans[i].file, digests[i].get(), records[i]});
  }
  return cloud;
}

}  // namespace sparsha::pipeline
