// Replaced operator new that counts.
#include "tests/support/allocations.h"

#include <atomic>
#include <cstdlib>
#include <new>

#if defined(__APPLE__)
#include <malloc/malloc.h>
#else
#include <malloc.h>
#endif

namespace {
std::size_t size_of(void* memory) {
#if defined(__APPLE__)
  return ::malloc_size(memory);
#elif defined(_WIN32)
  return ::_msize(memory);
#else
  return ::malloc_usable_size(memory);
#endif
}

std::atomic<std::size_t> made{0};
std::atomic<std::size_t> bytes{0};
std::atomic<std::size_t> most_bytes{0};
}  // namespace

namespace allocations {
std::size_t count() { return made.load(); }
std::size_t held() { return bytes.load(); }
std::size_t most_held() { return most_bytes.load(); }
void begin_most() { most_bytes.store(bytes.load()); }
}  // namespace allocations

void* operator new(std::size_t size) {
  made.fetch_add(1);
  if (void* memory = std::malloc(size == 0 ? 1 : size)) {
    const std::size_t block = size_of(memory);
    const std::size_t now = bytes.fetch_add(block) + block;
    std::size_t most = most_bytes.load();
    while (most < now && !most_bytes.compare_exchange_weak(most, now)) continue;
    return memory;
  }
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  if (memory != nullptr) bytes.fetch_sub(size_of(memory));
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept { operator delete(memory); }
