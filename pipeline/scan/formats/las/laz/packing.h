// How the points of a LAZ file are packed: the record 22204 of "laszip encoded".
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "pipeline/scan/formats/las/laz/arithmetic.h"

namespace sparsha::pipeline::laz {

enum class Compressor : std::uint8_t { pointwise = 1, chunked = 2, layered = 3 };

enum class ItemType : std::uint8_t {
  byte = 0,
  point10 = 6,
  gps_time11 = 7,
  rgb12 = 8,
  wave_packet13 = 9,
  point14 = 10,
  rgb14 = 11,
  rgb_nir14 = 12,
  wave_packet14 = 13,
  byte14 = 14,
};

/// Some consecutive bytes of the record of a point.
struct Item {
  ItemType type{};
  std::size_t offset = 0;  ///< within the record
  std::size_t size = 0;
  int version = 0;
};

struct Packing {
  Compressor compressor{};
  std::uint32_t chunk_points = 0;  ///< in a chunk; 0: any, the table of chunks tells
  bool as_older_points = false;    ///< LAS 1.4 points kept in older formats and extra bytes
  std::vector<Item> items;
  std::size_t record_size = 0;
};

/// `place`: of the record's data in the file. Throws Damage, also when the items do not make records of `record_size`.
[[nodiscard]] Packing parse_packing(std::string_view data, std::size_t place, std::size_t record_size);

}  // namespace sparsha::pipeline::laz
