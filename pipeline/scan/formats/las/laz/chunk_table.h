// Where the chunks of a LAZ file are, and how many points each has.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/scan/formats/las/laz/packing.h"

namespace sparsha::pipeline::laz {

struct Chunk {
  std::size_t begin = 0;  ///< in the file
  std::size_t size = 0;   ///< bytes
  std::uint64_t points = 0;
};

struct ChunkTable {
  std::vector<Chunk> chunks;
  /// Of a file whose table is missing: the chunks follow one another from here to the end.
  std::optional<std::size_t> untabled;
  std::string why;  ///< what became of the table, when it is missing
};

/// Reads the table of a file of compressor 2 or 3 whose header promises `points` from byte `first_point` on. Takes
/// memory for no more chunks than bytes. Throws Damage when the table disagrees with the file or the header.
[[nodiscard]] ChunkTable read_chunk_table(std::string_view file, std::size_t first_point, std::uint64_t points,
                                          const Packing& packing);

}  // namespace sparsha::pipeline::laz
