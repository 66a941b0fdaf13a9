// Which way is up by the formats of several scans of one object: some have z up, others y, and nobody turns them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace sparsha::pipeline {

struct ScanUp {
  std::string name;     ///< file
  std::string format;   ///< RawScan::format
  bool turned = false;  ///< by its pose in the configuration
};

struct UpDifference {
  std::size_t scan = 0;  ///< index of the first one with y up
  std::string reason;    ///< one sentence
};

/// Scans of which some have z up and others y by their formats, those aside that a pose turns and those whose format
/// says nothing.
[[nodiscard]] std::optional<UpDifference> differing_up(const std::vector<ScanUp>& scans);

}  // namespace sparsha::pipeline
