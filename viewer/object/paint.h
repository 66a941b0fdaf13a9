// Colour modes of a whole object.
#pragma once

#include "scene/scene_fwd.h"
#include "viewer/object/view.h"
#include "viewer/surface/paint.h"

namespace sparsha::viewer {

/// What an object's colours are of. `front_paint` of `front`, in the same mode.
struct ObjectSource {
  const scene::SceneDescription& description;
  double workspace_m;
  const ReliefData& front;
  const Paint& front_paint;
};

/// A colour for each vertex of the finest level. Height, slope, curvature and sky light are the object's own, and so
/// are colours as scanned, texture and friction where the charts have them; of all other modes the front view has the
/// values, which go where the object is that front, and elsewhere there is no colour.
[[nodiscard]] Paint paint_object(const ObjectView& object, const ObjectSource& source, ColourMode mode);

}  // namespace sparsha::viewer
