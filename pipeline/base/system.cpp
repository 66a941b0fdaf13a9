// POSIX and Windows calls; nothing else of the pipeline includes system headers.
#include "pipeline/base/system.h"

#include <algorithm>
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
  if (mapping.size > 0) {
    void* address = ::mmap(nullptr, mapping.size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    ::close(descriptor);
    if (address == MAP_FAILED) {
      throw input_error(file.string(), "cannot map the file: " + std::string(std::strerror(errno)));
    }
    mapping.data = static_cast<const std::byte*>(address);
    ::madvise(address, mapping.size, MADV_SEQUENTIAL);
  } else {
    ::close(descriptor);
  }
  return mapping;
}

void unmap_file(const Mapping& mapping) noexcept {
  if (mapping.data != nullptr) ::munmap(const_cast<std::byte*>(mapping.data), mapping.size);
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

std::uint64_t physical_memory_bytes() noexcept {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  const long page = ::sysconf(_SC_PAGESIZE);
  return pages > 0 && page > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page) : 0;
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
