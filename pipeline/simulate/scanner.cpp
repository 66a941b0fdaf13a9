// A station's beams against the solid.
#include "pipeline/base/error.h"
#include "pipeline/simulate/generate.h"

namespace sparsha::pipeline {

void scan_station(const SimulationConfig&, const Surface&, std::size_t, ThreadPool&, Progress&, const PointSink&) {
  throw usage_error("stations", "expected a sampler");
}

}  // namespace sparsha::pipeline
