#include "pipeline/scan/formats/las/laz/packing.h"

#include <string>

#include "pipeline/scan/formats/las/laz/fields.h"

namespace sparsha::pipeline::laz {
namespace {

/// The only size that an item may have; 0: any but none.
std::size_t size_of(int type) {
  constexpr std::size_t kSizes[] = {20, 8, 6, 29, 30, 6, 8, 29};
  return type >= 6 && type <= 13 ? kSizes[type - 6] : 0;
}

bool is_known(int type, int version) {
  if (type == 9) return version == 1;
  if (type == 0 || (type >= 6 && type <= 8)) return version == 1 || version == 2;
  return type >= 10 && type <= 14 && version >= 2 && version <= 4;
}

void check_first(const Packing& packing, std::size_t place) {
  const bool layered = packing.compressor == Compressor::layered;
  const ItemType first = layered ? ItemType::point14 : ItemType::point10;
  for (std::size_t i = 0; i < packing.items.size(); ++i) {
    const ItemType type = packing.items[i].type;
    if ((type == first) != (i == 0) || (type >= ItemType::point14) != layered) {
      throw Damage{"LAZ items of type " + std::to_string(static_cast<int>(type)) + " where others are due",
                   place + 34 + 6 * i};
    }
  }
}

}  // namespace

Packing parse_packing(std::string_view data, std::size_t place, std::size_t record_size) {
  constexpr std::size_t kLeast = 34;
  constexpr std::size_t kItem = 6;
  const auto* const p = reinterpret_cast<const std::uint8_t*>(data.data());
  if (data.size() < kLeast) throw Damage{"a LASzip record of " + std::to_string(data.size()) + " bytes", place};
  const int compressor = get<std::uint16_t>(p);
  if (compressor < 1 || compressor > 3) {
    throw Damage{"the LAZ points are packed by compressor " + std::to_string(compressor) + ", not 1 to 3", place};
  }
  if (const int coder = get<std::uint16_t>(p + 2); coder != 0) {
    throw Damage{"the LAZ points are packed by coder " + std::to_string(coder) + ", not 0", place + 2};
  }
  Packing packing;
  packing.compressor = static_cast<Compressor>(compressor);
  packing.as_older_points = (p[8] & 1U) != 0;
  packing.chunk_points = get<std::uint32_t>(p + 12);
  if (packing.chunk_points == 0xFFFFFFFFU) packing.chunk_points = 0;
  const std::size_t items = get<std::uint16_t>(p + 32);
  if (items == 0 || (data.size() - kLeast) / kItem < items) {
    throw Damage{std::to_string(items) + " LAZ items in a record of " + std::to_string(data.size()) + " bytes",
                 place + 32};
  }
  for (std::size_t i = 0; i < items; ++i) {
    const std::uint8_t* const item = p + kLeast + kItem * i;
    const int type = get<std::uint16_t>(item);
    const std::size_t size = get<std::uint16_t>(item + 2);
    const int version = get<std::uint16_t>(item + 4);
    if (!is_known(type, version) || (size_of(type) != 0 && size != size_of(type)) || size == 0) {
      throw Damage{"a LAZ item of type " + std::to_string(type) + ", version " + std::to_string(version) + ", " +
                       std::to_string(size) + " bytes",
                   place + kLeast + kItem * i};
    }
    packing.items.push_back({static_cast<ItemType>(type), packing.record_size, size, version});
    packing.record_size += size;
  }
  if (packing.record_size != record_size) {
    throw Damage{"the LAZ items make " + std::to_string(packing.record_size) + " bytes of a point, the header " +
                     std::to_string(record_size),
                 place + kLeast};
  }
  check_first(packing, place);
  return packing;
}

}  // namespace sparsha::pipeline::laz
