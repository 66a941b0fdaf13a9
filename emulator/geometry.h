// The emulated arm's geometry, from the published dimensions alone: no code of the driver, so that an error in either
// shows. Falcon frame: metres, x right, y up, z towards the user; arms: top, then clockwise seen from the front.
#pragma once

#include <array>
#include <optional>

namespace sparsha::emulator {

using Vec3 = std::array<double, 3>;
/// One number per arm.
using PerArm = std::array<double, 3>;

/// The shaft angle of an arm, radians, at an encoder count, and the nearest count of an angle.
[[nodiscard]] double angle_of(double count);
[[nodiscard]] int count_of(double angle_rad);

/// The arms' angles with the grip at a place; empty where the grip cannot be.
[[nodiscard]] std::optional<PerArm> arm_angles(const Vec3& grip_m);
/// The place of the grip for given angles, sought from `start_m`; empty for angles that no place has.
[[nodiscard]] std::optional<Vec3> grip_place(const PerArm& angles_rad, const Vec3& start_m);
/// Row i: d(angle of arm i) / d(place of the grip), rad/m; empty where the grip cannot be.
[[nodiscard]] std::optional<std::array<Vec3, 3>> angle_rates(const Vec3& grip_m);
/// The force on the grip, newtons, of torques at the arms, newton metres (virtual work). Zero where the grip cannot be.
[[nodiscard]] Vec3 force_of(const PerArm& torque_n_m, const Vec3& grip_m);

}  // namespace sparsha::emulator
