#include "pipeline/scan/formats/las/laz/pointwise.h"

namespace sparsha::pipeline::laz {

PointwiseChunk::PointwiseChunk(const Packing& packing, std::string_view bytes, std::size_t place)
    : packing_(packing), bytes_(bytes), place_(place) {
  if (bytes.size() < packing.record_size) throw Damage{"the chunk ends within its first point", place};
}

PointwiseChunk::Codec PointwiseChunk::codec(const Item& item) {
  const bool old = item.version == 1;
  switch (item.type) {
    case ItemType::point10:
      return old ? Codec(Point10First()) : Codec(Point10());
    case ItemType::gps_time11:
      return old ? Codec(GpsTimeFirst()) : Codec(GpsTime(false));
    case ItemType::rgb12:
      return old ? Codec(ColourFirst()) : Codec(Colour());
    case ItemType::wave_packet13:
      return WavePacket();
    default:
      return old ? Codec(BytesFirst(item.size)) : Codec(Bytes(item.size));
  }
}

void PointwiseChunk::begin(std::uint8_t* record) {
  stream_.emplace(bytes_.substr(packing_.record_size), place_ + packing_.record_size);
  for (const Item& item : packing_.items) {
    codecs_.push_back(codec(item));
    if (auto* const point = std::get_if<Point10>(&codecs_.back())) point->start(record + item.offset);
    if (auto* const time = std::get_if<GpsTime>(&codecs_.back())) time->start(record + item.offset);
  }
}

void PointwiseChunk::next(std::uint8_t* record) {
  if (first_) {
    std::memcpy(record, bytes_.data(), packing_.record_size);
    first_ = false;
    return;
  }
  if (!stream_) begin(record);
  for (std::size_t i = 0; i < codecs_.size(); ++i) {
    std::visit([&](auto& codec) { codec.next(*stream_, record + packing_.items[i].offset); }, codecs_[i]);
  }
}

}  // namespace sparsha::pipeline::laz
