// A chunk of compressors 1 and 2: all items of a point in turn, in one stream.
#pragma once

#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "pipeline/scan/formats/las/laz/colour.h"
#include "pipeline/scan/formats/las/laz/gps_time.h"
#include "pipeline/scan/formats/las/laz/packing.h"
#include "pipeline/scan/formats/las/laz/point10.h"
#include "pipeline/scan/formats/las/laz/wave_packet.h"

namespace sparsha::pipeline::laz {

class PointwiseChunk {
 public:
  /// `bytes` of the chunk, or from its begin to the end of the file; `place` in the file.
  PointwiseChunk(const Packing& packing, std::string_view bytes, std::size_t place);

  /// Writes the next record to `record`, which holds the last one (anything before the first). Throws Damage.
  void next(std::uint8_t* record);

  /// Bytes of the chunk that were read; of all of its points, those of the chunk.
  [[nodiscard]] std::size_t used() const { return packing_.record_size + (stream_ ? stream_->used() : 0); }
  /// Throws Damage when bytes were read that are not there, as a cut file allows for the last points.
  void check_not_cut() const {
    if (stream_ && stream_->past() > 0) stream_->fail("the stream ends before its points do");
  }

 private:
  using Codec =
      std::variant<Point10, Point10First, GpsTime, GpsTimeFirst, Colour, ColourFirst, WavePacket, Bytes, BytesFirst>;
  static Codec codec(const Item& item);
  void begin(std::uint8_t* record);

  const Packing& packing_;
  std::string_view bytes_;
  std::size_t place_;
  bool first_ = true;
  std::optional<Decoder> stream_;
  std::vector<Codec> codecs_;
};

}  // namespace sparsha::pipeline::laz
