// `audio: {find: pillars}`: regions that have no place are put on the pillars of the scan.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "base/threads/progress.h"
#include "pipeline/filter/pillars.h"
#include "scene/config/audio.h"

namespace sparsha::pipeline {

/// The outline of each pillar as the view sees it becomes the polygon of a region: the thickest one's first, when it is
/// a third thicker than the middle one of the others, then from left to right. Without such regions every pillar gets a
/// note: the thickest sa an octave below, the others sa re ga ma pa dha ni. Regions for which no pillar is left are
/// taken out, with a warning. Afterwards nothing is to be found any more.
void place_on_pillars(scene::AudioConfig& audio, const std::vector<Pillar>& pillars,
                      const Eigen::Matrix4d& scan_to_grid, Progress& progress);

}  // namespace sparsha::pipeline
