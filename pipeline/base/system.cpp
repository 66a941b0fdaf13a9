// POSIX and Windows calls; nothing of the pipeline but this and system_child.cpp includes system headers.
#include "pipeline/base/system.h"

#include <algorithm>
#include <atomic>
#include <fstream>
#include <mutex>
#include <string>
#include <string_view>

#include "pipeline/base/error.h"

#if defined(_WIN32)
#define NOMINMAX
#include <windows.h>
// clang-format off
#include <psapi.h>
#include <io.h>
// clang-format on
#else
#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#endif
#if defined(__linux__)
#include <linux/fs.h>
#include <malloc.h>
#include <stdio.h>
#endif

namespace sparsha::system {
namespace {

[[noreturn]] void fail(const std::filesystem::path& folder, const std::string& why) {
  throw Error(ErrorKind::failure, {folder.string(), 0, 0}, "a temporary file in this folder fails: " + why,
              "room on the disk and a folder that can be written to");
}

[[noreturn]] void fail_to_append(const std::filesystem::path& file, const std::string& why) {
  throw Error(ErrorKind::failure, {file.string(), 0, 0}, "cannot append to it: " + why,
              "room on the disk and a file that can be written");
}

[[noreturn]] void fail_to_create(const std::filesystem::path& path, const std::string& why) {
  throw Error(ErrorKind::failure, {path.string(), 0, 0}, "cannot be created: " + why,
              "a folder that can be written to");
}

/// Moves all bytes by calls of transfer(piece, offset), which gives how many it moved, with pieces of 1 GB at most.
template <typename Bytes, typename Transfer>
void in_pieces(std::uint64_t offset, Bytes bytes, const Transfer& transfer) {
  constexpr std::size_t kMost = std::size_t{1} << 30U;
  while (!bytes.empty()) {
    const std::size_t done = transfer(bytes.first(std::min(bytes.size(), kMost)), offset);
    bytes = bytes.subspan(done);
    offset += done;
  }
}

}  // namespace

#if defined(_WIN32)

Mapping map_file(const std::filesystem::path& file) {
  const HANDLE handle =
      CreateFileW(file.c_str(), GENERIC_READ, FILE_SHARE_READ, nullptr, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, nullptr);
  if (handle == INVALID_HANDLE_VALUE) throw input_error(file.string(), "cannot open the file", "a readable file");
  LARGE_INTEGER size{};
  GetFileSizeEx(handle, &size);
  Mapping mapping;
  if (size.QuadPart > 0) {
    const HANDLE section = CreateFileMappingW(handle, nullptr, PAGE_READONLY, 0, 0, nullptr);
    if (section != nullptr) {
      mapping.data = static_cast<const std::byte*>(MapViewOfFile(section, FILE_MAP_READ, 0, 0, 0));
      CloseHandle(section);
    }
    mapping.size = static_cast<std::size_t>(size.QuadPart);
  }
  CloseHandle(handle);
  if (size.QuadPart > 0 && mapping.data == nullptr) throw input_error(file.string(), "cannot map the file");
  return mapping;
}

void unmap_file(const Mapping& mapping) noexcept {
  if (mapping.data != nullptr) UnmapViewOfFile(mapping.data);
}

void release_pages(const Mapping&, std::size_t, std::size_t) noexcept {}
bool is_whole(const Mapping&) noexcept { return true; }  // a mapped file cannot become shorter
void survive_cut_files() noexcept {}

std::intptr_t create_exclusively(const std::filesystem::path& path, bool folder) {
  if (folder) {
    if (CreateDirectoryW(path.c_str(), nullptr)) return 0;
  } else {
    const HANDLE handle = CreateFileW(path.c_str(), GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_WRITE, nullptr,
                                      CREATE_NEW, FILE_ATTRIBUTE_NORMAL, nullptr);
    if (handle != INVALID_HANDLE_VALUE) {
      CloseHandle(handle);
      return 0;
    }
  }
  const DWORD code = GetLastError();
  if (code == ERROR_ALREADY_EXISTS || code == ERROR_FILE_EXISTS) return -1;
  fail_to_create(path, "code " + std::to_string(code));
}

void release(std::intptr_t) noexcept {}
void remove_abandoned(const std::filesystem::path&) noexcept {}
bool is_writable(const std::filesystem::path& path) noexcept { return _waccess(path.c_str(), 2) == 0; }
void allow_many_open_files() noexcept {}
bool process_exists(std::uint64_t number) noexcept {
  const HANDLE handle = OpenProcess(PROCESS_QUERY_LIMITED_INFORMATION, FALSE, static_cast<DWORD>(number));
  if (handle != nullptr) CloseHandle(handle);
  return handle != nullptr;
}

ScratchFile::ScratchFile(const std::filesystem::path& folder) : folder_(folder) {
  wchar_t name[MAX_PATH];
  if (GetTempFileNameW(folder.c_str(), L"spa", 0, name) == 0) fail(folder_, "no name for it");
  const HANDLE handle = CreateFileW(name, GENERIC_READ | GENERIC_WRITE, 0, nullptr, CREATE_ALWAYS,
                                    FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, nullptr);
  if (handle == INVALID_HANDLE_VALUE) fail(folder_, "it cannot be opened");
  handle_ = reinterpret_cast<std::intptr_t>(handle);
}

ScratchFile::~ScratchFile() { CloseHandle(reinterpret_cast<HANDLE>(handle_)); }

namespace {

OVERLAPPED overlapped_at(std::uint64_t offset) {
  OVERLAPPED place{};
  place.Offset = static_cast<DWORD>(offset);
  place.OffsetHigh = static_cast<DWORD>(offset >> 32U);
  return place;
}

}  // namespace

void ScratchFile::write(std::uint64_t offset, std::span<const std::byte> bytes) {
  in_pieces(offset, bytes, [this](std::span<const std::byte> piece, std::uint64_t at) -> std::size_t {
    OVERLAPPED place = overlapped_at(at);
    DWORD done = 0;
    const auto size = static_cast<DWORD>(piece.size());
    if (!WriteFile(reinterpret_cast<HANDLE>(handle_), piece.data(), size, &done, &place) || done == 0) {
      fail(folder_, "writing, code " + std::to_string(GetLastError()));
    }
    return done;
  });
}

void ScratchFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  in_pieces(offset, bytes, [this](std::span<std::byte> piece, std::uint64_t at) -> std::size_t {
    OVERLAPPED place = overlapped_at(at);
    DWORD done = 0;
    const auto size = static_cast<DWORD>(piece.size());
    if (!ReadFile(reinterpret_cast<HANDLE>(handle_), piece.data(), size, &done, &place) || done == 0) {
      fail(folder_, "reading, code " + std::to_string(GetLastError()));
    }
    return done;
  });
}

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

