#include "pipeline/scan/formats/text/no_data.h"

#include <algorithm>
#include <cmath>

namespace sparsha::pipeline {
namespace {

constexpr double kNoCoordinate = 1e20;  // in any unit
constexpr double kFarShare = 0.25;      // of itself, that a value is away from all heights at least
constexpr std::uint64_t kFewest = 3;    // a surface has no height so often to the last digit by chance

}  // namespace

bool NoDataValues::is_listed(double z) {
  return (std::isfinite(z) && std::abs(z) >= kNoCoordinate) ||
         std::find(kValues.begin(), kValues.end(), z) != kValues.end();
}

void NoDataValues::add(double z) {
  if (!std::isfinite(z) || std::abs(z) >= kNoCoordinate) return;
  const auto found = std::find(kValues.begin(), kValues.end(), z);
  if (found != kValues.end()) {
    ++counts_[static_cast<std::size_t>(found - kValues.begin())];
    return;
  }
  low_ = any_ ? std::min(low_, z) : z;
  high_ = any_ ? std::max(high_, z) : z;
  any_ = true;
}

void NoDataValues::decide() {
  for (std::size_t k = 0; any_ && k < kValues.size(); ++k) {
    const double gap = std::max(low_ - kValues[k], kValues[k] - high_);
    found_[k] = counts_[k] >= kFewest && gap >= std::max(high_ - low_, kFarShare * std::abs(kValues[k]));
  }
}

bool NoDataValues::contains(double z) const {
  if (std::isfinite(z) && std::abs(z) >= kNoCoordinate) return true;
  const auto found = std::find(kValues.begin(), kValues.end(), z);
  return found != kValues.end() && found_[static_cast<std::size_t>(found - kValues.begin())];
}

}  // namespace sparsha::pipeline
