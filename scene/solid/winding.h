// The winding number of an oriented surface at a place: 1 deep inside, 0 far outside, between where the surface has
// holes. Sums over the nodes of all charts, far ones together (Barill, Dickson, Schmidt, Levin & Jacobson 2018, "Fast
// winding numbers for soups and clouds", first order).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "scene/charts.h"

namespace sparsha::scene {

class WindingNumber {
 public:
  /// Nodes of several charts share their part of the surface by the squares of their facing.
  explicit WindingNumber(const Charts& charts);

  /// `place` in spacings from the charts' origin. Nodes nearer than a spacing count as discs of about that size.
  [[nodiscard]] double at(const Eigen::Vector3f& place) const;

 private:
  /// A part of the surface, lengths in spacings.
  struct Piece {
    Eigen::Vector3f centre;
    Eigen::Vector3f area;  ///< times the outward normal
  };
  /// Pieces [begin, end) of a box of the tree; its second child is `second`, its first the next box, none for leaves.
  struct Box {
    Piece all;
    float radius = 0.0F;  ///< of the pieces about their centre
    std::uint32_t begin = 0, end = 0, second = 0;
  };
  static constexpr std::uint32_t kLeaf = 8;  // pieces

  std::uint32_t build(std::uint32_t begin, std::uint32_t end);

  std::vector<Piece> pieces_;
  std::vector<Box> boxes_;
};

}  // namespace sparsha::scene
