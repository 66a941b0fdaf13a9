// One node of the depth grid: which layer of points is the front there, and its height by a robust local fit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "pipeline/projection/bins.h"
#include "pipeline/projection/local_fit.h"

namespace sparsha::pipeline {

/// What the decisions at a node rest on.
struct NodeFitParameters {
  double noise_m = 0.0;   ///< standard deviation of the points' heights
  int widest_window = 4;  ///< nodes to each side that a window may grow
};

/// Height relative to the oriented points' origin; meaningless unless measured.
struct NodeFit {
  bool measured = false;
  double height_m = 0.0;
  double slope_x = 0.0, slope_y = 0.0;
};

/// Depth gap that separates two layers where points are `point_spacing_m` apart: six sigma of noise, and what a slope
/// of 56 degrees descends from one point to the next.
[[nodiscard]] double layer_gap_m(double noise_m, double point_spacing_m);

/// Radius of the kernel in spacings: 1.5 local ones at four points per node, wider where points are few, less where
/// there are points to spare. `window_area` in nodes.
[[nodiscard]] double kernel_radius(double spacing, std::size_t points, double window_area);
/// What it falls to where spacings are 1 and points many.
[[nodiscard]] double least_kernel_radius();

/// Decides nodes one at a time; holds scratch memory, so every thread has its own.
class NodeFitter {
 public:
  NodeFitter(const Bins& bins, const NodeFitParameters& rule) : bins_(bins), rule_(rule) {}

  /// `least_reach` is the smallest window, nodes to each side.
  [[nodiscard]] NodeFit fit(int i, int j, int least_reach = 1);

  /// True when the smallest window holds points above `above_m`, but too few to be a layer.
  [[nodiscard]] bool misses_thin_front(int i, int j, float above_m) const;

  /// Points in the window of `reach` nodes to each side.
  [[nodiscard]] std::size_t count_window(int i, int j, int reach) const;

 private:
  struct Layer {
    std::size_t begin, end;
    [[nodiscard]] std::size_t size() const { return end - begin; }
  };
  struct Slope {
    double u = 0.0, v = 0.0;  // metres per spacing
  };

  void gather(int i, int j, int reach);
  void split_layers(Slope slope, double gap_m);
  [[nodiscard]] double compactness(Slope slope, double thickness_m) const;
  void split_along_best_slope(Slope plain_fit, double total_spacing_m);
  [[nodiscard]] double point_spacing(int i, int j, int reach, const Layer& layer);
  [[nodiscard]] double off_centre(const Layer& layer) const;
  void keep_near_fit(const Layer& layer, std::vector<NodePoint>& kept);
  [[nodiscard]] bool ends_before_node();
  [[nodiscard]] const Layer& layer_at_node(double spacing);
  [[nodiscard]] std::span<const NodePoint> points_of(const Layer& layer) const {
    return {points_.data() + layer.begin, layer.size()};
  }

  const Bins& bins_;
  NodeFitParameters rule_;
  std::vector<NodePoint> gathered_;  // in the order of the bins
  std::vector<NodePoint> points_;    // in layers, highest first
  std::vector<float> rise_;          // of the gathered points above the slope
  std::vector<std::uint32_t> rank_;
  std::vector<std::pair<float, std::uint32_t>> sorted_;
  std::vector<Layer> layers_;          // supported ones, the highest first
  std::vector<float> spacing_of_bin_;  // of the window, around each bin; 0 where nobody has asked yet
  std::vector<float> scratch_;
  std::vector<NodePoint> sides_[2];  // of a step
};

}  // namespace sparsha::pipeline
