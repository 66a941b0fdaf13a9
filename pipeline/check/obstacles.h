// Balls about points that stand in the way of rays.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/numbers/hash.h"
#include "base/numbers/key_table.h"

namespace sparsha::pipeline {

/// Immutable; queries are thread-safe. Any frame and unit.
class Obstacles {
 public:
  /// Those of `centres` that lie in the box from `low` to `high`, balls of `radius` about them.
  Obstacles(std::vector<Eigen::Vector3f> centres, float radius, const Eigen::Vector3f& low,
            const Eigen::Vector3f& high);

  /// Whether a ray comes out of the box without meeting a ball. `direction` is a unit vector.
  [[nodiscard]] bool free(const Eigen::Vector3f& start, const Eigen::Vector3f& direction) const;

 private:
  using Cell = std::array<std::int32_t, 3>;
  struct Content {
    std::uint64_t key = 0;
    std::uint32_t begin = 0, count = 0;  // of entries_
  };
  struct Hash {
    std::uint64_t operator()(std::uint64_t key) const { return hash_word(key); }
  };
  template <typename Use>
  void each_cell_of(const Eigen::Vector3f& centre, const Use& use) const;
  [[nodiscard]] Cell cell_of(const Eigen::Vector3f& place) const;
  [[nodiscard]] bool met(const Content& content, const Eigen::Vector3f& start, const Eigen::Vector3f& direction) const;

  std::vector<Eigen::Vector3f> centres_;
  float radius_, side_;
  Eigen::Vector3f low_;
  Cell last_{};  // of the box; the first is 0, 0, 0
  KeyTable<Content, Hash> cells_;
  std::vector<std::uint32_t> entries_;  // numbers of centres, by cell
};

}  // namespace sparsha::pipeline
