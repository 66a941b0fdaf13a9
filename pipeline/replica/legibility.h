// Where fingers can read a relief, after the rules for tactile graphics.
#pragma once

#include <filesystem>

#include "pipeline/replica/replica.h"

namespace sparsha::pipeline {

/// Writes the map: grey where nothing of kLeastFeatureMm lies within kLeastGapMm, blue where features are felt, orange
/// where grooves or ridges are narrower than kLeastGapMm. Fills report.felt and report.crowded.
void write_legibility(const ReplicaPlate& plate, const std::filesystem::path& file, ReplicaReport& report);

}  // namespace sparsha::pipeline
