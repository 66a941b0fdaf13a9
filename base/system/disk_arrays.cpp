// Arrays are shared mappings of unlinked files: dropping their pages loses nothing, since the system keeps what was
// written and brings it back when it is touched. A thread watches the resident set, and so does every worker, since
// the thread waits for a core where there are many; where it waits long, pages are dropped earlier.
#include "base/system/disk_arrays.h"

#include "base/error.h"

#if defined(__linux__)
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <new>
#include <string>
#include <thread>
#include <vector>
#endif

namespace sparsha::system {

#if defined(__linux__)

namespace {

struct Array {
  void* data;
  std::size_t bytes;
};

// Memory of malloc() and free(): the program's operator delete asks give_disk_array(), which takes the lock under which
// the list grows.
template <class T>
struct Malloc {
  using value_type = T;
  Malloc() = default;
  template <class U>
  explicit Malloc(const Malloc<U>& /*other*/) noexcept {}
  [[nodiscard]] T* allocate(std::size_t n) {
    if (void* const block = std::malloc(n * sizeof(T))) return static_cast<T*>(block);
    throw std::bad_alloc();
  }
  void deallocate(T* block, std::size_t /*n*/) noexcept { std::free(block); }
  friend bool operator==(const Malloc& /*a*/, const Malloc& /*b*/) noexcept { return true; }
};

// Arrays of this process, of a DiskArrays that is in force or has gone. Under its lock nothing is freed by operator
// delete.
struct Arrays {
  std::mutex mutex;
  std::vector<Array, Malloc<Array>> all;
  std::string folder;  ///< set while none is in force
  int error = 0;       ///< errno of the first array that got no room
};
Arrays& arrays() {
  static auto* const kArrays = new Arrays;  // never destroyed: statics may be freed later
  return *kArrays;
}
std::atomic<bool> allowed{false};
std::atomic<bool> in_force{false};
std::atomic<std::size_t> count{0};

std::size_t page_bytes() noexcept {
  static const auto kBytes = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  return kBytes;
}

// A file of that size, with room on the disk for all of it, without a name; or -1 and errno.
int open_file(const std::string& folder, std::size_t bytes) {
  std::string name = folder + "/.sparsha-XXXXXX";
  const int file = ::mkostemp(name.data(), O_CLOEXEC);
  if (file < 0) return -1;
  ::unlink(name.c_str());
  // A page without room on the disk would end the program when it is written to.
  int error = EINTR;  // a signal is no lack of room
  while (error == EINTR) error = ::posix_fallocate(file, 0, static_cast<off_t>(bytes));
  if (error == 0) return file;
  ::close(file);
  errno = error;
  return -1;
}

void* map_new_file(const std::string& folder, std::size_t bytes) {
  const int file = open_file(folder, bytes);
  if (file < 0) return nullptr;
  void* const data = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  const int error = errno;
  ::close(file);
  errno = error;
  return data == MAP_FAILED ? nullptr : data;
}

struct Resident {
  std::uint64_t all = 0;
  std::uint64_t of_files = 0;
};

class Statm {
 public:
  Statm() : file_(::open("/proc/self/statm", O_RDONLY | O_CLOEXEC)) {}
  ~Statm() { ::close(file_); }
  Statm(const Statm&) = delete;
  Statm& operator=(const Statm&) = delete;

  [[nodiscard]] Resident now() const {
    std::array<char, 200> text{};
    unsigned long long size = 0, all = 0, of_files = 0;
    if (::pread(file_, text.data(), text.size() - 1, 0) <= 0 ||
        std::sscanf(text.data(), "%llu %llu %llu", &size, &all, &of_files) != 3)
      return {};
    return {all * page_bytes(), of_files * page_bytes()};
  }

 private:
  int file_;
};

void drop_pages() {
  const std::lock_guard lock(arrays().mutex);
  for (const Array& array : arrays().all) ::madvise(array.data, array.bytes, MADV_DONTNEED);
}

// Drops all pages when there are too many. Any thread may look.
class PageWatch {
 public:
  void begin(std::uint64_t limit_bytes) {
    const std::lock_guard lock(mutex_);
    limit_bytes_ = limit_bytes;
    kept_bytes_ = 0;
    late_.store(0, std::memory_order_relaxed);
  }

  // How late the thread that looks is given a core. It forgets by a half in a tenth of a second.
  void woke_late(std::chrono::steady_clock::duration late) noexcept {
    constexpr std::chrono::steady_clock::rep kForgets = 128;
    const std::chrono::steady_clock::rep before = late_.load(std::memory_order_relaxed);
    late_.store(std::max(late.count(), before - before / kForgets), std::memory_order_relaxed);
  }

  // As soon as there are enough of them again to be worth it: at most a share of the room that the rest of the program
  // leaves of the limit, since as many come again between two looks.
  // `waits`: for somebody who looks already, and may have lost its core while it does.
  void look(bool waits) {
    constexpr std::uint64_t kWorthIt = std::uint64_t{16} << 20U, kLeastWorthIt = std::uint64_t{1} << 20U;
    std::unique_lock lock(mutex_, std::defer_lock);
    if (waits)
      lock.lock();
    else if (!lock.try_lock())
      return;  // somebody looks
    const Resident now = statm_.now();
    kept_bytes_ = std::min(kept_bytes_, now.of_files);
    const std::uint64_t others = now.all - std::min(now.all, now.of_files - kept_bytes_);
    const std::uint64_t room = (limit_bytes_ - std::min(limit_bytes_, others)) / 2;
    const std::uint64_t worth_it = std::clamp(room, kLeastWorthIt, kWorthIt);
    // What is written between two looks comes on top: more of it where cores are busy.
    constexpr std::chrono::milliseconds kLate(2);
    const bool busy = std::chrono::steady_clock::duration(late_.load(std::memory_order_relaxed)) > kLate;
    if (now.all > limit_bytes_ - limit_bytes_ / (busy ? 2 : 5) && now.of_files >= kept_bytes_ + worth_it) {
      drop_pages();
      kept_bytes_ = statm_.now().of_files;
    }
    looked_.store(std::chrono::steady_clock::now().time_since_epoch().count(), std::memory_order_relaxed);
  }

