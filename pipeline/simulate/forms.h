// Heights and distances of the forms that need more than a line; used by Surface only. Local frame, metres.
#pragma once

#include <array>

#include "pipeline/simulate/surface.h"

namespace sparsha::pipeline {

[[nodiscard]] double form_z(const SinusoidForm& form, double x, double y);
[[nodiscard]] double form_z(const AccuracyForm& form, double x, double y);
[[nodiscard]] double form_z(const BarsForm& form, double x, double y);
[[nodiscard]] double form_z(const FacadeForm& form, double x, double y);

/// Of a wall `width` wide and `height` high.
[[nodiscard]] double hall_z(const HallForm& form, double width, double height, double x, double y);
[[nodiscard]] double hall_step_distance(const HallForm& form, double width, double height, double x, double y);
[[nodiscard]] std::array<double, 2> form_range(const HallForm& form);

/// Distance in the plane to the nearest vertical flank.
[[nodiscard]] double form_step_distance(const AccuracyForm& form, double x, double y);
[[nodiscard]] double form_step_distance(const BarsForm& form, double x, double y);
[[nodiscard]] double form_step_distance(const FacadeForm& form, double x, double y);

/// Distance in the plane to the nearest rim or bottom of a V groove.
[[nodiscard]] double form_groove_distance(const AccuracyForm& form, double x, double y);

[[nodiscard]] std::array<double, 2> form_range(const AccuracyForm& form);
[[nodiscard]] std::array<double, 2> form_range(const FacadeForm& form);

}  // namespace sparsha::pipeline
