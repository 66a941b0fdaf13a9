// Texture of whole objects: how far the measured surface lies before a smoother one, along its normal, and how that
// bends. All sheets ask the same nodes, so that they agree where they overlap.
#pragma once

#include "base/threads/context.h"
#include "scene/charts.h"
#include "scene/config/layers.h"

namespace sparsha::pipeline {

/// Sets Sheet::texture_m of all sheets: the distance along a node's normal from the envelope, a bilateral mean (Tomasi
/// & Manduchi 1998; of surfaces Fleishman et al. 2003) of the nodes about it in its tangent frame. Of each place of the
/// surface the sheet that faces it best has the nodes that count, weighted by their area; nodes that face away by more
/// than 60 degrees do not count. Where the envelope's radius is wider than 8 nodes, every second node counts, or every
/// third and so on. Depends neither on threads nor on the sheets' order but for rounding.
void add_texture(scene::Charts& charts, const scene::TextureConfig& config, const Context& context);

/// Sets Sheet::curvature_per_m: k = sqrt(2 H^2 - K) of the texture by a quadratic surface with Gaussian weights of
/// `scale_m` in the tangent frame of each node, less what noise of `noise_m` (of the points, across the surface)
/// leaves. NaN where the nodes about it lie on one side only, as at the end of a scan. Requires add_texture().
void add_curvature(scene::Charts& charts, double scale_m, double noise_m, const Context& context);

}  // namespace sparsha::pipeline
