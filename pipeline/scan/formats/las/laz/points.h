// The points of a LAZ file as records of plain LAS, chunk by chunk.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/threads/thread_pool.h"
#include "pipeline/scan/formats/las/laz/chunk_table.h"
#include "pipeline/scan/formats/las/laz/layers.h"
#include "pipeline/scan/formats/las/laz/packing.h"

namespace sparsha::pipeline::laz {

struct Source {
  std::string_view file;
  std::size_t first_point = 0;  ///< offset of point data
  std::uint64_t points = 0;     ///< as the header has it
  Packing packing;
};

/// Takes whole records, in the file's order and on the caller's thread. `place`: bytes of the file before it are done.
using RecordSink = std::function<void(std::string_view records, std::size_t place)>;

/// What becomes of a chunk that is damaged.
enum class Damaged : std::uint8_t {
  refused,  ///< Damage is thrown
  left_out  ///< with all its points; what is whole is kept
};

struct Outcome {
  std::vector<std::string> warnings;  ///< of what is odd and does no harm, and of what is left out
  std::size_t chunks = 0;             ///< that the table has; 0: there is none
  std::size_t end = 0;                ///< behind the last byte that was read; 0: unknown
};

/// Decodes chunks in parallel. Layers that are not wanted keep the values of their chunk's first point (compressor 3;
/// the others have but one stream). The sink is called while others decode. Memory: for each thread one chunk of up to
/// 2^18 points and one more, larger ones in blocks. Throws Damage with the chunk's number; records before it have been
/// handed over. Where damaged chunks are left out, only when there is no whole one, or no chunk to be told.
Outcome read_points(const Source& source, Layers wanted, ThreadPool& pool, const RecordSink& sink,
                    Damaged damaged = Damaged::refused);

/// The same for some of the chunks, which are in the file's order.
void read_chunks(const Source& source, const std::vector<Chunk>& chunks, Layers wanted, ThreadPool& pool,
                 const RecordSink& sink);

/// The layers that hold the bytes `begin` to `end` of a record.
[[nodiscard]] Layers layers_at(const Packing& packing, std::size_t begin, std::size_t end);

}  // namespace sparsha::pipeline::laz
