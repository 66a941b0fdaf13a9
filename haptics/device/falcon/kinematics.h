// Where the Falcon's grip is for given arm angles, and what arm torques make a force: a delta robot after Stamper
// (1997). Falcon frame: metres, x right, y up, z out of the device towards the user; angles in radians.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

namespace sparsha::haptics::falcon {

/// Encoder counts or motor counts of the three arms, top first, then clockwise as seen from the front.
using Counts = std::array<int, 3>;

/// On the axis, where the counts of a homed device are zero.
inline const Eigen::Vector3d kNeutral_m{0.0, 0.0, 0.1346};

[[nodiscard]] Eigen::Vector3d angles_from_counts(const Counts& counts) noexcept;
/// Rounded to whole counts.
[[nodiscard]] Counts counts_from_angles(const Eigen::Vector3d& angles) noexcept;

/// The arm angles of a grip position; empty where the grip cannot be.
[[nodiscard]] std::optional<Eigen::Vector3d> inverse(const Eigen::Vector3d& position_m) noexcept;

/// d(angles) = jacobian * d(position), rad/m; empty where the grip cannot be.
[[nodiscard]] std::optional<Eigen::Matrix3d> jacobian(const Eigen::Vector3d& position_m) noexcept;

/// The grip position of arm angles by Newton's iteration from `start_m`, settled to 1e-11 rad; empty for angles that no
/// position has. Bounded time, no allocation: servo thread.
[[nodiscard]] std::optional<Eigen::Vector3d> forward(const Eigen::Vector3d& angles,
                                                     const Eigen::Vector3d& start_m) noexcept;

/// Torques at the arms, N m, that push the grip with a force, N: jacobian^-T * force. Empty where there are none.
[[nodiscard]] std::optional<Eigen::Vector3d> torques(const Eigen::Vector3d& position_m,
                                                     const Eigen::Vector3d& force_n) noexcept;

}  // namespace sparsha::haptics::falcon
