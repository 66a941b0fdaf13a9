// A surface for the proxy: z = f(x, y) on a square lattice, bilinear in every cell.
//
//   haptics::SurfaceParts  what the caller gives: lattice and heights (metres, grid frame; NaN: unknown), coefficients
//   of
//                          friction per node, scale (device metres a grid metre), radius of the fingertip (device
//                          metres)
//   haptics::make_surface  the surface of them. Off the servo thread: it allocates, and takes time that grows with the
//                          number of nodes. Throws Error{failure} where sizes do not match the lattice, or lattice and
//                          scale are not positive and finite, and Cancelled
//   haptics::MongeSurface  immutable and shared: any number of threads may read it, and the last owner frees it. Local
//                          frame: metres from node (0, 0) and from height zero of the lattice
//
// 4 bytes a node, 13 with friction and flags. Beyond its border the surface goes on level and without friction. With a
// fingertip the heights are those of the ball's centre, lowered by its radius (docs/touch.md, "Proxy").
#pragma once

#include "haptics/surface/monge_surface.h"
#include "sparsha/scene.h"