bool exchange_paths(const std::filesystem::path&, const std::filesystem::path&) noexcept { return false; }
void append_line(const std::filesystem::path& file, std::string_view first, std::string_view line) {
  HANDLE handle = INVALID_HANDLE_VALUE;  // opened for nobody else: that is the lock
  do {
    handle = CreateFileW(file.c_str(), GENERIC_READ | GENERIC_WRITE, 0, nullptr, OPEN_ALWAYS, FILE_ATTRIBUTE_NORMAL,
                         nullptr);
    if (handle == INVALID_HANDLE_VALUE && GetLastError() == ERROR_SHARING_VIOLATION) Sleep(1);
  } while (handle == INVALID_HANDLE_VALUE && GetLastError() == ERROR_SHARING_VIOLATION);
  if (handle == INVALID_HANDLE_VALUE) fail_to_append(file, "code " + std::to_string(GetLastError()));
  LARGE_INTEGER size{};
  GetFileSizeEx(handle, &size);
  std::string text;
  DWORD done = 0;
  if (size.QuadPart == 0) {
    text = first;
  } else {
    char last = 0;
    SetFilePointerEx(handle, {.QuadPart = size.QuadPart - 1}, nullptr, FILE_BEGIN);
    if (ReadFile(handle, &last, 1, &done, nullptr) && last != '\n') text = "\n";
  }
  text += line;
  SetFilePointerEx(handle, size, nullptr, FILE_BEGIN);
  const bool whole = WriteFile(handle, text.data(), static_cast<DWORD>(text.size()), &done, nullptr) &&
                     done == static_cast<DWORD>(text.size());
  if (!whole) {
    SetFilePointerEx(handle, size, nullptr, FILE_BEGIN);
    SetEndOfFile(handle);
  }
  CloseHandle(handle);
  if (!whole) fail_to_append(file, "the disk may be full");
}

unsigned process_id() noexcept { return GetCurrentProcessId(); }
bool stderr_is_terminal() noexcept { return _isatty(2) != 0; }
void trim_heap() noexcept {}
void advise_large_pages(void*, std::size_t) noexcept {}

#else

