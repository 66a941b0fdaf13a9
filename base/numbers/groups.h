// Which things are connected, of many that are joined two by two (Tarjan 1975).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace sparsha {

/// Things 0 to count - 1, at first each a group of its own. A group is named by its lowest thing, whatever the order in
/// which things were joined. Nearly constant time a call. One thread at a time.
class Groups {
 public:
  explicit Groups(std::size_t count) : above_(count) { std::iota(above_.begin(), above_.end(), 0U); }

  /// The lowest thing of the group that a thing is in.
  [[nodiscard]] std::uint32_t of(std::uint32_t thing) {
    while (above_[thing] != thing) thing = above_[thing] = above_[above_[thing]];
    return thing;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = of(a);
    b = of(b);
    above_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> above_;
};

}  // namespace sparsha
