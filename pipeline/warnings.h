// What a person should know before trusting a depth grid: each with what to do about it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/check/check.h"
#include "pipeline/grid/project.h"

namespace sparsha::pipeline {

/// About a projection, whose grid is `lattice` with `measured` measured nodes, and its cross-check where there is one.
/// `has_points`: there is more than a mesh.
[[nodiscard]] std::vector<std::string> surface_warnings(const Projection& projection, const Lattice& lattice,
                                                        std::uint64_t measured, bool has_points,
                                                        const std::optional<CheckResult>& check);

/// Throws Error{input} when the surface lies farther from half of the points than a grid spacing: it is not theirs.
void require_surface_near_points(const Lattice& lattice, const CheckResult& check);

}  // namespace sparsha::pipeline
