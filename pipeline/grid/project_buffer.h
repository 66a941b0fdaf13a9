// Large arrays that are written before they are read: not cleared, and on large pages where the system has them.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

#include "pipeline/base/system.h"

namespace sparsha::pipeline {

struct FreeMemory {
  void operator()(void* memory) const noexcept { std::free(memory); }
};

template <typename T>
using Buffer = std::unique_ptr<T[], FreeMemory>;

/// Throws std::bad_alloc.
template <typename T>
[[nodiscard]] Buffer<T> make_buffer(std::size_t count) {
  static_assert(std::is_trivially_copyable_v<T>);
  constexpr std::size_t kLargePage = 2U << 20U;
  const std::size_t bytes = count * sizeof(T);
  if (bytes < 2 * kLargePage) {
    void* memory = std::malloc(bytes > 0 ? bytes : 1);
    if (memory == nullptr) throw std::bad_alloc();
    return Buffer<T>(static_cast<T*>(memory));
  }
  const std::size_t whole = (bytes + kLargePage - 1) / kLargePage * kLargePage;
  void* memory = std::aligned_alloc(kLargePage, whole);
  if (memory == nullptr) throw std::bad_alloc();
  system::advise_large_pages(memory, whole);
  return Buffer<T>(static_cast<T*>(memory));
}

}  // namespace sparsha::pipeline
