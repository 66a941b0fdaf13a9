// Memory, processes and terminals of the operating system.
#include <algorithm>
#include <atomic>
#include <fstream>
#include <string>

#include "base/system.h"

#if defined(_WIN32)
#define NOMINMAX
#include <windows.h>
// clang-format off
#include <psapi.h>
#include <io.h>
// clang-format on
#else
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#endif
#if defined(__linux__)
#include <malloc.h>
#endif

namespace sparsha::system {

#if defined(_WIN32)

std::uint64_t peak_rss_bytes() noexcept {
  PROCESS_MEMORY_COUNTERS counters{};
  GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof(counters));
  return counters.PeakWorkingSetSize;
}

std::uint64_t physical_memory_bytes() noexcept {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof(status);
  return GlobalMemoryStatusEx(&status) != 0 ? status.ullTotalPhys : 0;
}

bool process_exists(std::uint64_t number) noexcept {
  const HANDLE handle = OpenProcess(PROCESS_QUERY_LIMITED_INFORMATION, FALSE, static_cast<DWORD>(number));
  if (handle != nullptr) CloseHandle(handle);
  return handle != nullptr;
}
unsigned process_id() noexcept { return GetCurrentProcessId(); }
bool stderr_is_terminal() noexcept { return _isatty(2) != 0; }
void trim_heap() noexcept {}
void keep_heap() noexcept {}
ThriftyHeap::ThriftyHeap() noexcept = default;
ThriftyHeap::~ThriftyHeap() = default;
void advise_large_pages(void*, std::size_t) noexcept {}

#else

std::uint64_t peak_rss_bytes() noexcept {
  struct rusage usage {};
  ::getrusage(RUSAGE_SELF, &usage);
#if defined(__APPLE__)
  return static_cast<std::uint64_t>(usage.ru_maxrss);
#else
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024U;
#endif
}

namespace {

// The least limit of memory that control groups put on this process; the largest number without one.
std::uint64_t group_limit_bytes() {
  std::uint64_t least = ~std::uint64_t{0};
  const auto look = [&](const std::filesystem::path& file) {
    std::uint64_t bytes = 0;
    if (std::ifstream(file) >> bytes && bytes > 0) least = std::min(least, bytes);
  };
  look("/sys/fs/cgroup/memory.max");
  look("/sys/fs/cgroup/memory/memory.limit_in_bytes");
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    if (!line.starts_with("0::/")) continue;
    for (std::filesystem::path group = line.substr(4); !group.empty(); group = group.parent_path()) {
      look(std::filesystem::path("/sys/fs/cgroup") / group / "memory.max");
    }
  }
  return least;
}

}  // namespace

std::uint64_t physical_memory_bytes() noexcept try {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  const long page = ::sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page <= 0) return 0;
  std::uint64_t bytes = static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page);
  struct rlimit limit {};
  if (::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
    bytes = std::min<std::uint64_t>(bytes, limit.rlim_cur);
  }
  return std::min(bytes, group_limit_bytes());
} catch (...) {
  return 0;
}

namespace {

std::atomic<int> thrifty_heaps{0};
std::atomic<bool> heap_is_kept{false};

// Blocks of at least so many bytes are the system's, and as many may be free at the heap's end, which grows by so many.
void set_heap([[maybe_unused]] int own_bytes, [[maybe_unused]] int free_bytes, [[maybe_unused]] int growth) noexcept {
#if defined(__linux__)
  ::mallopt(M_MMAP_THRESHOLD, own_bytes);
  ::mallopt(M_TRIM_THRESHOLD, free_bytes);
  ::mallopt(M_TOP_PAD, growth);
#endif
}

void set_kept_heap() noexcept { set_heap(32 << 20, 64 << 20, 16 << 20); }

}  // namespace

void keep_heap() noexcept {
  heap_is_kept = true;
  set_kept_heap();
}

ThriftyHeap::ThriftyHeap() noexcept {
  if (thrifty_heaps.fetch_add(1) > 0) return;
  set_heap(256 << 10, 256 << 10, 128 << 10);
  trim_heap();
}

ThriftyHeap::~ThriftyHeap() {
  if (thrifty_heaps.fetch_sub(1) == 1 && heap_is_kept) set_kept_heap();
}

void advise_large_pages(void* data, std::size_t size) noexcept {
#if defined(MADV_HUGEPAGE)
  if (size < 2 * kLargePageBytes || thrifty_heaps.load(std::memory_order_relaxed) > 0) return;
  const std::size_t past = reinterpret_cast<std::uintptr_t>(data) % kLargePageBytes;
  const std::size_t before = past > 0 ? kLargePageBytes - past : 0;
  const std::size_t whole = (size - before) / kLargePageBytes * kLargePageBytes;
  ::madvise(static_cast<char*>(data) + before, whole, MADV_HUGEPAGE);
#else
  static_cast<void>(data);
  static_cast<void>(size);
#endif
}

bool process_exists(std::uint64_t number) noexcept {
  return ::kill(static_cast<pid_t>(number), 0) == 0 || errno == EPERM;
}

unsigned process_id() noexcept { return static_cast<unsigned>(::getpid()); }
bool stderr_is_terminal() noexcept { return ::isatty(STDERR_FILENO) == 1; }

void trim_heap() noexcept {
#if defined(__linux__)
  ::malloc_trim(0);
#endif
}

#endif

}  // namespace sparsha::system
