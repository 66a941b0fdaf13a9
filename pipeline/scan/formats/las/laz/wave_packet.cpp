#include "pipeline/scan/formats/las/laz/wave_packet.h"

namespace sparsha::pipeline::laz {

void WavePacket::next(Decoder& in, std::uint8_t* item) {
  constexpr std::size_t kPlace = 1, kSize = 9, kPoint = 13, kDirection = 17;
  item[0] = low_byte(in.symbol(index_));
  last_kind_ = in.symbol(kind_[last_kind_]);
  auto place = get<std::uint64_t>(item + kPlace);
  if (last_kind_ == 1) {
    place += get<std::uint32_t>(item + kSize);
  } else if (last_kind_ == 2) {
    last_step_ = step_.get(in, last_step_);
    place += static_cast<std::uint64_t>(std::int64_t{last_step_});
  } else if (last_kind_ == 3) {
    place = in.raw64();
  }
  put(item + kPlace, place);
  put(item + kSize, size_.get(in, get<std::int32_t>(item + kSize)));
  put(item + kPoint, point_.get(in, get<std::int32_t>(item + kPoint)));
  for (std::uint32_t k = 0; k < 3; ++k) {
    std::uint8_t* const at = item + kDirection + 4 * k;
    put(at, direction_.get(in, get<std::int32_t>(at), k));
  }
}

}  // namespace sparsha::pipeline::laz
