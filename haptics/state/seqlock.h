// A value of 64-bit words that one thread publishes and any thread reads without locks.
// Words are atomics between two readings of a sequence number (Boehm 2012, "Can seqlocks get along with programming
// language memory models?"). Release stores and acquire loads of the words stand where fences would: they cost nothing
// on x86, and thread sanitizers understand them.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace sparsha::haptics {

template <typename Value>
class Seqlock {
  static_assert(std::is_trivially_copyable_v<Value> && sizeof(Value) % 8 == 0);
  static constexpr std::size_t kWords = sizeof(Value) / 8;

 public:
  Seqlock() { publish(Value{}); }

  /// Wait-free; one writer only.
  void publish(const Value& value) noexcept {
    std::array<std::uint64_t, kWords> words;
    std::memcpy(words.data(), &value, sizeof(Value));
    const std::uint64_t sequence = sequence_.load(std::memory_order_relaxed);
    sequence_.store(sequence + 1, std::memory_order_relaxed);
    // A reader that sees one of these words sees the odd sequence number too.
    for (std::size_t i = 0; i < kWords; ++i) words_[i].store(words[i], std::memory_order_release);
    sequence_.store(sequence + 2, std::memory_order_release);
  }

  /// A consistent copy; retries while the writer is at work.
  [[nodiscard]] Value read() const noexcept {
    Value value;
    while (!try_read(value)) {
    }
    return value;
  }

  /// Like read(), but gives up after one try; for readers that must not wait (the pointer device on the servo thread).
  [[nodiscard]] bool try_read(Value& value) const noexcept {
    std::array<std::uint64_t, kWords> words;
    const std::uint64_t before = sequence_.load(std::memory_order_acquire);
    for (std::size_t i = 0; i < kWords; ++i) words[i] = words_[i].load(std::memory_order_acquire);
    if ((before & 1U) != 0 || sequence_.load(std::memory_order_relaxed) != before) return false;
    std::memcpy(static_cast<void*>(&value), words.data(), sizeof(Value));
    return true;
  }

 private:
  alignas(64) std::atomic<std::uint64_t> sequence_{0};
  std::array<std::atomic<std::uint64_t>, kWords> words_{};
};

}  // namespace sparsha::haptics
