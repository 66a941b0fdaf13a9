// A bounded lock-free queue for one producer and one consumer (Lamport 1983 with cached indices).
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <type_traits>

#include "haptics/state/state.h"

namespace sparsha::haptics {

/// Capacity is rounded up to a power of two. push() and pop() neither allocate nor wait.
template <typename Value>
class SpscQueue {
  static_assert(std::is_nothrow_move_assignable_v<Value> && std::is_default_constructible_v<Value>);

 public:
  explicit SpscQueue(std::size_t capacity) {
    std::size_t size = 2;
    while (size < capacity) size *= 2;
    mask_ = size - 1;
    slots_ = std::make_unique<Value[]>(size);
  }

  /// Producer only; false when full, the value is then unchanged.
  bool push(Value&& value) noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail - head_seen_ > mask_) {
      head_seen_ = head_.load(std::memory_order_acquire);
      if (tail - head_seen_ > mask_) return false;
    }
    slots_[tail & mask_] = static_cast<Value&&>(value);
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }
  bool push(const Value& value) noexcept requires std::is_trivially_copyable_v<Value> {
    Value copy = value;
    return push(static_cast<Value&&>(copy));
  }

  /// Consumer only; false when empty.
  bool pop(Value& value) noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_seen_) {
      tail_seen_ = tail_.load(std::memory_order_acquire);
      if (head == tail_seen_) return false;
    }
    value = static_cast<Value&&>(slots_[head & mask_]);
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  [[nodiscard]] std::size_t capacity() const noexcept { return mask_ + 1; }

 private:
  std::unique_ptr<Value[]> slots_;
  std::size_t mask_ = 0;
  alignas(64) std::atomic<std::size_t> tail_{0};
  std::size_t head_seen_ = 0;
  alignas(64) std::atomic<std::size_t> head_{0};
  std::size_t tail_seen_ = 0;
};

using ContactQueue = SpscQueue<ContactEvent>;

}  // namespace sparsha::haptics
