// CloudCompare as the peer: its raster of the same scan, and its distances to our mesh.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/pipeline/judge.h"
#include "bench/pipeline/process.h"

namespace sparsha::bench {

struct PeerRaster {
  std::vector<Sample> samples;
  ProcessResult process;
};

/// RASTERIZE with `projection` AVG or MAX, after SOR with 30 neighbours when `clean`; scan frame = grid frame only.
/// Nothing when the program is missing or fails.
[[nodiscard]] std::optional<PeerRaster> cloudcompare_raster(const std::filesystem::path& scan, double spacing_m,
                                                            const std::string& projection, bool clean);

/// Unsigned distances of the scan's points to the mesh (C2M_DIST).
struct PeerDistances {
  double mean_m = 0.0, rms_m = 0.0;
  std::size_t points = 0;
};
[[nodiscard]] std::optional<PeerDistances> cloudcompare_distances(const std::filesystem::path& scan,
                                                                  const std::filesystem::path& mesh);

}  // namespace sparsha::bench
