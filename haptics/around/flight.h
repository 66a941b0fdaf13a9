// The straight way of a proxy through space: the first sheet that it meets. Object frame, metres.
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "haptics/around/object_surface.h"
#include "haptics/proxy/proxy.h"

namespace sparsha::haptics {

inline constexpr std::uint32_t kNoSheet = 0xffffffffU;

/// First crossing of a straight way from outside inwards.
struct Crossing {
  std::uint32_t sheet = kNoSheet;
  double share = 2.0;  ///< of the way
  Eigen::Vector3d local_m = Eigen::Vector3d::Zero();
};

/// What a march came to: a crossing, or how much of the way is free so far (1: all of it).
struct Flight {
  std::optional<Crossing> crossing;
  double share = 1.0;
};

/// Follows the way through at most kMostBlocks blocks. `leaving`: it begins on a surface, and leads off it.
[[nodiscard]] Flight fly(const ObjectSurface& object, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                         bool leaving, CellShape shape) noexcept;
inline constexpr int kMostBlocks = 256;

/// What sheets other than `own` say of a place: outside of one of them, inside of all that are near, or nothing.
enum class Held : std::uint8_t { outside, inside, unknown };
[[nodiscard]] Held held_at(const ObjectSurface& object, std::uint32_t own, const Eigen::Vector3d& place_m) noexcept;

/// Do measured faces that meet at an angle, as at an edge, all have a place within them? Two faces of a wall do not
/// meet.
[[nodiscard]] bool is_within_edge(const ObjectSurface& object, const Eigen::Vector3d& place_m) noexcept;

/// A hand that is outside of a measured sheet near the proxy, and inside of none of them.
[[nodiscard]] bool is_outside(const ObjectSurface& object, const Eigen::Vector3d& hand_m,
                              const Eigen::Vector3d& proxy_m) noexcept;

/// The nearest measured surface over a place that all sheets about it say is inside, at most four cells away: where a
/// way has come in between the rims of sheets that do not quite meet. Its share is 1.
[[nodiscard]] std::optional<Crossing> surface_over(const ObjectSurface& object,
                                                   const Eigen::Vector3d& place_m) noexcept;

/// The first sheet other than `own` that a proxy sliding over a short straight way, where the surface has this normal,
/// runs into. A sheet whose normal is within 30 degrees is the same surface and stops nothing.
[[nodiscard]] std::optional<Crossing> stopped_by(const ObjectSurface& object, std::uint32_t own,
                                                 const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                                                 const Eigen::Vector3d& normal, CellShape shape) noexcept;

}  // namespace sparsha::haptics
