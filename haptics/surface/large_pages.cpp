#include "haptics/surface/large_pages.h"

#include <cstdint>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace sparsha::haptics {

std::vector<float> room_for(std::size_t count) {
  std::vector<float> values;
  values.reserve(count);
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  // Before the pages are touched for the first time. Advice only: what the system makes of it changes no value.
  constexpr std::size_t kLargePage = std::size_t{2} << 20;  // bytes
  const std::size_t bytes = count * sizeof(float);
  if (bytes >= 2 * kLargePage) {
    void* const first = values.data();
    const std::size_t off = (kLargePage - reinterpret_cast<std::uintptr_t>(first) % kLargePage) % kLargePage;
    const std::size_t whole = (bytes - off) / kLargePage * kLargePage;
    static_cast<void>(madvise(static_cast<char*>(first) + off, whole, MADV_HUGEPAGE));
  }
#endif
  return values;
}

}  // namespace sparsha::haptics
