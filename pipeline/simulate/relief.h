// The sandstone relief: what is drawn where, in metres; used by Surface only.
#pragma once

#include <array>
#include <memory>

#include "pipeline/simulate/surface.h"

namespace sparsha::pipeline {

struct ReliefDrawing;

/// Lays the inscription out. Throws Error{usage} for a letter that has no strokes here or a line too long.
[[nodiscard]] std::shared_ptr<const ReliefDrawing> draw_relief(const ReliefForm& form, double width_m, double height_m);
[[nodiscard]] double relief_z(const ReliefDrawing& drawing, double x, double y);
/// Bounds of its heights, not tight: {low, high}.
[[nodiscard]] std::array<double, 2> relief_range(const ReliefForm& form);
[[nodiscard]] double relief_reflectance(const ReliefDrawing& drawing, double x, double y);

}  // namespace sparsha::pipeline
