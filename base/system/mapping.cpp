// Files mapped into memory.
#include <atomic>
#include <mutex>
#include <string>

#include "base/error.h"
#include "base/system.h"

#if defined(_WIN32)
#define NOMINMAX
#include <windows.h>
#else
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#endif

namespace sparsha::system {

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

// Puts zeros in place of what is gone, and marks the mapping; any other SIGBUS ends the program as it always did.
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

void release_pages(const Mapping& mapping, std::size_t begin, std::size_t end) noexcept {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  begin = (begin + page - 1) / page * page;
  end = end / page * page;
  if (mapping.data == nullptr || end > mapping.size || begin >= end) return;
  ::madvise(const_cast<std::byte*>(mapping.data + begin), end - begin, MADV_DONTNEED);
}

#endif

}  // namespace sparsha::system
