// The public header block and the variable length records of a LAS file, checked against the file's size.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/scan/file.h"
#include "pipeline/scan/reader.h"

namespace sparsha::pipeline::las {

/// Records of the reference.
inline constexpr std::uint16_t kGeoKeys = 34735, kGeoNumbers = 34736, kGeoText = 34737, kWkt = 2112;

struct Record {
  std::string user;
  std::uint16_t id = 0;
  std::string_view data;

  /// Whether it is one of those that say what the coordinates refer to (LAS 1.4 R15, 3); libLAS wrote WKT as its own.
  [[nodiscard]] bool is_reference(std::uint16_t of) const;
};

struct Header {
  int minor = 0;
  int format = 0;           ///< of the points, without the bit that says compressed
  bool compressed = false;  ///< LAZ
  bool says_wkt = false;    ///< that the reference is WKT; else it is GeoTIFF keys
  std::uint64_t points = 0;
  std::size_t record_size = 0;
  std::size_t first_point = 0;  ///< offset
  std::array<double, 3> scale{};
  std::array<double, 3> offset{};
  std::array<double, 3> box_low{};   ///< of the points, as the header has it
  std::array<double, 3> box_high{};  ///< the same
  double box_side = 0.0;             ///< the longest; 0: the header has no box
  std::vector<Record> records;
  std::vector<std::string> warnings;

  /// Offset of red, green and blue within a point; 0 when the format has none.
  [[nodiscard]] std::size_t colour_offset() const;
  /// Offset of what a program added to the points of the format.
  [[nodiscard]] std::size_t extra_offset() const;
};

/// Throws Error{input} when anything but the number of records does not fit the file.
[[nodiscard]] Header parse_header(const ScanFile& file);

/// Unit of x and y and what must be done with z, as far as GeoTIFF keys or WKT tell.
struct Units {
  std::optional<scene::LengthUnit> unit;
  bool degrees = false;
  double z_factor = 1.0;  ///< makes z a height in the unit of x and y; below 0 of depths
  std::vector<std::string> warnings;
};
[[nodiscard]] Units find_units(const Header& header);

/// What a text in OGC WKT 1 or 2 says; metres in one unit, 0 where it says nothing.
struct WktUnits {
  bool geographic = false;
  double horizontal_m = 0.0;
  double vertical_m = 0.0;
  bool down = false;  ///< heights count downwards: they are depths
};
[[nodiscard]] WktUnits parse_wkt_units(std::string_view text);

}  // namespace sparsha::pipeline::las
