// Heights where none were measured.
#pragma once

#include <vector>

namespace sparsha::scene {

/// Continues heights into nodes that are NaN or infinite, smoothly from the nearest known ones (pull-push, Gortler et
/// al. 1996); known nodes stay as they are. `height_m`: nx * ny, row by row. Everything unknown gives 0.
void continue_heights(std::vector<float>& height_m, int nx, int ny);

}  // namespace sparsha::scene
