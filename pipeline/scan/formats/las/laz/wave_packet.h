// Items WAVEPACKET13 and WAVEPACKET14: where a point's waveform is.
#pragma once

#include <vector>

#include "pipeline/scan/formats/las/laz/fields.h"
#include "pipeline/scan/formats/las/laz/integers.h"

namespace sparsha::pipeline::laz {

class WavePacket {
 public:
  void next(Decoder& in, std::uint8_t* item);

 private:
  SymbolModel index_{256};
  std::vector<SymbolModel> kind_ = models(4, 4);  ///< of the step between places, by the last kind
  IntegerModel step_{32, 1}, size_{32, 1}, point_{32, 1}, direction_{32, 3};
  std::uint32_t last_kind_ = 0;
  std::int32_t last_step_ = 0;
};

}  // namespace sparsha::pipeline::laz
