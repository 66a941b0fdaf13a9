// The physical side of an E57 file: pages of which the last four bytes are a checksum of the others.
#pragma once

#include <cstdint>
#include <string>

#include "pipeline/scan/file.h"

namespace sparsha::pipeline::e57 {

/// CRC-32C (Castagnoli 1993), as iSCSI and E57 have it.
[[nodiscard]] std::uint32_t crc32c(std::string_view bytes);

/// The file without its checksums. The constructor checks the header and every page; throws Error{input}.
class Pages {
 public:
  explicit Pages(const ScanFile& file);

  /// The XML section.
  [[nodiscard]] std::string xml() const;
  /// Logical offset of a physical one; throws when it is beyond the file or within a checksum.
  [[nodiscard]] std::uint64_t logical(std::uint64_t physical, const char* what) const;
  /// Copies logical bytes; throws when they are beyond the file.
  void read(std::uint64_t offset, char* target, std::size_t count) const;
  [[nodiscard]] std::uint64_t size() const { return logical_size_; }
  /// Tells the system that logical bytes before `offset` were read for the last time.
  void done_before(std::uint64_t offset) const;

 private:
  const ScanFile& file_;
  std::uint64_t page_ = 1024;
  std::uint64_t logical_size_ = 0;
};

}  // namespace sparsha::pipeline::e57
