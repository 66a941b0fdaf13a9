// What is drawn and edited on the stone: notes, the tool at hand, the boxes of the parts. Plain values of one frame,
// places in the grid frame.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "viewer/marks/notes.h"
#include "viewer/marks/profile.h"

namespace sparsha::viewer {

/// What a click on the stone does.
enum class Tool { none, distance, angle, profile };

/// The border of a named part, as it is drawn.
struct PartBox {
  std::string name;
  std::array<double, 4> box_m{};  ///< xmin ymin xmax ymax; of a polygon or a label the box round it
  /// Closed lines of a polygon or a label, which are drawn in place of the box. They are changed in the configuration.
  std::vector<std::vector<Eigen::Vector2d>> borders_m{};
  bool is_box = true;
};

struct Marks {
  Tool tool = Tool::none;
  std::vector<Eigen::Vector3d> pending_m;  ///< points of a measure that is not whole yet
  Notes notes;
  /// Of each pin on a whole object where the stone looks there, grid frame; zero where nothing tells.
  std::vector<Eigen::Vector3d> pin_normals;
  std::vector<ProfileSample> profile;  ///< of the newest measure, when that is a profile
  std::optional<std::string> typing;   ///< the words that are being written for the newest pin or part
  std::vector<PartBox> parts;          ///< shown when ViewSettings::parts
  bool parts_fixed = false;            ///< they cannot be edited: drawn in another orientation
  std::uint64_t version = 0;           ///< another one when anything of the above is
};

/// Corners of a box in the order left bottom, right bottom, right top, left top; z is 0.
[[nodiscard]] inline std::array<Eigen::Vector3d, 4> corners_of(const std::array<double, 4>& box_m) {
  return {Eigen::Vector3d(box_m[0], box_m[1], 0.0), Eigen::Vector3d(box_m[2], box_m[1], 0.0),
          Eigen::Vector3d(box_m[2], box_m[3], 0.0), Eigen::Vector3d(box_m[0], box_m[3], 0.0)};
}

}  // namespace sparsha::viewer
