// One node of the depth grid: which layer of points is the front there, and its height by a robust local fit.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/grid/project_bins.h"
#include "pipeline/grid/project_fit.h"

namespace sparsha::pipeline {

/// What the decisions at a node rest on.
struct NodeRule {
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

/// Decides nodes one at a time; holds scratch memory, so every thread has its own.
class NodeFitter {
 public:
  NodeFitter(const Bins& bins, const NodeRule& rule) : bins_(bins), rule_(rule) {}

  [[nodiscard]] NodeFit fit(int i, int j);

 private:
  struct Layer {
    std::size_t begin, end;
    [[nodiscard]] std::size_t size() const { return end - begin; }
  };

  [[nodiscard]] std::size_t count_window(int i, int j, int reach) const;
  void gather(int i, int j, int reach);
  void split_layers(double gap_m, std::size_t least);
  [[nodiscard]] double point_spacing(int i, int j, int reach, const Layer& layer) const;
  [[nodiscard]] const Layer* layer_at_node(double spacing) const;
  [[nodiscard]] std::span<const NodePoint> points_of(const Layer& layer) const {
    return {points_.data() + layer.begin, layer.size()};
  }

  const Bins& bins_;
  NodeRule rule_;
  std::vector<NodePoint> points_;
  std::vector<Layer> layers_;  // supported ones, the highest first
  std::vector<double> scratch_;
};

}  // namespace sparsha::pipeline
