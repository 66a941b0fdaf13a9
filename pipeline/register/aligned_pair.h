// A pair of scans while it is worked on, and the same as numbers.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "pipeline/register/match.h"
#include "pipeline/register/register.h"

namespace sparsha::pipeline {

struct AlignedPair {
  PairFit fit;
  bool tried = false;
  bool candidate = false;
  bool any_sign = false;  ///< normals face opposite sides where the scans meet: their signs were guessed wrongly
  Eigen::Isometry3d aligned = Eigen::Isometry3d::Identity();  ///< second to first
  Agreement agreement;                                        ///< of the medium surfaces, when aligned
  Hold hold;                                                  ///< of the fine ones
  bool unsure = false;                                        ///< whether this is the place
};

/// What an alignment has found: all but the scans' numbers, `tried`, and what is judged later.
[[nodiscard]] std::vector<double> numbers_of(const AlignedPair& pair);
/// False, with the pair as it was, when these are no numbers of one.
[[nodiscard]] bool take_numbers(const std::vector<double>& numbers, AlignedPair& pair);

/// A rigid motion as 12 numbers, column by column.
void add_numbers(const Eigen::Isometry3d& motion, std::vector<double>& numbers);
[[nodiscard]] Eigen::Isometry3d motion_of(const double* numbers);

}  // namespace sparsha::pipeline
