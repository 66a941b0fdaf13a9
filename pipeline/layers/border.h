// How a texture goes on beyond the lattice's border, for filters that reach over it.
#pragma once

#include <cstddef>
#include <vector>

namespace sparsha::pipeline {

/// Rows and columns go on as the quadratic through their last nodes, Gaussian-weighted about the border. Linear in the
/// nodes, so that what a filter makes of it is a filter of these nodes with a noise of its own.
class BorderExtension {
 public:
  /// `scale` of the Gaussian, spacings; `radius`: how far to go on.
  BorderExtension(double scale, int radius);

  /// Nodes that the extension looks at.
  [[nodiscard]] int nodes() const { return nodes_; }
  /// Weights of the nodes 0 to nodes() - 1 from the border inwards for the place k >= 1 beyond it.
  [[nodiscard]] const float* weights(int k) const {
    return weights_.data() + static_cast<std::size_t>(k - 1) * static_cast<std::size_t>(nodes_);
  }
  /// A filter at offsets -radius to radius about a node `distance` nodes from the border, folded back onto the nodes
  /// from the border inwards.
  [[nodiscard]] std::vector<double> folded(const std::vector<double>& filter, int distance) const;

 private:
  int nodes_, radius_;
  std::vector<float> weights_;
};

}  // namespace sparsha::pipeline