/// A mapped file as the handler of SIGBUS knows it. Kept in a list that only grows, for a handler may take no lock;
/// used again for later files.
struct MappedRange {
  std::atomic<std::uintptr_t> begin{0};  ///< 0: free
  std::atomic<std::size_t> size{0};
  std::atomic<bool> cut{false};
  int descriptor = -1;
  MappedRange* next = nullptr;
};

namespace {

std::atomic<MappedRange*> mapped_ranges{nullptr};
std::mutex mapped_ranges_mutex;

MappedRange* keep_range(const void* data, std::size_t size, int descriptor) {
  const std::lock_guard lock(mapped_ranges_mutex);
  MappedRange* range = mapped_ranges.load();
  while (range != nullptr && range->begin.load() != 0) range = range->next;
  if (range == nullptr) {
    range = new MappedRange;
    range->next = mapped_ranges.load();
    mapped_ranges.store(range);
  }
  range->descriptor = descriptor;
  range->cut.store(false);
  range->size.store(size);
  range->begin.store(reinterpret_cast<std::uintptr_t>(data));
  return range;
}

// Puts zeros in place of what is gone, and remembers it; any other SIGBUS ends the program as it always did.
void on_bus_error(int, siginfo_t* info, void*) {
  const int before = errno;
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  for (MappedRange* range = mapped_ranges.load(); range != nullptr; range = range->next) {
    const std::uintptr_t begin = range->begin.load();
    const std::size_t size = range->size.load();
    if (begin == 0 || address < begin || address - begin >= size) continue;
    const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
    const std::uintptr_t first = address / page * page;
    void* const page_start = static_cast<char*>(info->si_addr) - (address - first);
    void* const zeros =
        ::mmap(page_start, begin + size - first, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0);
    if (zeros == MAP_FAILED) break;
    range->cut.store(true);
    errno = before;
    return;
  }
  std::signal(SIGBUS, SIG_DFL);
}

}  // namespace

Mapping map_file(const std::filesystem::path& file) {
  // O_NONBLOCK: a named pipe must be refused, not waited for.
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    throw input_error(file.string(), "cannot open the file: " + std::string(std::strerror(errno)), "a readable file");
  }
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(descriptor);
    throw input_error(file.string(), "this is not a regular file", "a readable file");
  }
  Mapping mapping;
  mapping.size = static_cast<std::size_t>(status.st_size);
  if (mapping.size == 0) {
    ::close(descriptor);
    return mapping;
  }
  void* address = ::mmap(nullptr, mapping.size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (address == MAP_FAILED) {
    const std::string why = std::strerror(errno);
    ::close(descriptor);
    throw input_error(file.string(), "cannot map the file: " + why);
  }
  mapping.data = static_cast<const std::byte*>(address);
  ::madvise(address, mapping.size, MADV_SEQUENTIAL);
  mapping.range = keep_range(address, mapping.size, descriptor);
  return mapping;
}

void unmap_file(const Mapping& mapping) noexcept {
  if (mapping.data == nullptr) return;
  ::close(mapping.range->descriptor);
  ::munmap(const_cast<std::byte*>(mapping.data), mapping.size);
  mapping.range->begin.store(0);
}

bool is_whole(const Mapping& mapping) noexcept {
  if (mapping.range == nullptr) return true;
  struct stat status {};
  return !mapping.range->cut.load() && ::fstat(mapping.range->descriptor, &status) == 0 &&
         static_cast<std::size_t>(status.st_size) >= mapping.size;
}

void survive_cut_files() noexcept {
  struct sigaction action {};
  action.sa_sigaction = on_bus_error;
  action.sa_flags = SA_SIGINFO;
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGBUS, &action, nullptr);
}

std::intptr_t create_exclusively(const std::filesystem::path& path, bool folder) {
  int handle = -1;
  if (!folder) {
    handle = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } else if (::mkdir(path.c_str(), 0777) == 0) {
    handle = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  }
  if (handle < 0) {
    if (errno == EEXIST) return -1;
    fail_to_create(path, std::strerror(errno));
  }
  // Another process may take it for abandoned before it is locked: then it is that one's to remove.
  struct stat status {};
  if ((::flock(handle, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) || ::fstat(handle, &status) != 0 ||
      status.st_nlink == 0) {
    ::close(handle);
    return -1;
  }
  return handle;
}

void release(std::intptr_t handle) noexcept { ::close(static_cast<int>(handle)); }

void remove_abandoned(const std::filesystem::path& path) noexcept {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return;
  struct stat status {};
  if (::fstat(descriptor, &status) == 0 && (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode)) &&
      status.st_uid == ::geteuid() && ::flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  ::close(descriptor);
}

bool is_writable(const std::filesystem::path& path) noexcept {
  return ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) == 0;
}

