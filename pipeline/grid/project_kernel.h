// The fast way through the nodes that need no thought: one layer in front, all around, with Gaussian residuals.
// Plain pointers only; the same source is compiled for baseline x86-64 and for AVX2, and both give the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace sparsha::pipeline {

/// What a row of nodes is decided from. Arrays may be read up to kReadAhead elements beyond their ends.
struct NodeKernel {
  static constexpr int kReadAhead = 8;
  static constexpr int kMostPoints = 480;  ///< of a 3x3 window; fuller ones are left to NodeFitter

  const std::uint32_t* start = nullptr;  ///< first point of each bin, bins_x bins a row
  const float* top = nullptr;            ///< highest z of each bin, -infinity when empty
  const float* x = nullptr;              ///< metres
  const float* y = nullptr;
  const float* z = nullptr;
  std::size_t bins_x = 0;
  std::size_t margin = 0;  ///< bins before node 0 in x and y
  std::size_t nx = 0;      ///< nodes a row
  double x0_m = 0.0, y0_m = 0.0, spacing_m = 0.0;
  float band_m = 0.0F;          ///< half height of the band that is searched for the front
  float scale_m = 0.0F;         ///< standard deviation of residuals
  float ridge = 0.0F;           ///< prior of the slopes, see LocalFitRule
  const float* per_r2[2] = {};  ///< 1/R^2 of the weights by the number of front points in a window of 3x3, 5x5
};

/// Heights of row `j` into height[0..nx) and 1 into decided[i], or 0 where NodeFitter has to look.
using NodeKernelRow = void (*)(const NodeKernel& kernel, std::size_t j, float* height, std::uint8_t* decided);

void fit_row_baseline(const NodeKernel& kernel, std::size_t j, float* height, std::uint8_t* decided);
void fit_row_avx2(const NodeKernel& kernel, std::size_t j, float* height, std::uint8_t* decided);

/// The fastest that this machine runs.
[[nodiscard]] NodeKernelRow fastest_node_kernel();

}  // namespace sparsha::pipeline
