// A process of its own for work that may crash or hang, and memory that it shares with this one.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace sparsha::system {

/// Waits until `word` is not `old` any more, `timeout_s` at most; from any process that shares the word. No allocation.
void wait_for_change(const std::atomic<std::uint32_t>& word, std::uint32_t old, double timeout_s) noexcept;
/// Wakes whoever waits for a change of the word.
void wake_waiting(const std::atomic<std::uint32_t>& word) noexcept;

/// Steady time that all processes share, nanoseconds.
[[nodiscard]] std::int64_t shared_time_ns() noexcept;
/// Sleeps until that.
void sleep_until_shared_ns(std::int64_t time_ns) noexcept;

/// What became of a worker.
enum class WorkerEnd : std::uint32_t { none, returned, crashed, hung, unknown };

/// At the head of the shared memory.
struct WorkerHead {
  std::atomic<std::uint32_t> end{0};             ///< WorkerEnd, written by whoever supervises, or is left without
  std::atomic<std::uint32_t> signal{0};          ///< that ended it
  std::atomic<std::uint32_t> stop{0};            ///< the worker is asked to return
  std::atomic<std::uint32_t> hangs_after_ms{0};  ///< without a beat the worker is killed; 0: it may take its time
  std::atomic<std::uint64_t> beats{0};           ///< signs of life of the worker
  std::atomic<std::uint32_t> rescue{0};          ///< not 0: after a crash or a hang there is something to be put right
};

/// Two processes: one does the work, the other supervises it, and outlives this program for as long as it takes to put
/// right what is left. Start it before other threads exist: both are copies of this process with the calling thread.
class Worker {
 public:
  /// In the worker's process, which ends by itself, as after `stop`, when its supervisor is killed. `shared` begins
  /// with a WorkerHead.
  using Work = std::function<void(void* shared)>;

  /// `bytes`: of the shared memory, zero at first. `work` returns soon after `stop`, which is set when this program has
  /// ended, too. `rescue` is called, in a process of its own and for `rescue_s` at most, where the worker did not
  /// return and the head says so. In both, standard output goes to standard error, so that the program's output is its
  /// own; other files are closed. `priority` > 0 asks for SCHED_FIFO. Throws Error{failure} when the system gives no
  /// process.
  Worker(std::size_t bytes, const Work& work, const Work& rescue, double rescue_s, int priority);
  /// Asks the worker to return, and waits until it has, or was killed, and what was left is put right.
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  [[nodiscard]] void* shared() const noexcept { return memory_; }
  [[nodiscard]] WorkerHead& head() const noexcept { return *static_cast<WorkerHead*>(memory_); }
  [[nodiscard]] WorkerEnd end() const noexcept { return static_cast<WorkerEnd>(head().end.load()); }
  /// The process that does the work, for tests that kill it.
  [[nodiscard]] long supervisor() const noexcept { return process_; }

 private:
  void* memory_ = nullptr;
  std::size_t bytes_ = 0;
  int pipe_ = -1;
  long process_ = 0;
};

/// Words from one process to another. Written by one thread, read by one; a writer that is killed in the middle leaves
/// the mail of before. Orders stand in the words' own stores and loads, as in Seqlock: thread sanitizers know no
/// fences.
template <std::size_t N>
class SharedMail {
 public:
  void put(const std::array<std::uint64_t, N>& words) noexcept {
    const std::uint32_t next = count_.load(std::memory_order_relaxed) + 1;
    // No word of this mail before the count of the last one: who sees one also sees that.
    for (std::size_t i = 0; i < N; ++i) slots_[next & 1U][i].store(words[i], std::memory_order_release);
    count_.store(next, std::memory_order_release);
    wake_waiting(count_);
  }
  /// The newest; false when it changes faster than it can be read, or there is none.
  [[nodiscard]] bool get(std::array<std::uint64_t, N>& words, std::uint32_t& number) const noexcept {
    constexpr int kTries = 8;
    for (int attempt = 0; attempt < kTries; ++attempt) {
      number = count_.load(std::memory_order_acquire);
      if (number == 0) return false;
      for (std::size_t i = 0; i < N; ++i) words[i] = slots_[number & 1U][i].load(std::memory_order_acquire);
      if (count_.load(std::memory_order_relaxed) == number) return true;
    }
    return false;
  }
  [[nodiscard]] const std::atomic<std::uint32_t>& count() const noexcept { return count_; }

 private:
  std::atomic<std::uint32_t> count_{0};
  std::atomic<std::uint64_t> slots_[2][N];
};

}  // namespace sparsha::system
