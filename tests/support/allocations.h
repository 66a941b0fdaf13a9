// Counts calls of operator new in this test program, and the bytes that are held.
#pragma once

#include <cstddef>

namespace allocations {

[[nodiscard]] std::size_t count();

/// Bytes of all blocks that operator new gave and nobody has given back.
[[nodiscard]] std::size_t held();
/// The most of them at once since the last begin_most().
[[nodiscard]] std::size_t most_held();
void begin_most();

}  // namespace allocations
