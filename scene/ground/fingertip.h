// Touching with a ball instead of a point: the surface on which the ball's centre moves.
#pragma once

#include <vector>

namespace sparsha {
class Progress;
}

namespace sparsha::scene {

/// The dilation of a bilinear surface by a ball, at its nodes and lowered by the radius, so that level stone stays
/// where it is: z(x, y) = max over |d| <= radius of f(x + d_x, y + d_y) + sqrt(radius^2 - |d|^2) - radius. All heights
/// are finite; beyond the border there is nothing. Lengths in one unit. `progress`, which may be null, can cancel:
/// throws Cancelled.
void touch_with_ball(std::vector<float>& height, int nx, int ny, double spacing, double radius,
                     const Progress* progress = nullptr);

}  // namespace sparsha::scene
