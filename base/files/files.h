// Files that are either whole or not there, SHA-256, and memory-mapped input.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/system.h"

namespace sparsha {

/// An empty file or folder beside `target` to write to; commit() renames it over the target, the destructor removes
/// what was not committed. Its name is random, and what ended programs have left of the same target is removed. An old
/// folder is replaced as a whole, a symbolic link is replaced and never followed. Character devices and this program's
/// own standard streams are written to directly.
class AtomicPath {
 public:
  enum class Kind { file, folder };
  /// Throws Error{usage} for a named pipe, a socket, a block device and for a folder behind a symbolic link;
  /// Error{failure} when the target cannot be written, so that work whose result would be lost is not begun.
  explicit AtomicPath(std::filesystem::path target, Kind kind = Kind::file);
  ~AtomicPath();
  AtomicPath(const AtomicPath&) = delete;
  AtomicPath& operator=(const AtomicPath&) = delete;

  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  /// What write() gives. An error that names something at the temporary path comes out naming it at the target, which
  /// is what the user asked for; errors of std::filesystem become Error{failure}.
  template <typename Write>
  auto naming_target(const Write& write) const {
    try {
      return write();
    } catch (const std::exception&) {
      rethrow_naming_target();
    }
  }
  /// Throws Error{failure} when the rename fails; the old target is then still in place.
  void commit();

 private:
  [[noreturn]] void rethrow_naming_target() const;

  std::filesystem::path target_;
  Kind kind_;
  std::filesystem::path temporary_;
  std::intptr_t handle_ = -1;
};

/// Throws as AtomicPath would; leaves nothing behind.
void require_writable(const std::filesystem::path& target, AtomicPath::Kind kind = AtomicPath::Kind::file);
/// Throws Error{usage} when two of these outputs, or an output and an input, are the same file, whatever they are
/// called: also through symbolic and hard links. Empty paths are none. Each has the name that messages use, e.g.
/// "--record".
struct NamedPath {
  std::string name;
  std::filesystem::path path;
};
void require_distinct(const std::vector<NamedPath>& outputs, const std::vector<NamedPath>& inputs = {});
/// True when `path` is `folder` or lies in it, symbolic links resolved.
[[nodiscard]] bool lies_within(const std::filesystem::path& path, const std::filesystem::path& folder);

/// Writes a whole text file atomically. Throws Error{failure}.
void write_file(const std::filesystem::path& target, std::string_view bytes);
/// Reads a whole file. Throws Error{input} when it is missing, not a regular file or larger than `limit` bytes.
[[nodiscard]] std::string read_file(const std::filesystem::path& file, std::size_t limit);

/// Removes a regular file that begins with these bytes; any other one, a folder or a link stays.
void remove_own_file(const std::filesystem::path& file, std::string_view begin);

/// Read-only view of a file's bytes. Throws Error{input} when it cannot be opened or is not a regular file.
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& file);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  [[nodiscard]] std::span<const std::byte> bytes() const { return {mapping_.data, mapping_.size}; }
  [[nodiscard]] std::string_view text() const { return {reinterpret_cast<const char*>(mapping_.data), mapping_.size}; }
  /// What read() gives, or throws; Error{input} in its place when the file became shorter meanwhile.
  template <typename Read>
  auto whole(const Read& read) const {
    try {
      auto result = read();
      require_whole();
      return result;
    } catch (const Cancelled&) {
      throw;
    } catch (const Error&) {
      require_whole();
      throw;
    }
  }
  /// Throws Error{input} when the file became shorter since it was mapped: then some bytes are zeros that never were.
  void require_whole() const;
  /// Tells the system that bytes before `offset` are no longer needed (keeps peak RSS low while streaming).
  void release_before(std::size_t offset) const;

 private:
  std::filesystem::path file_;
  system::Mapping mapping_;
};

/// Lower-case hexadecimal SHA-256.
[[nodiscard]] std::string sha256(std::span<const std::byte> bytes);

/// The same of bytes that come piece by piece.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;
  void add(std::span<const std::byte> bytes);
  /// To be called once, at the end.
  [[nodiscard]] std::string finish();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha
