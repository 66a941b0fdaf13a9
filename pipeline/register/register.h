// Stations with rough poses -> poses that make them one cloud, and how well each pair of them agrees.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "scene/config/registration.h"
#include "scene/config/scans.h"

namespace sparsha::pipeline {

class FinishedPairs;

/// How two scans of a set lie to each other; indices into the configuration's scans, first < second.
struct PairFit {
  /// What was found within a distance: the larger share of one scan's points that have their place on the other, and
  /// the RMS distance there.
  struct Fit {
    double within_m = 0.0;
    double overlap = 0.0;
    double residual_m = 0.0;
    std::size_t matches = 0;
  };
  enum class Use {
    none,      ///< too little in common
    used,      ///< part of the graph
    weak,      ///< in common only what can slide (a plane, a cylinder, a sphere)
    rejected,  ///< contradicts the others, or moved farther than rough poses may be wrong
  };
  std::size_t first = 0;
  std::size_t second = 0;
  Fit before;  ///< poses as given, or as guessed from features
  Fit after;   ///< poses as found; as given where nothing was registered
  Use use = Use::none;
};
[[nodiscard]] std::string to_string(PairFit::Use use);

/// Where features put a scan: on which other one, and the larger share of one's thinned points that has its place on
/// the other. Indices into the configuration's scans.
struct FirstGuess {
  std::size_t scan = 0;
  std::size_t on = 0;
  double overlap = 0.0;
};

struct Registration {
  /// Of the configuration's scans, rigid. The first is as given, or turned the least that makes it rigid to 1e-9; that
  /// of a scan without points is as given.
  std::vector<Eigen::Matrix4d> poses;
  std::vector<FirstGuess> guesses;  ///< in the order in which scans were placed; empty where poses were given
  std::vector<PairFit> pairs;       ///< all that have something in common before or after
};

/// Finds poses, from those given or from features alone (RegisterConfig::guess). Scans without points are left out with
/// a warning that names them. Throws Error{usage} on a single scan; Error{input} when fewer than two have points, and
/// naming the scans when one cannot be linked to the first: too little overlap, surfaces that slide, or
/// features that do not tell for sure; Cancelled. The result does not depend on the number of threads, nor on what is
/// taken from `finished`, where results of pairs are kept unless it is null; also Error{failure} when they cannot be.
[[nodiscard]] Registration register_scans(const std::vector<scene::ScanConfig>& scans,
                                          const scene::RegisterConfig& config, const Context& context,
                                          FinishedPairs* finished = nullptr);

/// Measures pairs with the poses as given and moves nothing: `before` and `after` are the same.
[[nodiscard]] std::vector<PairFit> measure_pairs(const std::vector<scene::ScanConfig>& scans,
                                                 const scene::RegisterConfig& config, const Context& context);

}  // namespace sparsha::pipeline
