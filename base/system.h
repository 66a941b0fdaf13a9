// What differs between operating systems, behind one header: memory maps, peak memory, durable renames, terminals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

namespace sparsha::system {

struct MappedRange;

struct Mapping {
  const std::byte* data = nullptr;
  std::size_t size = 0;
  MappedRange* range = nullptr;  ///< how is_whole() knows it
};

/// Maps a regular file read-only; throws Error{input}. An empty file maps to {nullptr, 0}.
[[nodiscard]] Mapping map_file(const std::filesystem::path& file);
void unmap_file(const Mapping& mapping) noexcept;
/// Drops the pages of [begin, end) from memory; they are read again when touched.
void release_pages(const Mapping& mapping, std::size_t begin, std::size_t end) noexcept;

/// What is left of a mapped file: false once it has become shorter than it was when it was mapped. Bytes that went
/// missing read as zeros where survive_cut_files() is in force, and end the program elsewhere.
[[nodiscard]] bool is_whole(const Mapping& mapping) noexcept;
/// Catches SIGBUS in this process, so that a file cut short while it is mapped is told by is_whole().
void survive_cut_files() noexcept;

/// Creates an empty file or folder where nothing is, not even a symbolic link, and marks it as in use while the handle
/// is held. -1 when something of that name is there. Throws Error{failure} with the system's reason.
[[nodiscard]] std::intptr_t create_exclusively(const std::filesystem::path& path, bool folder);
void release(std::intptr_t handle) noexcept;
/// Removes a file or folder of this user that create_exclusively() made and no process holds any more.
void remove_abandoned(const std::filesystem::path& path) noexcept;
/// True when this user may write to an existing file or folder.
[[nodiscard]] bool is_writable(const std::filesystem::path& path) noexcept;
/// True when a process of that number exists.
[[nodiscard]] bool process_exists(std::uint64_t number) noexcept;
/// Allows this process as many open files as the system lets it have.
void allow_many_open_files() noexcept;

/// Where the system wants files that nobody keeps. Throws Error{failure} when there is no such folder.
[[nodiscard]] std::filesystem::path temporary_folder();

/// A file without a name: it goes when it is closed or when the program ends, however that ends. Several threads may
/// read and write different parts.
class ScratchFile {
 public:
  /// Throws Error{failure} when `folder` cannot be written to.
  explicit ScratchFile(const std::filesystem::path& folder);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  /// Throw Error{failure}, with the system's reason (a full disk).
  void write(std::uint64_t offset, std::span<const std::byte> bytes);
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Gives the disk of these bytes back, where the system can; they are not read again.
  void release(std::uint64_t offset, std::uint64_t size) noexcept;

 private:
  std::filesystem::path folder_;
  std::intptr_t handle_ = -1;
};

/// Highest resident set size of this process so far, bytes.
[[nodiscard]] std::uint64_t peak_rss_bytes() noexcept;
/// Memory that this process may have: the machine's, or less where a limit is set; bytes, 0 when unknown.
[[nodiscard]] std::uint64_t physical_memory_bytes() noexcept;
/// Swaps two existing paths as one step where the system can; false when it cannot.
[[nodiscard]] bool exchange_paths(const std::filesystem::path& a, const std::filesystem::path& b) noexcept;
/// What a processor maps at once where the system has large pages, bytes.
constexpr std::size_t kLargePageBytes = std::size_t{2} << 20U;
/// Tells the system, before a buffer is touched for the first time, that it will be used as a whole, so that large
/// pages may be taken for those that lie whole in it. Advice only: what the system makes of it changes no value.
/// Nothing for buffers below two such pages.
void advise_large_pages(void* data, std::size_t size) noexcept;
/// Appends `line` to a text file as one step among all that do so: locked meanwhile, `first` before it where the file
/// is new, a line feed where the last line has none. A full disk leaves the file as it was. Throws Error{failure}.
void append_line(const std::filesystem::path& file, std::string_view first, std::string_view line);
/// Number that tells concurrent writers apart (process id).
[[nodiscard]] unsigned process_id() noexcept;
/// True when standard error is a terminal.
[[nodiscard]] bool stderr_is_terminal() noexcept;
/// Returns freed heap memory to the system.
void trim_heap() noexcept;
/// From now on freed memory of up to 32 MB stays with the heap, whose pages cost more time than what is computed in
/// them; a program calls it before others run.
void keep_heap() noexcept;
/// While one lives, freed memory goes back to the system at once and none is taken in large pages: a program needs
/// little more memory than it uses, at the price of time. Of this process, whichever thread; they may overlap.
class ThriftyHeap {
 public:
  ThriftyHeap() noexcept;
  ~ThriftyHeap();
  ThriftyHeap(const ThriftyHeap&) = delete;
  ThriftyHeap& operator=(const ThriftyHeap&) = delete;
};

}  // namespace sparsha::system
