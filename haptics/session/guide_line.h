// From what a visitor asks for to the line that the hand is led along.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "base/phrases/phrases.h"
#include "haptics/guide/guide_path.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

struct GuideWish {
  scene::ScenePointer scene;
  int level = 0;                                     ///< that is touched; a level of too many nodes is not searched
  Eigen::Vector3d hand_m = Eigen::Vector3d::Zero();  ///< grid frame; z counts on whole objects alone
  std::optional<std::size_t> part;                   ///< that was gone to or is under the hand, index into its list
  double scale = 1.0;                                ///< device metres per grid metre
  bool around = false;                               ///< the whole object is touched
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< from the grid frame's axes to the device frame's
};

struct GuideAnswer {
  std::shared_ptr<const Guide> guide;               ///< null: there is none,
  Phrase why = "guide_no_outline";                  ///< and why
  std::string part;                                 ///< said of the part whose border it is; empty: another line
  Eigen::Vector2d way_m = Eigen::Vector2d::Zero();  ///< of the hand to the line, device frame
};

/// By the scene's block `guide`, or its defaults. `path: outline`: of what is found in the heights, the longest line
/// that lies in the part or close to it, else the line nearest to the hand. `path: part`: the border of that part, else
/// of the part nearest to the hand, as far as the scene reaches: a box's sides, a polygon's edges, of a label the
/// longest border of its pieces. `path: drawn`: the drawn line. On a whole object lines lie on its surface, on all
/// sides: edges, rims and creases; where a part ends on the surface; the drawn line, in the plane on what lies before
/// it. Any thread; for level after level of 4 million nodes
/// some seconds. Throws Error{input} when tiles cannot be read.
[[nodiscard]] GuideAnswer find_guide(const GuideWish& wish);

/// The same of a whole object; scene.charts must be there.
[[nodiscard]] GuideAnswer find_guide_on_object(const GuideWish& wish);

}  // namespace sparsha::haptics
