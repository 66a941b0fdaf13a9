// What is touched, as plain data: lattices of heights, areas, materials and the settings of touch.
//
//   scene::Lattice        nx x ny nodes, spacing and origin in metres, grid frame (x right, y up, z towards the
//   viewer);
//                         node (i, j) is stored at j * nx + i, row 0 at the bottom
//   scene::DepthGrid      heights in metres relative to the lattice's origin, NaN where unknown, and each node's state
//   scene::Layers         a depth grid with what else is known of its nodes
//   scene::HapticsConfig  stiffness in N/m, rate in Hz, radius of the fingertip in metres, solver, creases, borders
//   scene::Material       what a strike and a grain are invented from
//   scene::Area           boxes, polygons and labels of a grid, for parts and sounds
//   scene::kDeskWorkspace_m, window_nodes(), level_scale()  which part of a grid a hand reaches at once
//
// Values that own their memory; one thread writes, or any number read.
#pragma once

#include "scene/area/area.h"
#include "scene/area/label_area.h"
#include "scene/area/polygon.h"
#include "scene/config/haptics.h"
#include "scene/depth_grid.h"
#include "scene/frame/workspace.h"
#include "scene/material/materials.h"
