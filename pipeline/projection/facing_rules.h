// What the votes on a surface's sides and the stations' word on them have in common.
#pragma once

namespace sparsha::pipeline {

inline constexpr double kSheet = 0.7;    ///< spacings across a surface that are still the same
inline constexpr float kAligned = 0.6F;  ///< cosine of normals that belong to one surface
inline constexpr int kRounds = 4;        ///< of votes handed to neighbours
inline constexpr float kSure = 0.5F;     ///< mean vote, in directions seen from

}  // namespace sparsha::pipeline