  [[nodiscard]] std::chrono::steady_clock::duration since_look() const noexcept {
    const std::chrono::steady_clock::duration looked(looked_.load(std::memory_order_relaxed));
    return std::chrono::steady_clock::now().time_since_epoch() - looked;
  }

 private:
  std::mutex mutex_;
  Statm statm_;
  std::uint64_t limit_bytes_ = 0;
  std::uint64_t kept_bytes_ = 0;  // resident bytes of files when pages were dropped last
  std::atomic<std::chrono::steady_clock::rep> looked_{0}, late_{0};
};
PageWatch& watch_of_pages() {
  static auto* const kWatch = new PageWatch;  // never destroyed: a worker may still look
  return *kWatch;
}

}  // namespace

void keep_to_memory() noexcept {
  constexpr std::chrono::microseconds kOften(500), kTooLong(2000);
  if (!in_force.load(std::memory_order_relaxed)) return;
  const auto since = watch_of_pages().since_look();
  if (since >= kOften) watch_of_pages().look(since >= kTooLong);
}

void allow_disk_arrays() noexcept { allowed.store(true); }
bool has_disk_arrays() noexcept { return allowed.load(); }

bool wants_disk_array(std::size_t bytes) noexcept {
  return bytes >= kLeastDiskArray && in_force.load(std::memory_order_relaxed);
}

void* take_disk_array(std::size_t bytes) noexcept try {
  const std::size_t whole = (bytes + page_bytes() - 1) / page_bytes() * page_bytes();
  Arrays& ours = arrays();
  void* const data = map_new_file(ours.folder, whole);
  const int error = errno;
  const std::lock_guard lock(ours.mutex);
  if (data == nullptr) {
    if (ours.error == 0) ours.error = error;
    return nullptr;
  }
  ours.all.push_back({data, whole});
  count.store(ours.all.size());
  return data;
} catch (const std::exception&) {
  return nullptr;
}

bool give_disk_array(void* array) noexcept {
  // Few blocks of the heap begin where a page does, so that the lock is seldom taken in vain.
  if (count.load(std::memory_order_relaxed) == 0 || reinterpret_cast<std::uintptr_t>(array) % page_bytes() != 0)
    return false;
  Arrays& ours = arrays();
  const std::lock_guard lock(ours.mutex);
  const auto found =
      std::find_if(ours.all.begin(), ours.all.end(), [&](const Array& known) { return known.data == array; });
  if (found == ours.all.end()) return false;
  ::munmap(found->data, found->bytes);
  ours.all.erase(found);
  count.store(ours.all.size());
  return true;
}

struct DiskArrays::Implementation {
  std::mutex mutex;
  std::condition_variable ending;
  bool ends = false;
  std::thread watcher;

  void watch() {
    constexpr std::chrono::milliseconds kPause(1);
    std::unique_lock lock(mutex);
    for (auto asleep = std::chrono::steady_clock::now(); !ending.wait_for(lock, kPause, [&] { return ends; });
         asleep = std::chrono::steady_clock::now()) {
      watch_of_pages().woke_late(std::chrono::steady_clock::now() - asleep - kPause);
      watch_of_pages().look(false);
    }
  }
};

DiskArrays::DiskArrays(const std::filesystem::path& folder, std::uint64_t resident_bytes)
    : implementation_(std::make_unique<Implementation>()) {
  {
    std::string wanted = folder.empty() ? "." : folder.string();  // the old one is freed after the lock
    const std::lock_guard lock(arrays().mutex);
    arrays().folder.swap(wanted);
    arrays().error = 0;
  }
  void* const trial = take_disk_array(page_bytes());
  throw_if_disk_was_full();
  (void)give_disk_array(trial);
  watch_of_pages().begin(resident_bytes);
  implementation_->watcher = std::thread([implementation = implementation_.get()] { implementation->watch(); });
  in_force.store(true);
}

DiskArrays::~DiskArrays() {
  in_force.store(false);
  {
    const std::lock_guard lock(implementation_->mutex);
    implementation_->ends = true;
  }
  implementation_->ending.notify_all();
  implementation_->watcher.join();
}

void throw_if_disk_was_full() {
  int error = 0;
  std::string folder;
  {
    const std::lock_guard lock(arrays().mutex);
    error = arrays().error;
    folder = arrays().folder;
  }
  if (error == 0) return;
  throw Error(ErrorKind::failure, {folder, 0, 0},
              std::string("a temporary file in this folder fails: ") + std::strerror(error),
              "room on the disk and a folder that can be written to");
}

#else

void keep_to_memory() noexcept {}
void allow_disk_arrays() noexcept {}
bool has_disk_arrays() noexcept { return false; }
bool wants_disk_array(std::size_t) noexcept { return false; }
void* take_disk_array(std::size_t) noexcept { return nullptr; }
bool give_disk_array(void*) noexcept { return false; }

struct DiskArrays::Implementation {};
DiskArrays::DiskArrays(const std::filesystem::path& folder, std::uint64_t) {
  throw Error(ErrorKind::failure, {folder.string(), 0, 0}, "this system keeps no arrays in files", "Linux");
}
DiskArrays::~DiskArrays() = default;
void throw_if_disk_was_full() {}

#endif

}  // namespace sparsha::system
