// Places that several corners of a mesh share.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "base/numbers/hash.h"
#include "base/numbers/key_table.h"

namespace sparsha::pipeline {

/// Numbers places from 0 in the order in which they first come. Places are the same where their float32 coordinates
/// are; -0.0 is 0.0. Up to 2^31 places.
class Places {
 public:
  /// size() before the call when the place is new.
  [[nodiscard]] std::uint32_t number(float x, float y, float z) {
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value + 0.0F); };
    return table_.number({bits(x), bits(y), bits(z)});
  }
  [[nodiscard]] std::size_t size() const { return table_.size(); }

 private:
  struct Place {
    std::array<std::uint32_t, 3> key;  ///< the bits of x, y and z
  };
  struct PlaceHash {
    std::uint64_t operator()(const std::array<std::uint32_t, 3>& key) const {
      return hash_words(std::array<std::uint64_t, 2>{std::uint64_t{key[0]} << 32U | key[1], key[2]});
    }
  };
  KeyTable<Place, PlaceHash> table_;
};

}  // namespace sparsha::pipeline
