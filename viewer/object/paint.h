// Colour modes of a whole object.
#pragma once

#include "viewer/object/view.h"
#include "viewer/surface/paint.h"

namespace sparsha::viewer {

/// A colour for each vertex of the finest level. Height, curvature and sky light are the object's own; of all other
/// modes the front view has the values: `front_paint` of `front`, which goes where the object is that front, and
/// elsewhere there is no colour.
[[nodiscard]] Paint paint_object(const ObjectView& object, const ReliefData& front, const Paint& front_paint,
                                 ColourMode mode);

}  // namespace sparsha::viewer
