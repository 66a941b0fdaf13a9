// The surface of a whole object as it is touched: every sheet of its charts as a Monge surface in the frame of its
// side, and an index of the space about it. Object frame: the axes of the grid frame, metres relative to the charts'
// origin.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "haptics/around/block_index.h"
#include "haptics/around/enclosure.h"
#include "haptics/around/sheet_surface.h"
#include "scene/charts.h"

namespace sparsha::haptics {

inline constexpr double kSameNormal = 0.866025404;  ///< cosine of 30 degrees: faces are of the same surface

/// Immutable; made off the servo thread, read by it.
struct ObjectSurface {
  double spacing_m = 0.0;
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  ///< of the object frame, in the grid frame
  std::vector<SheetSurface> sheets;                    ///< all of the charts, some in pieces
  std::size_t charted = 0;                             ///< sheets of the charts
  Eigen::AlignedBox3d box_m;                           ///< of the measured nodes, object frame
  std::shared_ptr<const scene::Charts> charts;         ///< `kept` of its maker
  BlockIndex blocks;
  std::shared_ptr<const Enclosure> enclosure;
};

/// Of the measured nodes, relative to the charts' origin; empty without any.
[[nodiscard]] Eigen::AlignedBox3d box_of(const scene::Charts& charts);

/// Have the sheets an envelope that can be touched without their texture?
[[nodiscard]] bool has_envelope(const scene::Charts& charts);

/// `friction` of zero: frictionless. `kept`: the charts, where they are to live as long. Without `texture` it is the
/// envelope, in the same sheets: a place of the proxy keeps its meaning. `like`: an object of the same charts, whose
/// enclosure it shares. Throws Error{failure} when the charts have no cell, or no envelope that is asked for.
[[nodiscard]] std::shared_ptr<const ObjectSurface> make_object_surface(const scene::Charts& charts,
                                                                       const AroundFriction& friction = {},
                                                                       std::shared_ptr<const scene::Charts> kept = {},
                                                                       bool texture = true,
                                                                       const ObjectSurface* like = nullptr);

}  // namespace sparsha::haptics
