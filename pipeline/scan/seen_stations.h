// What the stations of a file saw, as its points come in.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pipeline/scan/origin.h"
#include "pipeline/scan/raster_steps.h"
#include "pipeline/scan/reader.h"

namespace sparsha::pipeline {

/// File units.
struct SeenStation {
  Eigen::Vector3d place;
  PointSample sample;
  PointSample at_scanner;  ///< what may be empty returns, until their number is known
  RasterSteps steps;       ///< of its points about its place
};

/// Adds a block to the last station, or to a new one where it names another place; to 256 at most.
void add_to_stations(const PointBlock& block, std::vector<SeenStation>& stations);
/// The same of a scan in memory.
void add_to_stations(const RawScan& scan, std::vector<SeenStation>& stations);

}  // namespace sparsha::pipeline
