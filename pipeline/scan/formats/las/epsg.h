// Length units of EPSG codes: of units, of projections and of systems of heights (EPSG data set 10.076).
#pragma once

namespace sparsha::pipeline::las {

/// Metres in the length unit of a code, 0 for others.
[[nodiscard]] double metres_of_unit(int code);

/// Metres in the unit of x and y; 0 where it is not known here.
[[nodiscard]] double metres_of_projection(int code);

/// Whether the code is that of a projection together with heights, which then have the unit of x and y.
[[nodiscard]] bool is_with_heights(int code);
/// Whether a system of heights has depths, which count downwards.
[[nodiscard]] bool counts_down(int code);

/// Metres in the unit of a system of heights; 0 where it is not known here.
[[nodiscard]] double metres_of_heights(int code);

}  // namespace sparsha::pipeline::las
