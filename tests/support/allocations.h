// Counts calls of operator new in this test program.
#pragma once

#include <cstddef>

namespace allocations {

[[nodiscard]] std::size_t count();

}  // namespace allocations
