#include "pipeline/scan/formats/las/laz/layered.h"

#include <cstring>
#include <utility>

namespace sparsha::pipeline::laz {
namespace {

std::size_t layers_of(const Item& item) {
  switch (item.type) {
    case ItemType::point14:
      return kPoint14Layers;
    case ItemType::rgb_nir14:
      return 2;
    case ItemType::byte14:
      return item.size;
    default:
      return 1;
  }
}

Layers layer_of(const Item& item, std::size_t i) {
  switch (item.type) {
    case ItemType::point14:
      return 1U << i;
    case ItemType::rgb14:
      return kColourLayer;
    case ItemType::rgb_nir14:
      return i == 0 ? kColourLayer : kInfraredLayer;
    case ItemType::wave_packet14:
      return kWaveLayer;
    default:
      return kBytesLayers;
  }
}

}  // namespace

LayeredItem::Context::Context(const Item& item, const std::uint8_t* from) : values(from, from + item.size) {
  if (item.type == ItemType::rgb14 || item.type == ItemType::rgb_nir14) colour.emplace();
  if (item.type == ItemType::rgb_nir14) infrared.emplace();
  if (item.type == ItemType::wave_packet14) wave.emplace();
  if (item.type == ItemType::byte14) bytes.emplace(item.size);
}

LayeredItem::LayeredItem(const Item& item, std::vector<LayerStream> streams, const std::uint8_t* first,
                         std::uint32_t channel)
    : item_(item), streams_(std::move(streams)), present_(channel) {
  contexts_[channel] = std::make_unique<Context>(item, first + item.offset);
}

void LayeredItem::decode(Context& context, std::uint8_t* values) {
  if (context.colour && streams_[0].present) context.colour->next(streams_[0].in, values);
  if (context.infrared && streams_[1].present) context.infrared->next(streams_[1].in, values + 6);
  if (context.wave && streams_[0].present) context.wave->next(streams_[0].in, values);
  if (!context.bytes) return;
  for (std::size_t i = 0; i < item_.size; ++i) {
    if (streams_[i].present) context.bytes->next(streams_[i].in, values, i);
  }
}

void LayeredItem::next(const Channel& channel, std::uint8_t* record) {
  // Version 3 uses the point's channel only where it changes and 0 elsewhere; and at a change to a context that exists,
  // it takes the new models but reads and writes the old context's values. Files depend on both.
  const bool old = item_.version < 4;
  const std::uint32_t chosen = old && !channel.changed ? 0 : channel.of_point;
  Context* values = contexts_[present_].get();
  if (chosen != present_) {
    const bool made = !contexts_[chosen];
    if (made) contexts_[chosen] = std::make_unique<Context>(item_, values->values.data());
    if (made || !old) values = contexts_[chosen].get();
    present_ = chosen;
  }
  decode(*contexts_[present_], values->values.data());
  std::memcpy(record + item_.offset, values->values.data(), item_.size);
}

LayeredChunk::LayeredChunk(const Packing& packing, std::string_view bytes, std::size_t place, Layers wanted)
    : packing_(packing), bytes_(bytes), place_(place), wanted_(wanted | kXyLayer) {
  std::size_t layers = 0;
  for (const Item& item : packing.items) layers += layers_of(item);
  const std::size_t head = packing.record_size + 4 + 4 * layers;
  if (bytes.size() < head) throw Damage{"the chunk ends within its first point and the sizes of its layers", place};
  const auto* const p = reinterpret_cast<const std::uint8_t*>(bytes.data()) + packing.record_size;
  points_ = get<std::uint32_t>(p);
  size_ = head;
  for (std::size_t i = 0; i < layers; ++i) {
    const auto size = get<std::uint32_t>(p + 4 + 4 * i);
    if (size > bytes.size() - size_) {
      throw Damage{"a layer of " + std::to_string(size) + " bytes in a chunk with room for " +
                       std::to_string(bytes.size() - size_),
                   place + packing.record_size + 4 + 4 * i};
    }
    sizes_.push_back(size);
    begins_.push_back(size_);
    size_ += size;
  }
  if (points_ > 1 && sizes_.front() == 0) {
    throw Damage{"no bytes for x and y of " + std::to_string(points_) + " points", place + packing.record_size + 4};
  }
}

LayerStream LayeredChunk::stream(std::size_t layer, Layers which) const {
  if (sizes_[layer] == 0 || (wanted_ & which) == 0) return {};
  return {true, Decoder(bytes_.substr(begins_[layer], sizes_[layer]), place_ + begins_[layer])};
}

void LayeredChunk::begin() {
  const auto* const first = reinterpret_cast<const std::uint8_t*>(bytes_.data());
  point_.emplace(first);
  const std::uint32_t channel = first[15] >> 4U & 3U;
  std::size_t layer = 0;
  for (const Item& item : packing_.items) {
    std::vector<LayerStream> streams;
    for (std::size_t i = 0; i < layers_of(item); ++i) streams.push_back(stream(layer++, layer_of(item, i)));
    if (item.type == ItemType::point14) {
      std::move(streams.begin(), streams.end(), point_streams_.begin());
      continue;
    }
    bool wanted = false;
    for (const LayerStream& one : streams) wanted = wanted || one.present;
    if (wanted) items_.emplace_back(item, std::move(streams), first, channel);
  }
}

void LayeredChunk::next(std::uint8_t* record) {
  if (first_) {
    std::memcpy(record, bytes_.data(), packing_.record_size);
    first_ = false;
    return;
  }
  if (!point_) {
    std::memcpy(record, bytes_.data(), packing_.record_size);  // the values of the layers that are not decoded
    begin();
  }
  const Channel channel = point_->next(point_streams_, record);
  for (LayeredItem& item : items_) item.next(channel, record);
}

}  // namespace sparsha::pipeline::laz
