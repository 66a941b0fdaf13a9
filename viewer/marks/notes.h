// What people write on an object: pins with words, measures, a section plane. Kept beside the scene, in the scans'
// frame, so that it stays on the object whichever side it is scanned from.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace sparsha::viewer {

/// Words at a place of the object.
struct Pin {
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  std::string text;
};

struct Measure {
  enum class Kind { distance, angle, profile };
  static constexpr int kKinds = 3;
  Kind kind = Kind::distance;
  std::vector<Eigen::Vector3d> points_m;  ///< two; of an angle three, the middle one is its vertex
};

/// A plane upright on the grid; what lies on the side that `out` points to is left out of the picture.
struct Section {
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d out = -Eigen::Vector3d::UnitY();  ///< unit
};

struct Notes {
  std::vector<Pin> pins;
  std::vector<Measure> measures;
  std::optional<Section> section;
  bool parallel = false;  ///< the picture has no perspective

  [[nodiscard]] bool empty() const { return pins.empty() && measures.empty() && !section && !parallel; }
};

/// "distance", "angle", "profile".
[[nodiscard]] const char* name_of(Measure::Kind kind);
[[nodiscard]] std::size_t points_of(Measure::Kind kind);
/// Metres; radians of an angle. 0 while points are missing.
[[nodiscard]] double value_of(const Measure& measure);
/// "12.3 cm", "37.5 degrees".
[[nodiscard]] std::string value_text(const Measure& measure);

/// The same on an object that `matrix`, an affine, takes to another frame.
[[nodiscard]] Notes moved(const Notes& notes, const Eigen::Matrix4d& matrix);

/// Of the scans' frame. A file that is not there gives none. Throws Error{input} with line and column.
[[nodiscard]] Notes read_notes(const std::filesystem::path& file);
/// Atomically; the same notes give the same bytes. Throws Error{failure}.
void write_notes(const Notes& notes, const std::filesystem::path& file);

}  // namespace sparsha::viewer
