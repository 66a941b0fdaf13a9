// The surface is followed from cube to cube, beginning at the nodes.
#include "pipeline/solid/cubes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/error.h"
#include "base/numbers/hash.h"
#include "base/numbers/key_table.h"

namespace sparsha::pipeline {
namespace {

/// Cubes that the surface passes through.
class Cubes {
 public:
  Cubes(SurfaceLattice& lattice, const scene::WindingNumber& winding, const Context& context)
      : lattice_(lattice), winding_(winding), context_(context) {
    begin();
    const std::size_t most = 8 * cells_.size() + kSpare;
    for (std::size_t from = 0; from < cells_.size();) {
      const std::size_t to = cells_.size();
      decide(from, to);
      for (; from < to; ++from) go_on(SurfaceLattice::point_of(cells_[static_cast<std::uint32_t>(from)].key));
      if (cells_.size() > most) {
        throw Error(ErrorKind::input, {},
                    "what the scans saw of the object encloses nothing: hardly any of it was seen from behind",
                    "scans from all sides, or a scene without `around`");
      }
    }
  }

  /// Sorted by place.
  [[nodiscard]] std::vector<std::uint64_t> take() {
    std::vector<std::uint64_t> keys;
    keys.reserve(cells_.size());
    for (const Cell& cell : cells_.take()) keys.push_back(cell.key);
    std::sort(keys.begin(), keys.end());
    return keys;
  }

 private:
  static constexpr std::size_t kSpare = 100'000;  // cells
  struct Cell {
    std::uint64_t key = 0;
  };
  struct Hash {
    std::uint64_t operator()(std::uint64_t key) const { return hash_word(key); }
  };

  void add(const LatticePoint& cell) {
    for (const std::int32_t x : cell) {
      if (std::abs(x) >= SurfaceLattice::kMost) return;
    }
    (void)cells_.number(SurfaceLattice::key_of(cell));
  }

  // Cubes about pieces of lines that nodes lie on.
  void begin() {
    const std::uint32_t count = lattice_.points();
    for (std::uint32_t low = 0; low < count; ++low) {
      const LatticePoint place = lattice_.place(low);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        LatticePoint next = place;
        ++next[axis];
        const std::uint32_t high = lattice_.find(next);
        if (high == lattice_.points() || lattice_.inside(low) == lattice_.inside(high)) continue;
        for (int side = 0; side < 4; ++side) {
          LatticePoint cell = place;
          cell[(axis + 1) % 3] -= side & 1;
          cell[(axis + 2) % 3] -= side >> 1;
          add(cell);
        }
      }
    }
  }

  void decide(std::size_t from, std::size_t to) {
    std::vector<std::uint32_t> unknown;
    for (std::size_t k = from; k < to; ++k) {
      const LatticePoint cell = SurfaceLattice::point_of(cells_[static_cast<std::uint32_t>(k)].key);
      for (int corner = 0; corner < 8; ++corner) {
        const std::uint32_t before = lattice_.points();
        const std::uint32_t number = lattice_.number(corner_of(cell, corner));
        if (number == before) unknown.push_back(number);
      }
    }
    lattice_.decide(unknown, winding_, context_);
  }

  // The cubes beyond faces with corners on both sides.
  void go_on(const LatticePoint& cell) {
    unsigned inside = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const std::uint32_t number = lattice_.find(corner_of(cell, corner));
      inside |= lattice_.inside(number) ? 1U << static_cast<unsigned>(corner) : 0U;
    }
    constexpr std::array<unsigned, 6> kFaces{0x55, 0xAA, 0x33, 0xCC, 0x0F, 0xF0};
    for (std::size_t face = 0; face < kFaces.size(); ++face) {
      const unsigned here = inside & kFaces[face];
      if (here == 0 || here == kFaces[face]) continue;
      LatticePoint next = cell;
      next[face / 2] += face % 2 == 0 ? -1 : 1;
      add(next);
    }
  }

  SurfaceLattice& lattice_;
  const scene::WindingNumber& winding_;
  const Context& context_;
  KeyTable<Cell, Hash> cells_;
};

}  // namespace

LatticePoint corner_of(LatticePoint cell, int corner) {
  for (int axis = 0; axis < 3; ++axis) cell[static_cast<std::size_t>(axis)] += corner >> axis & 1;
  return cell;
}

std::vector<std::uint64_t> surface_cubes(SurfaceLattice& lattice, const scene::WindingNumber& winding,
                                         const Context& context) {
  return Cubes(lattice, winding, context).take();
}

}  // namespace sparsha::pipeline
