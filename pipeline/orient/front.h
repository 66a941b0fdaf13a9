// The side of a statue that a person would call its front, and which way it stands.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "pipeline/orient/side_picture.h"
#include "scene/config/orientation.h"

namespace sparsha::pipeline {

struct FrontView {
  Eigen::Vector3d look_from;  ///< unit
  Eigen::Vector3d up;         ///< unit, at right angles to it
  std::string reason;         ///< for the user: what was found
  /// Score of the best view elsewhere (45 degrees or more away) over that of this one: near 1 where it stays open.
  double rival = 1.0;
  bool standing_open = false;  ///< it may as well stand in another way

  [[nodiscard]] bool no_face() const { return rival > 0.85; }
  [[nodiscard]] bool open() const { return no_face() || standing_open; }
};

struct Standing {
  Eigen::Vector3d up;  ///< unit
  std::string reason;  ///< for the user: what was found
  /// Unit, at right angles to `up`: where a human face looks to.
  std::optional<Eigen::Vector3d> face{};
  bool open = false;         ///< another way to stand is nearly as good
  bool room = false;         ///< scanned from inside: what stands in it is hidden from all sides, or from all but one
  bool from_within = false;  ///< a room whose walls are known to face inwards: it is looked at through the nearer ones
  /// Unit, not along `up`: the one side of a room that shows what stands in it.
  std::optional<Eigen::Vector3d> open_side{};
};
/// Up where form tells nothing: z where `z_up`, else y.
[[nodiscard]] Standing customary_standing(bool z_up);
/// How an object stands: from floor to ceiling where it is a room (see room_of()); by its plane of symmetry where it
/// has one (see upright_by_symmetry()), whatever way it was turned; else the axis of the scan, or the normal of its
/// flat base, over the largest foot: what the lowest 3 % of its height would stand on, as a share of its outline from
/// above. Beside it count custom, worth a third of the outline, and how much like a face the best view around that axis
/// is: what lies on its side shows none. Empty when it has no extent.
[[nodiscard]] std::optional<Standing> standing_of(const EvenPoints& object, bool z_up);

/// Where a human face looks to; else, of horizontal views, the one in which carving is most like its own mirror image,
/// changes most along the mirror axis (as brow, nose, mouth and chin do, backs of heads do not), and shows much.
/// Directions within 12 degrees of an axis of the scan are that axis. Depends on the set of points alone. Empty when
/// they have no extent.
[[nodiscard]] std::optional<FrontView> find_front(const EvenPoints& object, const Standing& standing);

}  // namespace sparsha::pipeline
