// Holes of the front where windows decide about nodes: what is seen through them faces away and is no front.
#pragma once

#include "base/thread_pool.h"
#include "pipeline/projection/plan.h"
#include "pipeline/projection/projection.h"

namespace sparsha::pipeline {

/// Makes nodes unknown that surely face away and lie behind what is around them, and counts them and those that lie so
/// and of which nothing tells which way they face. Of a whole grid that windows measured; does nothing where discs
/// decide, which know facing, or where nobody asked.
void leave_out_turned_away(const ProjectionPlan& plan, ThreadPool& pool, Projection& projection);

}  // namespace sparsha::pipeline
