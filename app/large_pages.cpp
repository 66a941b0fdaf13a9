// The heap in large pages, and large arrays in files where a build asks for it. A build takes and frees arrays of
// megabytes at every step; with small pages a quarter of its time was spent in page faults.
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

#include "base/system.h"
#include "base/system/disk_arrays.h"

namespace {

using sparsha::system::kLargePageBytes;
// Smaller blocks seldom make the heap grow.
constexpr std::size_t kLargeBlock = std::size_t{64} << 10U;

/// Where the heap ends.
char* heap_end() noexcept { return static_cast<char*>(::sbrk(0)); }

/// The border of large pages at or below a place.
char* border_below(char* place) noexcept { return place - reinterpret_cast<std::uintptr_t>(place) % kLargePageBytes; }

/// Up to this border the heap lies in large pages; null before main().
std::atomic<char*> advised_to{nullptr};

[[maybe_unused]] const bool kHeapIsKept = [] {
  sparsha::system::keep_heap();
  advised_to = border_below(heap_end()) + kLargePageBytes;
  sparsha::system::allow_disk_arrays();
  return true;
}();

/// Asks for large pages where the heap has grown, and begins anew where it has shrunk. One call of the system for
/// several megabytes of growth, none otherwise.
void advise_heap() noexcept {
  char* const border = border_below(heap_end());
  char* from = advised_to.load(std::memory_order_relaxed);
  const std::ptrdiff_t grown = border - from;
  if (from == nullptr || (grown >= 0 && grown < static_cast<std::ptrdiff_t>(2 * kLargePageBytes))) return;
  if (advised_to.compare_exchange_strong(from, border) && grown > 0)
    sparsha::system::advise_large_pages(from, static_cast<std::size_t>(grown));
}

void* allocate(std::size_t size) noexcept {
  if (sparsha::system::wants_disk_array(size)) return sparsha::system::take_disk_array(size);
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
void operator delete(void* block) noexcept {
  if (!sparsha::system::give_disk_array(block)) std::free(block);
}
void operator delete(void* block, std::size_t) noexcept { operator delete(block); }
