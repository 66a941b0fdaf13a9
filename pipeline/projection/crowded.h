// Bins that hold far more points than a height needs, as on a grid much coarser than the scan.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/threads/thread_pool.h"
#include "pipeline/projection/bins.h"

namespace sparsha::pipeline {

/// Points of a bin that decide its nodes, at most: those whose coordinates have the smallest hashes, a uniform sample
/// that depends on the set of points alone. A mean of so many is known to a thirtieth of the noise.
constexpr std::size_t kMostInBin = 1024;

/// Leaves kMostInBin points in each bin of the window's rows, in their order. Points of a bin differ, see
/// leave_out_repeats(). Changes no bit where no bin has more.
void leave_out_crowd(Bins& bins, const BinWindow& window, ThreadPool& pool);

/// The same choice for one bin whose points come one by one, in memory for twice as many.
class CrowdedBin {
 public:
  void add(float x, float y, float z);
  /// The chosen points, each once.
  [[nodiscard]] std::vector<std::array<float, 3>> take();

 private:
  struct Entry {
    std::uint64_t hash;
    std::array<float, 3> point;
  };
  void leave_out();

  std::vector<Entry> entries_;
};

}  // namespace sparsha::pipeline
