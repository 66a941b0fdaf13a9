// Colour and intensity of the front surface at the nodes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/projection/bins.h"
#include "pipeline/projection/intensity_scale.h"
#include "pipeline/projection/points.h"
#include "pipeline/projection/projection.h"
#include "pipeline/projection/triangles.h"

namespace sparsha::pipeline {

/// Means of used points, weighted towards the node. Integer sums, so that neither the points' order nor how they are
/// cut into pieces matters.
class AttributeSums {
 public:
  /// Which attributes are summed. `largest_intensity` is the largest magnitude of a finite one.
  AttributeSums(const scene::Lattice& nodes, const BinLattice& lattice, bool colour, bool intensity,
                float largest_intensity);

  /// `rgba` and `intensity` hold one value per point where they are summed.
  void add(const OrientedPoints& points, const PointClass* point_class, const std::uint32_t* rgba,
           const float* intensity);

  /// Fills projection.colour_rgba and intensity. Nodes near which no used point has any get kNoColour and kNoIntensity.
  void write(Projection& projection) const;
  /// The same with a mesh: where a node's height is a triangle's, that one's corners count by barycentric weights.
  void write(Projection& projection, const Cloud& cloud, const OrientedPoints& points,
             const TriangleHeights& mesh) const;

 private:
  /// Up to four channels of an attribute, 0 to 255 or a value scaled to integers.
  template <std::size_t Channels>
  struct Sum {
    std::array<std::int64_t, Channels> value{};
    std::int64_t weight = 0;
  };
  template <std::size_t Channels, typename Read>
  void splat(std::vector<Sum<Channels>>& sums, const OrientedPoints& points, const PointClass* point_class,
             const Read& read) const;
  template <std::size_t Channels, typename OnMesh, typename Write>
  void each_node(const std::vector<Sum<Channels>>& sums, const Projection& projection, const OnMesh& on_mesh,
                 const Write& write) const;
  template <typename ColourOnMesh, typename IntensityOnMesh>
  void write_all(Projection& projection, const ColourOnMesh& colour_on_mesh,
                 const IntensityOnMesh& intensity_on_mesh) const;
  [[nodiscard]] std::optional<std::array<std::int64_t, 1>> scaled(float intensity) const;

  scene::Lattice nodes_;
  BinLattice lattice_;
  IntensityScale intensity_scale_;
  std::vector<Sum<4>> colour_;
  std::vector<Sum<1>> intensity_;
};

}  // namespace sparsha::pipeline
