// What a person should know before trusting a depth grid: each with what to do about it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/check/check.h"
#include "pipeline/check/sides_check.h"
#include "pipeline/projection/projection.h"

namespace sparsha::scene {
struct Config;
}

namespace sparsha::pipeline {

/// What is wrong with a surface, in figures; `surface_warnings` puts the same into words.
struct SurfaceDoubts {
  bool noisy = false;        ///< noise is more than half the distance between points, and nodes have too few to lose it
  bool fine = false;         ///< the grid is more than three times finer than the points
  bool far = false;          ///< half of the points lie farther from the surface than `explained_m`
  bool not_theirs = false;   ///< half of the points lie more than a grid spacing from the surface
  bool unfacing = false;     ///< much of what is seen first seems to face away
  bool unproven = false;     ///< the cross-check found nothing to compare
  double explained_m = 0.0;  ///< median distance that noise, and form between nodes and points, explain
};
[[nodiscard]] SurfaceDoubts surface_doubts(const Projection& projection, const scene::Lattice& lattice,
                                           const std::optional<CheckResult>& check);

/// About a projection, whose grid is `lattice` with `measured` measured nodes, and its cross-check where there is one;
/// nothing about one that has only a mesh.
[[nodiscard]] std::vector<std::string> surface_warnings(const Projection& projection, const scene::Lattice& lattice,
                                                        std::uint64_t measured,
                                                        const std::optional<CheckResult>& check);

/// Of a whole object. `share` as in AroundReport::mixed_share; nothing for 0.
[[nodiscard]] std::optional<std::string> doubt_of_mixed(double share);
/// Nothing where hardly any node faces inwards, as at sharp edges.
[[nodiscard]] std::optional<std::string> doubt_of_sides(const SidesCheck& sides);

/// What a build of heights alone (`BuildOptions::grid_only`) leaves out and whose absence makes another surface or
/// another object than that of the configuration; nothing where there is none of it.
[[nodiscard]] std::optional<std::string> ignored_by_heights(const scene::Config& config);

/// Throws Error{input} when the surface lies farther from half of the points than a grid spacing: it is not theirs; and
/// when nearly all points lie on surfaces that the view shows edge-on. Names the filter that would help.
void require_surface_near_points(const Projection& projection, const scene::Lattice& lattice, const CheckResult& check);

}  // namespace sparsha::pipeline
