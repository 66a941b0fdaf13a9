// Inside and outside at the points of the lattice whose lines the charts' nodes lie on: every node is where a line of
// the lattice passes through the surface. Lengths are in spacings.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "base/numbers/hash.h"
#include "base/numbers/key_table.h"
#include "base/threads/context.h"
#include "scene/charts.h"
#include "scene/solid/winding.h"

namespace sparsha::pipeline {

/// A point of the lattice, spacings from the charts' origin.
using LatticePoint = std::array<std::int32_t, 3>;

/// Points and lines near the surface, found by their place.
class SurfaceLattice {
 public:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  static constexpr std::int32_t kMost = (1 << 20) - 4;  ///< of a coordinate's magnitude

  /// Throws Error{usage} when the object is more than kMost spacings from the charts' origin.
  explicit SurfaceLattice(const scene::Charts& charts);

  [[nodiscard]] std::uint32_t points() const { return static_cast<std::uint32_t>(table_.size()); }
  [[nodiscard]] std::uint32_t number(const LatticePoint& point) { return table_.number(key_of(point)); }
  /// points() when the lattice does not know it.
  [[nodiscard]] std::uint32_t find(const LatticePoint& point) const { return table_.find(key_of(point)); }
  [[nodiscard]] LatticePoint place(std::uint32_t number) const { return point_of(table_[number].key); }
  /// Whether nodes on lines from the point tell its side.
  [[nodiscard]] bool measured(std::uint32_t number) const { return table_[number].side == Known::nodes; }
  [[nodiscard]] bool known(std::uint32_t number) const { return table_[number].side != Known::no; }
  [[nodiscard]] bool inside(std::uint32_t number) const { return table_[number].distance < 0.0F; }
  /// Winding numbers tell the sides of points that no node tells.
  void decide(const std::vector<std::uint32_t>& numbers, const scene::WindingNumber& winding, const Context& context);

  /// Where the surface passes between a point and the next along an axis, 0 to 1; whether a node says so. Requires that
  /// one is inside and one outside.
  struct Passage {
    float at;
    bool measured;
  };
  [[nodiscard]] Passage passage(std::uint32_t low, std::uint32_t high, int axis) const;
  /// The number of a vertex on the line from a point along an axis; kNone at first.
  [[nodiscard]] std::uint32_t& vertex(std::uint32_t number, int axis) {
    return table_[number].vertex[static_cast<std::size_t>(axis)];
  }
  /// Nodes on the line from a point along an axis.
  [[nodiscard]] bool has_node(std::uint32_t number, int axis) const {
    return table_[number].first[static_cast<std::size_t>(axis)] != kNone;
  }

  [[nodiscard]] static std::uint64_t key_of(const LatticePoint& point) {
    std::uint64_t key = 0;
    for (const std::int32_t x : point) key = key << 21U | static_cast<std::uint64_t>(x + (1 << 20));
    return key;
  }
  [[nodiscard]] static LatticePoint point_of(std::uint64_t key) {
    const auto part = [key](unsigned shift) {
      return static_cast<std::int32_t>(key >> shift & ((1U << 21U) - 1U)) - (1 << 20);
    };
    return {part(42), part(21), part(0)};
  }

 private:
  enum class Known : std::uint8_t { no, nodes, winding };
  struct Node {
    float at;      ///< from the lower point, 0 to 1
    float facing;  ///< of the outward normal along the axis, signed
    std::uint32_t next;
  };
  struct Point {
    std::uint64_t key = 0;
    float distance = 0.0F;                                    ///< from the surface, about; negative inside
    std::array<std::uint32_t, 3> first{kNone, kNone, kNone};  ///< nodes on the lines to the next points
    std::array<std::uint32_t, 3> vertex{kNone, kNone, kNone};
    Known side = Known::no;
  };
  struct Hash {
    std::uint64_t operator()(std::uint64_t key) const { return hash_word(key); }
  };

  void add(const scene::Charts& charts, const scene::Sheet& sheet, int i, int j);
  void judge();

  KeyTable<Point, Hash> table_;
  std::vector<Node> nodes_;
};

}  // namespace sparsha::pipeline
