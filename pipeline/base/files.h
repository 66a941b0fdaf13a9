// Files that are either whole or not there, SHA-256, and memory-mapped input.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace sparsha {

/// A path beside `target` to write to; commit() renames it over the target, the destructor removes what was not
/// committed. Works for files and folders; an old folder is replaced as a whole. Devices and pipes are written to
/// directly and never replaced.
class AtomicPath {
 public:
  explicit AtomicPath(std::filesystem::path target);
  ~AtomicPath();
  AtomicPath(const AtomicPath&) = delete;
  AtomicPath& operator=(const AtomicPath&) = delete;

  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  /// Throws Error{failure} when the rename fails; the old target is then still in place.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
};

/// Writes a whole text file atomically. Throws Error{failure}.
void write_file(const std::filesystem::path& target, std::string_view bytes);
/// Reads a whole file. Throws Error{input} when it is missing, not a regular file or larger than `limit` bytes.
[[nodiscard]] std::string read_file(const std::filesystem::path& file, std::size_t limit);

/// Read-only view of a file's bytes. Throws Error{input} when it cannot be opened or is not a regular file.
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& file);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  [[nodiscard]] std::span<const std::byte> bytes() const { return {data_, size_}; }
  [[nodiscard]] std::string_view text() const { return {reinterpret_cast<const char*>(data_), size_}; }
  /// Tells the system that bytes before `offset` are no longer needed (keeps peak RSS low while streaming).
  void release_before(std::size_t offset) const;

 private:
  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
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
