// Files of the operating system. Nothing but this, its neighbours and haptics/servo/real_time.cpp includes
// system headers.
#include "base/system.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <string>
#include <string_view>
#include <system_error>

#include "base/error.h"

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

void ScratchFile::release(std::uint64_t, std::uint64_t) noexcept {}

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

#else

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

void allow_many_open_files() noexcept {
  struct rlimit limit {};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
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

void ScratchFile::release(std::uint64_t offset, std::uint64_t size) noexcept {
#if defined(__linux__) && defined(FALLOC_FL_PUNCH_HOLE)
  // What the file system cannot do stays until the file is closed.
  static_cast<void>(::fallocate(static_cast<int>(handle_), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE,
                                static_cast<off_t>(offset), static_cast<off_t>(size)));
#else
  static_cast<void>(offset);
  static_cast<void>(size);
#endif
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

#endif

std::filesystem::path temporary_folder() {
  std::error_code code;
  std::filesystem::path folder = std::filesystem::temp_directory_path(code);
  if (!code) return folder;
  const char* const named = std::getenv("TMPDIR");
  throw Error(ErrorKind::failure, {named != nullptr ? named : "", 0, 0},
              "there is no folder for temporary files: " + code.message(),
              "TMPDIR unset, or naming a folder that is there");
}

}  // namespace sparsha::system
