// The cross-check's distances as a map for the eye.
#pragma once

#include <memory>

#include "pipeline/check/check.h"
#include "scene/check_map.h"

namespace sparsha::pipeline {

/// Distances of the sampled points averaged over spots that hold about four samples each, as the report's picture
/// does; NaN where `grid` knows no height. Null when nothing was sampled.
[[nodiscard]] std::shared_ptr<const scene::CheckMap> check_map_of(const scene::DepthGrid& grid,
                                                                  const CheckResult& check);

}  // namespace sparsha::pipeline
