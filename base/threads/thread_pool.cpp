// Workers wait for a job, take its pieces by an atomic counter and report the first exception.
#include "base/threads/thread_pool.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "base/system/disk_arrays.h"

namespace sparsha {

struct ThreadPool::Implementation {
  std::mutex mutex;
  std::condition_variable start;
  std::condition_variable done;
  std::vector<std::thread> workers;
  unsigned long job = 0;
  unsigned busy = 0;
  bool stopping = false;

  const std::function<void(std::size_t, std::size_t)>* body = nullptr;
  std::size_t count = 0;
  std::size_t grain = 1;
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  std::exception_ptr error;

  void take_pieces() {
    while (!failed.load(std::memory_order_relaxed)) {
      const std::size_t begin = next.fetch_add(grain, std::memory_order_relaxed);
      if (begin >= count) return;
      try {
        (*body)(begin, std::min(count, begin + grain));
        system::keep_to_memory();
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!error) error = std::current_exception();
        failed.store(true, std::memory_order_relaxed);
      }
    }
  }

  void work() {
    unsigned long seen = 0;
    std::unique_lock lock(mutex);
    for (;;) {
      start.wait(lock, [&] { return stopping || job != seen; });
      if (stopping) return;
      seen = job;
      lock.unlock();
      take_pieces();
      lock.lock();
      if (--busy == 0) done.notify_one();
    }
  }
};

ThreadPool::ThreadPool(unsigned threads) : implementation_(std::make_unique<Implementation>()) {
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  try {
    for (unsigned i = 1; i < threads; ++i) implementation_->workers.emplace_back([this] { implementation_->work(); });
  } catch (const std::system_error&) {
    // The system has no more threads to give: results do not depend on their number.
  }
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard lock(implementation_->mutex);
    implementation_->stopping = true;
  }
  implementation_->start.notify_all();
  for (std::thread& worker : implementation_->workers) worker.join();
}

unsigned ThreadPool::threads() const noexcept { return static_cast<unsigned>(implementation_->workers.size()) + 1; }

void ThreadPool::for_ranges(std::size_t count, std::size_t grain,
                            const std::function<void(std::size_t, std::size_t)>& body) {
  Implementation& pool = *implementation_;
  grain = std::max<std::size_t>(1, grain);
  if (pool.workers.empty() || count <= grain) {
    for (std::size_t begin = 0; begin < count; begin += grain) {
      body(begin, std::min(count, begin + grain));
      system::keep_to_memory();
    }
    return;
  }
  {
    const std::lock_guard lock(pool.mutex);
    pool.body = &body;
    pool.count = count;
    pool.grain = grain;
    pool.next.store(0, std::memory_order_relaxed);
    pool.failed.store(false, std::memory_order_relaxed);
    pool.error = nullptr;
    pool.busy = static_cast<unsigned>(pool.workers.size());
    ++pool.job;
  }
  pool.start.notify_all();
  pool.take_pieces();
  std::unique_lock lock(pool.mutex);
  pool.done.wait(lock, [&] { return pool.busy == 0; });
  if (pool.error) std::rethrow_exception(pool.error);
}

}  // namespace sparsha
