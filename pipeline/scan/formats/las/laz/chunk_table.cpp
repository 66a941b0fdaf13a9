#include "pipeline/scan/formats/las/laz/chunk_table.h"

#include <algorithm>

#include "pipeline/scan/formats/las/laz/fields.h"
#include "pipeline/scan/formats/las/laz/integers.h"

namespace sparsha::pipeline::laz {
namespace {

constexpr std::size_t kPlace = 8;  // bytes of the table's place
constexpr std::size_t kHead = 8;   // version and number of chunks

const std::uint8_t* at(std::string_view file, std::size_t place) {
  return reinterpret_cast<const std::uint8_t*>(file.data()) + place;
}

/// Without a table only chunks of one size can be told apart.
ChunkTable without_table(std::string why, std::size_t first_point, const Packing& packing) {
  if (packing.chunk_points == 0) {
    throw Damage{why + ", and chunks of different numbers of points cannot be read without it", first_point};
  }
  ChunkTable table;
  table.untabled = first_point + kPlace;
  table.why = std::move(why);
  return table;
}

void check_chunks(std::uint64_t chunks, std::uint64_t points, std::size_t packed, std::size_t place,
                  const Packing& packing) {
  const std::uint64_t each = packing.chunk_points;
  if (each != 0 && points / each + (points % each != 0 ? 1 : 0) != chunks) {
    throw Damage{std::to_string(points) + " points are not in " + std::to_string(chunks) + " LAZ chunks of " +
                     std::to_string(each),
                 place + 4};
  }
  if (chunks > packed || (points > 0 && chunks == 0)) {
    throw Damage{std::to_string(chunks) + " LAZ chunks cannot be in " + std::to_string(packed) + " bytes", place + 4};
  }
}

}  // namespace

ChunkTable read_chunk_table(std::string_view file, std::size_t first_point, std::uint64_t points,
                            const Packing& packing) {
  if (file.size() - first_point < kPlace) throw Damage{"the file ends before its LAZ points", file.size()};
  std::int64_t told = get<std::int64_t>(at(file, first_point));
  if (told == -1) told = get<std::int64_t>(at(file, file.size() - kPlace));
  const std::size_t begin = first_point + kPlace;
  if (told == static_cast<std::int64_t>(first_point)) {
    return without_table("the table of LAZ chunks was never written", first_point, packing);
  }
  if (told < static_cast<std::int64_t>(begin) || static_cast<std::uint64_t>(told) > file.size() - kHead) {
    return without_table("the table of LAZ chunks should be at byte " + std::to_string(told) + ", the file has " +
                             std::to_string(file.size()),
                         first_point, packing);
  }
  const auto place = static_cast<std::size_t>(told);
  if (get<std::uint32_t>(at(file, place)) != 0) {
    throw Damage{"there is no table of LAZ chunks where it should be", place};
  }
  const std::uint64_t chunks = get<std::uint32_t>(at(file, place + 4));
  check_chunks(chunks, points, place - begin, place, packing);
  ChunkTable table;
  if (chunks == 0) return table;

  Decoder in(file.substr(place + kHead), place + kHead);
  IntegerModel numbers(32, 2);
  std::int32_t count = 0, size = 0;
  std::size_t next = begin;
  std::uint64_t left = points;
  for (std::uint64_t i = 0; i < chunks; ++i) {
    const std::string which = "LAZ chunk " + std::to_string(i + 1) + " of " + std::to_string(chunks);
    std::uint64_t held = std::min<std::uint64_t>(left, packing.chunk_points);
    if (packing.chunk_points == 0) {
      count = numbers.get(in, count, 0);
      held = static_cast<std::uint32_t>(count);
    }
    size = numbers.get(in, size, 1);
    const auto bytes = static_cast<std::size_t>(static_cast<std::uint32_t>(size));
    if (held > left) {
      throw Damage{"the table gives " + which + " " + std::to_string(held) + " points where the header leaves " +
                       std::to_string(left),
                   place};
    }
    if (bytes > place - next || (held > 0 && bytes < packing.record_size)) {
      throw Damage{"the table gives " + which + " " + std::to_string(bytes) + " bytes for " + std::to_string(held) +
                       " points; " + std::to_string(place - next) + " are left",
                   place};
    }
    table.chunks.push_back({next, bytes, held});
    next += bytes;
    left -= held;
  }
  if (in.past() > 0) return without_table("the table of LAZ chunks is cut off", first_point, packing);
  if (left != 0) {
    throw Damage{"the chunks of the table have " + std::to_string(left) + " points fewer than the header", place};
  }
  return table;
}

}  // namespace sparsha::pipeline::laz