bool process_exists(std::uint64_t number) noexcept {
  return ::kill(static_cast<pid_t>(number), 0) == 0 || errno == EPERM;
}

void allow_many_open_files() noexcept {
  struct rlimit limit {};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

void release_pages(const Mapping& mapping, std::size_t begin, std::size_t end) noexcept {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  begin = (begin + page - 1) / page * page;
  end = end / page * page;
  if (mapping.data == nullptr || end > mapping.size || begin >= end) return;
  ::madvise(const_cast<std::byte*>(mapping.data + begin), end - begin, MADV_DONTNEED);
}

ScratchFile::ScratchFile(const std::filesystem::path& folder) : folder_(folder) {
  std::string name = ((folder.empty() ? std::filesystem::path(".") : folder) / ".sparsha-XXXXXX").string();
  const int descriptor = ::mkstemp(name.data());
  if (descriptor < 0) fail(folder_, std::strerror(errno));
  ::fcntl(descriptor, F_SETFD, FD_CLOEXEC);
  ::unlink(name.c_str());
  handle_ = descriptor;
}

ScratchFile::~ScratchFile() { ::close(static_cast<int>(handle_)); }

void ScratchFile::write(std::uint64_t offset, std::span<const std::byte> bytes) {
  in_pieces(offset, bytes, [this](std::span<const std::byte> piece, std::uint64_t at) -> std::size_t {
    const ssize_t done = ::pwrite(static_cast<int>(handle_), piece.data(), piece.size(), static_cast<off_t>(at));
    if (done == 0) fail(folder_, "nothing was written");
    if (done < 0 && errno != EINTR) fail(folder_, std::strerror(errno));
    return done > 0 ? static_cast<std::size_t>(done) : 0;
  });
}

void ScratchFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  in_pieces(offset, bytes, [this](std::span<std::byte> piece, std::uint64_t at) -> std::size_t {
    const ssize_t done = ::pread(static_cast<int>(handle_), piece.data(), piece.size(), static_cast<off_t>(at));
    if (done == 0) fail(folder_, "it is shorter than what was written");
    if (done < 0 && errno != EINTR) fail(folder_, std::strerror(errno));
    return done > 0 ? static_cast<std::size_t>(done) : 0;
  });
}

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

bool exchange_paths(const std::filesystem::path& a, const std::filesystem::path& b) noexcept {
#if defined(__linux__) && defined(RENAME_EXCHANGE)
  return ::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
#else
  static_cast<void>(a);
  static_cast<void>(b);
  return false;
#endif
}

void advise_large_pages(void* data, std::size_t size) noexcept {
#if defined(MADV_HUGEPAGE)
  if (size < 2 * kLargePageBytes) return;
  const std::size_t past = reinterpret_cast<std::uintptr_t>(data) % kLargePageBytes;
  const std::size_t before = past > 0 ? kLargePageBytes - past : 0;
  const std::size_t whole = (size - before) / kLargePageBytes * kLargePageBytes;
  ::madvise(static_cast<char*>(data) + before, whole, MADV_HUGEPAGE);
#else
  static_cast<void>(data);
  static_cast<void>(size);
#endif
}

void append_line(const std::filesystem::path& file, std::string_view first, std::string_view line) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor < 0) fail_to_append(file, std::strerror(errno));
  while (::flock(descriptor, LOCK_EX) != 0 && errno == EINTR) {
  }
  const off_t size = ::lseek(descriptor, 0, SEEK_END);
  std::string text;
  char last = '\n';
  if (size == 0) text = first;
  if (size > 0 && ::pread(descriptor, &last, 1, size - 1) == 1 && last != '\n') text = "\n";
  text += line;
  std::string why;
  for (std::string_view rest = text; !rest.empty() && why.empty();) {
    const ssize_t done = ::write(descriptor, rest.data(), rest.size());
    if (done >= 0) rest.remove_prefix(static_cast<std::size_t>(done));
    if (done < 0 && errno != EINTR) why = std::strerror(errno);
  }
  if (!why.empty()) static_cast<void>(::ftruncate(descriptor, size) == 0);
  if (::close(descriptor) != 0 && why.empty()) why = std::strerror(errno);
  if (!why.empty()) fail_to_append(file, why);
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
