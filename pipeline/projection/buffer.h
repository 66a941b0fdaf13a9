// Large arrays that are written before they are read: not cleared, and on large pages where the system has them.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/system.h"

namespace sparsha::pipeline {

/// Keeps the memory of large arrays for the next ones, since fresh pages cost more than what is computed in them. Must
/// outlive the buffers that it gave. Any thread.
class MemoryStore {
 public:
  MemoryStore() = default;
  MemoryStore(const MemoryStore&) = delete;
  MemoryStore& operator=(const MemoryStore&) = delete;
  ~MemoryStore() { clear(); }

  /// Memory of at least `bytes`, and at most twice as many, and its true size; or null when none is kept.
  /// In the latter case one that is a little too small is given back to the system, so that what is kept does not grow.
  [[nodiscard]] std::pair<void*, std::size_t> take(std::size_t bytes) noexcept {
    const std::lock_guard lock(mutex_);
    auto best = kept_.end(), outgrown = kept_.end();
    for (auto it = kept_.begin(); it != kept_.end(); ++it) {
      if (it->second < bytes && it->second > bytes / 2) outgrown = it;
      if (it->second < bytes || it->second / 2 > bytes) continue;
      if (best == kept_.end() || it->second < best->second) best = it;
    }
    if (best == kept_.end()) {
      if (outgrown != kept_.end()) {
        std::free(outgrown->first);
        kept_.erase(outgrown);
      }
      return {nullptr, 0};
    }
    const std::pair<void*, std::size_t> found = *best;
    kept_.erase(best);
    return found;
  }
  /// Gives back to the system what is kept.
  void clear() noexcept {
    const std::lock_guard lock(mutex_);
    for (const auto& [memory, bytes] : kept_) std::free(memory);
    kept_.clear();
  }
  void give(void* memory, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    kept_.emplace_back(memory, bytes);
  }

 private:
  std::mutex mutex_;
  std::vector<std::pair<void*, std::size_t>> kept_;
};

struct FreeMemory {
  MemoryStore* store = nullptr;
  std::size_t bytes = 0;

  void operator()(void* memory) const noexcept {
    if (store != nullptr) {
      try {
        store->give(memory, bytes);
        return;
      } catch (const std::bad_alloc&) {
        // Then it is simply not kept.
      }
    }
    std::free(memory);
  }
};

template <typename T>
using Buffer = std::unique_ptr<T[], FreeMemory>;

/// Memory for `count` values, from `store` when it is given and has some. Throws std::bad_alloc.
template <typename T>
[[nodiscard]] Buffer<T> make_buffer(std::size_t count, MemoryStore* store = nullptr) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::size_t bytes = count * sizeof(T);
  constexpr std::size_t kLeastKept = std::size_t{1} << 16U;
  if (bytes < 2 * system::kLargePageBytes) {
    const bool keep = store != nullptr && bytes >= kLeastKept;
    if (keep) {
      const auto [kept, size] = store->take(bytes);
      if (kept != nullptr) return Buffer<T>(static_cast<T*>(kept), FreeMemory{store, size});
    }
    void* memory = std::malloc(bytes > 0 ? bytes : 1);
    if (memory == nullptr) throw std::bad_alloc();
    return keep ? Buffer<T>(static_cast<T*>(memory), FreeMemory{store, bytes}) : Buffer<T>(static_cast<T*>(memory));
  }
  const std::size_t whole = (bytes + system::kLargePageBytes - 1) / system::kLargePageBytes * system::kLargePageBytes;
  if (store != nullptr) {
    const auto [kept, size] = store->take(whole);
    if (kept != nullptr) return Buffer<T>(static_cast<T*>(kept), FreeMemory{store, size});
  }
  void* memory = std::aligned_alloc(system::kLargePageBytes, whole);
  if (memory == nullptr) throw std::bad_alloc();
  system::advise_large_pages(memory, whole);
  return Buffer<T>(static_cast<T*>(memory), FreeMemory{store, whole});
}

}  // namespace sparsha::pipeline
