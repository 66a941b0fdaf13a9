// Memory for surfaces that do not fit into a processor's cache.
#pragma once

#include <cstddef>
#include <vector>

namespace sparsha::haptics {

/// An empty vector with room for `count` values, in large pages where they are many and the system gives such pages:
/// a proxy that walks from row to row then waits for memory only, not for page tables too.
[[nodiscard]] std::vector<float> reserve_large(std::size_t count);

}  // namespace sparsha::haptics
