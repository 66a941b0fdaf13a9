// A zip archive in memory: its parts by name, unpacked with their checksums.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/scan/file.h"

namespace sparsha::pipeline {

class ZipArchive {
 public:
  /// Reads the directory. Throws Error{input} when there is none, or it does not fit the file.
  explicit ZipArchive(const ScanFile& file);

  /// By its name without a first slash, letters of any case, as packages compare them.
  [[nodiscard]] bool has(std::string_view name) const { return find(name) != nullptr; }
  /// Throws Error{input} for a part that is not there, is damaged or encrypted, or unpacks to far more than it holds.
  [[nodiscard]] std::string read(std::string_view name) const;

 private:
  struct Part {
    std::string name;  ///< lower case
    std::uint16_t flags = 0, method = 0;
    std::uint32_t checksum = 0, packed = 0, size = 0, place = 0;
  };
  [[nodiscard]] const Part* find(std::string_view name) const;

  const ScanFile& file_;
  std::vector<Part> parts_;
};

}  // namespace sparsha::pipeline
