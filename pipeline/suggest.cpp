// Guesses a configuration from the points alone, and says why.
#include "pipeline/suggest.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "pipeline/base/error.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/survey.h"
#include "pipeline/scan/units.h"

namespace sparsha::pipeline {
namespace fs = std::filesystem;

namespace {

struct Seen {
  std::vector<Eigen::Vector3d> points_m;             // a sample of all scans
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();  // sum of triangle area vectors
  double area = 0.0;                                 // sum of triangle areas
  bool z_up_format = false;                          // formats whose z is up
  bool depth_camera_format = false;                  // formats that depth cameras write in their own frame
};

struct Guess {
  Eigen::Vector3d look_from = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  std::string reason;
};

constexpr std::size_t kSample = 200000;

void look_at(const RawScan& scan, double metres, Seen& seen) {
  const std::size_t stride = std::max<std::size_t>(1, scan.points.size() / kSample);
  for (std::size_t i = 0; i < scan.points.size(); i += stride) seen.points_m.push_back(scan.points[i] * metres);
  for (const auto& face : scan.faces) {
    const Eigen::Vector3d& a = scan.points[face[0]];
    const Eigen::Vector3d normal = (scan.points[face[1]] - a).cross(scan.points[face[2]] - a);
    seen.facing += normal;
    seen.area += normal.norm();
  }
  for (const char* name : {"LAS", "LAZ", "E57", "PTX", "PTS", "STL"})
    if (scan.format.starts_with(name)) seen.z_up_format = true;
  if (scan.format.starts_with("PCD")) seen.depth_camera_format = true;
}

// The 1st to 99th percentile box: a far outlier says nothing about the object.
std::array<Eigen::Vector3d, 2> inner_box(const std::vector<Eigen::Vector3d>& points) {
  std::array<Eigen::Vector3d, 2> box;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(points.begin(), points.end(), values.begin(), [axis](const auto& p) { return p[axis]; });
    const auto at = [&](double share) {
      const double place = share * static_cast<double>(values.size() - 1);
      const auto n = static_cast<std::ptrdiff_t>(share < 0.5 ? std::floor(place) : std::ceil(place));
      std::nth_element(values.begin(), values.begin() + n, values.end());
      return values[static_cast<std::size_t>(n)];
    };
    box[0][axis] = at(0.01);
    box[1][axis] = at(0.99);
  }
  return box;
}

// The coordinate axis within 25 degrees, else the direction rounded to three digits.
Eigen::Vector3d snapped(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d unit = direction.normalized();
  Eigen::Index axis = 0;
  unit.cwiseAbs().maxCoeff(&axis);
  constexpr double kCos25 = 0.9063;
  if (std::abs(unit[axis]) > kCos25) return Eigen::Vector3d::Unit(axis) * (unit[axis] > 0 ? 1.0 : -1.0);
  return (unit * 1000.0).array().round() / 1000.0;
}

Eigen::Vector3d up_for(const Eigen::Vector3d& look_from, bool z_up) {
  const Eigen::Vector3d first = z_up ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d second = z_up ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  return std::abs(look_from.normalized().dot(first)) < 0.8 ? first : second;
}

Guess guess_view(const Seen& seen) {
  const auto box = inner_box(seen.points_m);
  const Eigen::Vector3d centre = 0.5 * (box[0] + box[1]);
  const double size = (box[1] - box[0]).norm();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::size_t inside = 0;
  for (const Eigen::Vector3d& point : seen.points_m) {
    if (!((point.array() >= box[0].array()).all() && (point.array() <= box[1].array()).all())) continue;
    covariance += (point - centre) * (point - centre).transpose();
    ++inside;
  }
  covariance /= std::max<double>(1.0, static_cast<double>(inside));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
  const double flatness = std::sqrt(std::max(0.0, axes.eigenvalues()[0]) / std::max(axes.eigenvalues()[1], 1e-300));

  Guess guess;
  bool z_up = seen.z_up_format;
  if (seen.area > 0.0 && seen.facing.norm() > 0.3 * seen.area) {
    guess.look_from = snapped(seen.facing);
    guess.reason =
        fmt::format("the triangles face this way ({:.0f} % of the area, net)", 100.0 * seen.facing.norm() / seen.area);
  } else if (seen.depth_camera_format && box[0].z() > 0.1 * size) {
    guess.look_from = -Eigen::Vector3d::UnitZ();
    guess.up = -Eigen::Vector3d::UnitY();
    guess.reason = "all points lie before the origin along z, as depth cameras see them: x right, y down, z away";
    return guess;
  } else if (flatness < 0.3) {
    Eigen::Vector3d thin = axes.eigenvectors().col(0);
    const bool scanner_side = centre.norm() < 100.0 * size && std::abs(thin.dot(centre)) > 0.5 * size;
    if (scanner_side ? thin.dot(centre) > 0.0 : thin.sum() < 0.0) thin = -thin;
    guess.look_from = snapped(thin);
    guess.reason = fmt::format("the points are flat ({:.0f} % as thick as wide) across this direction{}",
                               100.0 * flatness, scanner_side ? ", and the scan's origin lies on this side" : "");
  } else if (seen.area == 0.0 && centre.norm() > size && centre.norm() < 100.0 * size) {
    guess.look_from = snapped(-centre);
    guess.reason = "the scan's origin, where scanners stand, lies on this side";
  } else if (z_up) {
    guess.look_from = -Eigen::Vector3d::UnitY();
    guess.reason = "a solid object in a format whose z is up: its front is a guess, look at it and turn it";
  } else {
    guess.reason = "a solid object, y up by custom: its front is a guess, look at it and turn it";
  }
  guess.up = up_for(guess.look_from, z_up);
  return guess;
}

// A YAML scalar that keeps quotes, backslashes and control characters of file names.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (static_cast<unsigned char>(c) < ' ' || c == 127) {
      result += fmt::format("\\x{:02X}", static_cast<unsigned>(c));
    } else {
      result += c;
    }
  }
  return result + "\"";
}

