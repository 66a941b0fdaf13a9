// Where fingers can read a relief, after the rules for tactile graphics.
#pragma once

#include <filesystem>

#include "pipeline/replica/replica.h"

namespace sparsha::pipeline {

/// Writes the map: grey where nothing of kLeastFeature_mm lies within kLeastGap_mm, blue where features are felt,
/// orange where grooves or ridges are narrower than kLeastGap_mm. Fills report.felt and report.crowded.
void write_legibility(const ReplicaPlate& plate, const std::filesystem::path& file, ReplicaReport& report);

}  // namespace sparsha::pipeline
