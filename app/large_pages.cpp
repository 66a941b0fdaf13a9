// The heap in large pages. A build makes and gives back arrays of megabytes at every step, and the system needs a third
// as long to hand them over page by page as the work on them takes.
#include <malloc.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>

#include "base/system.h"

namespace {

using sparsha::system::kLargePageBytes;
// Smaller blocks seldom make the heap grow.
constexpr std::size_t kLargeBlock = std::size_t{64} << 10U;

/// Where the heap ends.
char* heap_end() noexcept { return static_cast<char*>(::sbrk(0)); }

/// The border of large pages at or below a place.
std::uintptr_t border_below(const char* place) noexcept {
  return reinterpret_cast<std::uintptr_t>(place) / kLargePageBytes * kLargePageBytes;
}

/// Up to here the heap lies in large pages; on the border of one.
std::atomic<std::uintptr_t> advised_to{0};

/// Blocks of up to 32 MB come from the heap and go back to it, and 64 MB of it are kept for those to come.
const bool kHeapIsKept = [] {
  ::mallopt(M_MMAP_THRESHOLD, 32 << 20);
  ::mallopt(M_TRIM_THRESHOLD, 64 << 20);
  ::mallopt(M_TOP_PAD, 16 << 20);
  advised_to = border_below(heap_end()) + kLargePageBytes;
  return true;
}();

/// Asks for large pages where the heap has grown.
void advise_heap() noexcept {
  char* const end = heap_end();
  const std::uintptr_t border = border_below(end);
  std::uintptr_t from = advised_to.load(std::memory_order_relaxed);
  if (border >= from && border - from < 2 * kLargePageBytes) return;
  if (from == 0 || !advised_to.compare_exchange_strong(from, border)) return;
  if (border > from) {
    const std::size_t grown = border - from;
    sparsha::system::advise_large_pages(end - (reinterpret_cast<std::uintptr_t>(end) - from), grown);
  }
}

void* allocate(std::size_t size) noexcept {
  void* const block = std::malloc(size == 0 ? 1 : size);
  if (size >= kLargeBlock && block != nullptr) {
    advise_heap();
    if (size >= 2 * kLargePageBytes) sparsha::system::advise_large_pages(block, size);
  }
  return block;
}

}  // namespace

void* operator new(std::size_t size) {
  for (;;) {
    if (void* const block = allocate(size)) return block;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }
