// A fixed set of worker threads for loops whose result does not depend on how they are cut.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace sparsha {

class ThreadPool {
 public:
  /// `threads` counts the caller: 1 runs everything in place; 0 means one per core. Where the system gives fewer, the
  /// pool has those.
  explicit ThreadPool(unsigned threads = 0);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  [[nodiscard]] unsigned threads() const noexcept;

  /// Calls body(begin, end) on disjoint pieces of [0, count), each at most `grain` long, and returns when all are done.
  /// Pieces always start at multiples of `grain`, whatever the number of threads. The first exception is rethrown.
  /// Not to be called from within a body.
  void for_ranges(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha
