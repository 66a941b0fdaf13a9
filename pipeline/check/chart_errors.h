// How far the scans' points lie from a whole object, place by place: for the eye, as CheckMap is of one view.
#pragma once

#include "base/threads/context.h"
#include "pipeline/check/charts_check.h"
#include "scene/charts.h"

namespace sparsha::pipeline {

/// Sets Sheet::error_m of all sheets: the mean distance of the check's points about a node, as far about it as holds a
/// dozen of them on an even surface. NaN where none is near.
void add_errors(scene::Charts& charts, const ChartCheck& check, const Context& context);

}  // namespace sparsha::pipeline
