// The cubes of the lattice that the surface passes through.
#pragma once

#include <cstdint>
#include <vector>

#include "base/threads/context.h"
#include "pipeline/solid/lattice.h"
#include "scene/solid/winding.h"

namespace sparsha::pipeline {

/// The place of a corner (cell_polygons.h) of the cube whose lowest corner is `cell`.
[[nodiscard]] LatticePoint corner_of(LatticePoint cell, int corner);

/// SurfaceLattice::key_of() of their lowest corners, ascending; the lattice knows all their corners then. Throws
/// Error{input} when the surface has no end, as that of one side of an object.
[[nodiscard]] std::vector<std::uint64_t> surface_cubes(SurfaceLattice& lattice, const scene::WindingNumber& winding,
                                                       const Context& context);

}  // namespace sparsha::pipeline
