// The header of a PCD file and what its fields mean to us.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/scan/file.h"
#include "pipeline/scan/scalar.h"

namespace sparsha::pipeline::pcd {

struct Field {
  std::string name;  ///< lower case
  ScalarType type = ScalarType::f32;
  std::size_t count = 1;
  std::size_t offset = 0;  ///< bytes from the record's beginning
  std::size_t column = 0;  ///< values from the record's beginning
};

enum class Encoding : std::uint8_t { ascii, binary, compressed };

struct Header {
  std::vector<Field> fields;
  std::uint64_t points = 0;
  Encoding encoding = Encoding::ascii;
  std::size_t record_size = 0;  ///< bytes
  std::size_t columns = 0;      ///< values of a record
  std::optional<std::array<double, 7>> viewpoint;
  std::size_t body = 0;  ///< offset of the first byte behind the header
  int lines = 0;

  /// The first field with that name and at least one value, null without.
  [[nodiscard]] const Field* find(std::string_view name) const;
};

[[nodiscard]] Header parse_header(const ScanFile& file);

}  // namespace sparsha::pipeline::pcd