std::string vector(const Eigen::Vector3d& v) { return fmt::format("[{:g}, {:g}, {:g}]", v.x(), v.y(), v.z()); }

}  // namespace

Suggestion suggest_config(const std::vector<fs::path>& scans, const fs::path& folder, Progress& progress) {
  progress.begin("look at the scans");
  Seen seen;
  std::string scan_block = "scans:\n";
  double spacing_m = 0.0;
  for (const fs::path& file : scans) {
    const ScanSurvey survey = survey_scan(file, progress);
    const RawScan& scan = survey.scan;
    if (scan.points.empty()) {
      throw input_error(file.string(), "there are no points in it", "a scan with at least one finite point");
    }
    std::string unit = "m";
    std::string reason = "no sign of another unit";
    double metres = 1.0;
    if (scan.unit) {
      unit = to_string(*scan.unit);
      metres = metres_in(*scan.unit);
      reason = "the format says so";
    } else if (const auto guess = guess_unit(scan)) {
      unit = to_string(guess->unit);
      metres = metres_in(guess->unit);
      reason = guess->reason;
    }
    look_at(scan, metres, seen);
    spacing_m = std::max(spacing_m, survey.spacing * metres);
    std::error_code code;
    const fs::path relative =
        fs::absolute(file, code)
            .lexically_normal()
            .lexically_relative(fs::absolute(folder.empty() ? fs::path(".") : folder, code).lexically_normal());
    const std::string name = (relative.empty() ? fs::absolute(file, code) : relative).generic_string();
    scan_block += fmt::format("  - file: {}\n    units: {}  # {}\n", quoted(name), unit, reason);
  }

  const Guess view = guess_view(seen);
  const auto box = inner_box(seen.points_m);
  const double longest_m = (box[1] - box[0]).maxCoeff();
  constexpr double kLongest_m = 1e9;
  if (!(longest_m <= kLongest_m && spacing_m <= kLongest_m)) {
    throw input_error(scans.front().string(), fmt::format("its points spread over {:.3g} m", longest_m),
                      "a scan of less than 1e9 m; damaged coordinates or another unit");
  }
  constexpr double kMostNodes = 2000.0;
  const double floor_m = std::max(longest_m / kMostNodes, HapticsConfig{}.resolution_m);
  std::string spacing_reason = "the median distance between neighbouring points";
  if (spacing_m < floor_m) {
    spacing_m = floor_m;
    spacing_reason = "finer than this neither grid nor hand gains";
  }
  constexpr double kMeshNodes = 500.0;
  if (seen.area > 0.0 && spacing_m > longest_m / kMeshNodes) {
    spacing_m = std::max(longest_m / kMeshNodes, HapticsConfig{}.resolution_m);
    spacing_reason = "triangles are exact between their corners: 500 nodes along the longest side show their form";
  }
  if (!(spacing_m > 0.0)) spacing_m = 0.001;
  const double spacing_mm = spacing_m * 1e3;

  std::string yaml = "# A first configuration, guessed from the scans: read it, look at the scene, correct it.\n";
  yaml += scan_block;
  yaml += fmt::format("orientation: {{look_from: {}, up: {}}}\n#   {}\n", vector(view.look_from), vector(view.up),
                      view.reason);
  yaml += fmt::format("grid: {{spacing_mm: {:.3g}}}  # {}\n", spacing_mm, spacing_reason);
  yaml += fmt::format("fill: {{max_gap_mm: {:.3g}}}  # five spacings: small holes, no invented surface\n",
                      5.0 * spacing_mm);
  yaml += fmt::format(
      "texture: {{sigma_space_mm: {:.3g}, sigma_range_mm: {:.3g}}}  # three spacings, and a height of one\n",
      3.0 * spacing_mm, spacing_mm);
  yaml += "friction: {law: curvature}\ncheck: {samples: 50000}\n";

  Suggestion suggestion;
  suggestion.config = parse_config(yaml::parse_text(yaml, "the suggested configuration"), folder);
  suggestion.yaml = std::move(yaml);
  progress.finish();
  return suggestion;
}

}  // namespace sparsha::pipeline
