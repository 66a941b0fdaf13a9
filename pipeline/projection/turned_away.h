// Holes of the front: what is seen through them faces away and is no front.
#pragma once

#include <cstdint>
#include <vector>

#include "base/threads/thread_pool.h"
#include "pipeline/projection/plan.h"
#include "pipeline/projection/projection.h"

namespace sparsha::pipeline {

/// Makes nodes unknown that surely face away and lie behind what is around them, or of which stations say so, and
/// counts them. Of a whole grid; `verdicts` of its nodes where discs decided, else empty. Where windows decided, counts
/// the nodes, too, that lie so and of which nothing tells which way they face.
void leave_out_turned_away(const ProjectionPlan& plan, const std::vector<std::uint8_t>& verdicts, ThreadPool& pool,
                           Projection& projection);

}  // namespace sparsha::pipeline
