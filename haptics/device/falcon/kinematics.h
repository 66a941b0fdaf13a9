// Where the Falcon's grip is for given arm angles, and what arm torques make a force: a delta robot after Stamper
// (1997). Metres, radians; x right, y up, z out of the device towards the user, z = 0 in the plane of the motors.
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

namespace sparsha::haptics::falcon {

/// The three driven arm angles, top leg first, then clockwise as seen from the front.
using Angles = Eigen::Vector3d;

/// Arm angle of an encoder count; the offset of 35 degrees is where the counts of a homed device begin.
[[nodiscard]] double angle_of_count(double count) noexcept;
[[nodiscard]] double count_of_angle(double angle_rad) noexcept;

/// Empty where the grip cannot be.
[[nodiscard]] std::optional<Angles> inverse(const Eigen::Vector3d& grip_m) noexcept;

/// d(angles) = jacobian * d(grip); empty where the grip cannot be.
[[nodiscard]] std::optional<Eigen::Matrix3d> jacobian(const Eigen::Vector3d& grip_m) noexcept;

/// Where Newton's iteration starts when nothing better is known.
inline const Eigen::Vector3d kColdStartM{0.0, 0.0, 0.11};

/// The grip for given angles by Newton's iteration from `start_m`; empty when it does not settle to 1e-10 rad (angles
/// that no grip can have). No allocation, bounded time: servo thread.
[[nodiscard]] std::optional<Eigen::Vector3d> forward(const Angles& angles_rad, const Eigen::Vector3d& start_m) noexcept;

/// Torques at the arms, N m, that push the grip with a force, N: jacobian^-T * force. Zero where the grip cannot be.
[[nodiscard]] Eigen::Vector3d torques(const Eigen::Vector3d& grip_m, const Eigen::Vector3d& force_n) noexcept;

}  // namespace sparsha::haptics::falcon
