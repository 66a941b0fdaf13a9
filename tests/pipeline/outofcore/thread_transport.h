// Ranks as threads of one process, which pass each other bytes through memory.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <vector>

#include "pipeline/cluster/transport.h"

namespace sparsha::test {

/// Where the ranks meet.
class MeetingPlace {
 public:
  explicit MeetingPlace(int size) : sends_(static_cast<std::size_t>(size)) {}

  struct Send {
    const std::byte* bytes;
    const int* counts;
    const int* places;
  };
  [[nodiscard]] std::size_t size() const { return sends_.size(); }
  [[nodiscard]] const Send& of(std::size_t rank) const { return sends_[rank]; }
  void offer(std::size_t rank, const Send& send) { sends_[rank] = send; }

  /// Waits for all ranks; false when `stopped` becomes true before.
  bool wait(bool (*stopped)(const void*), const void* what) {
    std::unique_lock lock(mutex_);
    const std::size_t turn = turn_;
    if (++here_ == sends_.size()) {
      here_ = 0;
      ++turn_;
      all_here_.notify_all();
      return true;
    }
    while (turn == turn_) {
      if (stopped(what)) return false;
      all_here_.wait_for(lock, std::chrono::milliseconds(2));
    }
    return true;
  }

 private:
  std::vector<Send> sends_;
  std::mutex mutex_;
  std::condition_variable all_here_;
  std::size_t here_ = 0;
  std::size_t turn_ = 0;
};

class ThreadTransport final : public pipeline::Transport {
 public:
  ThreadTransport(MeetingPlace& place, std::size_t rank) : place_(place), rank_(rank) {}

  [[nodiscard]] int rank() const noexcept override { return static_cast<int>(rank_); }
  [[nodiscard]] int size() const noexcept override { return static_cast<int>(place_.size()); }
  [[nodiscard]] const char* host() const noexcept override { return "here"; }

  [[nodiscard]] bool exchange(const std::byte* send, const int* send_counts, const int* send_places, std::byte* receive,
                              const int* receive_counts, const int* receive_places, bool (*stopped)(const void*),
                              const void* what) noexcept override {
    place_.offer(rank_, {send, send_counts, send_places});
    if (!place_.wait(stopped, what)) return false;
    bool fits = true;
    for (std::size_t r = 0; r < place_.size(); ++r) {
      const MeetingPlace::Send& from = place_.of(r);
      fits = fits && from.counts[rank_] == receive_counts[r];
      if (fits && receive_counts[r] > 0) {
        std::memcpy(receive + receive_places[r], from.bytes + from.places[rank_],
                    static_cast<std::size_t>(receive_counts[r]));
      }
      largest_ = largest_ < receive_counts[r] ? receive_counts[r] : largest_;
    }
    return place_.wait(stopped, what) && fits;
  }
  void finish() noexcept override {}
  [[noreturn]] void abort(int code) noexcept override { std::_Exit(code); }

  /// Bytes of the largest message so far.
  [[nodiscard]] int largest() const { return largest_; }

 private:
  MeetingPlace& place_;
  std::size_t rank_;
  int largest_ = 0;
};

}  // namespace sparsha::test
