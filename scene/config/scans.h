// The configuration's block `scans`: files, their units and their poses.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace sparsha::scene {

/// Unit of a scan's coordinates. `automatic`: the format's own, else metres with a warning when implausible.
enum class LengthUnit { automatic, m, cm, mm, ft, us_ft, longest_side };

/// "m", "cm", "mm", "ft", "us_ft", as configurations have it; "unknown" for automatic, else "longest_side_mm".
[[nodiscard]] std::string to_string(LengthUnit unit);

struct Units {
  LengthUnit unit = LengthUnit::automatic;
  double longest_side_m = 0.0;  ///< with LengthUnit::longest_side
};

/// One file and where its scanner stood: scan = pose * units * (pose stored in the file) * p.
struct ScanConfig {
  std::filesystem::path file;  ///< absolute, or relative to the current folder
  Units units;
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();  ///< rigid, metres
  /// Of a text file whose columns have no names, one word a column: a field's name ("x", "red") or "skip"; empty: the
  /// reader's own guess.
  std::vector<std::string> columns{};
};

}  // namespace sparsha::scene
