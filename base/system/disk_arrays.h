// Large arrays in files: while a DiskArrays is in force, the program's operator new maps them from files without a
// name, and their pages leave memory when the process has more than its limit. Code that uses the arrays knows nothing
// of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

namespace sparsha::system {

constexpr std::size_t kLeastDiskArray = std::size_t{4} << 20U;  ///< bytes; smaller arrays stay in memory

/// Said once, before main(), by the file of a program that replaces operator new with one that asks the functions
/// below.
void allow_disk_arrays() noexcept;
/// Whether this program can keep large arrays in files.
[[nodiscard]] bool has_disk_arrays() noexcept;

/// Whether an array of so many bytes is to lie in a file. For operator new, as the two below.
[[nodiscard]] bool wants_disk_array(std::size_t bytes) noexcept;
/// Zeros from a new file; null where the disk has no room for them.
[[nodiscard]] void* take_disk_array(std::size_t bytes) noexcept;
/// Frees what take_disk_array() gave, also after the DiskArrays has gone; false when `array` is none of those.
[[nodiscard]] bool give_disk_array(void* array) noexcept;

/// In force while it lives; one at a time.
class DiskArrays {
 public:
  /// Arrays taken from now on lie in `folder`, and of all of them no more stays in memory than keeps the process's
  /// resident set below `resident_bytes`, as far as it is theirs. Throws Error{failure} when the folder cannot be
  /// written to.
  DiskArrays(const std::filesystem::path& folder, std::uint64_t resident_bytes);
  ~DiskArrays();
  DiskArrays(const DiskArrays&) = delete;
  DiskArrays& operator=(const DiskArrays&) = delete;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Lets go of pages of such arrays when there are too many; every worker calls it after each piece of its work. One
/// atomic read while no DiskArrays is in force.
void keep_to_memory() noexcept;

/// Throws Error{failure} with the system's reason when an array of the latest DiskArrays got no room, which the one who
/// asked for it knows as std::bad_alloc.
void throw_if_disk_was_full();

}  // namespace sparsha::system
