// Elementary functions from IEEE additions and multiplications alone: the C library's differ in the last bit from
// machine to machine, and a simulation must give the same bytes everywhere. Errors stay below 4 ulp of the result or
// 4e-16.
#pragma once

namespace sparsha::pipeline::plain {

/// Sine and cosine of `turns` full turns.
[[nodiscard]] double sin_turns(double turns);
[[nodiscard]] double cos_turns(double turns);
/// e^x, 0 below -708; x at most 709.
[[nodiscard]] double exp(double x);
/// Natural logarithm of a positive, normal number.
[[nodiscard]] double log(double x);
/// Angle of (x, y) in turns, -0.5 to 0.5; 0 for (0, 0).
[[nodiscard]] double atan2_turns(double y, double x);

}  // namespace sparsha::pipeline::plain
