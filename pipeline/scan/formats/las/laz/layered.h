// A chunk of compressor 3: a stream for each property of the points.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "pipeline/scan/formats/las/laz/colour.h"
#include "pipeline/scan/formats/las/laz/packing.h"
#include "pipeline/scan/formats/las/laz/point14.h"
#include "pipeline/scan/formats/las/laz/wave_packet.h"

namespace sparsha::pipeline::laz {

/// An item behind POINT14. Its contexts, one for each scanner channel, are chosen as the item's version has it.
class LayeredItem {
 public:
  LayeredItem(const Item& item, std::vector<LayerStream> streams, const std::uint8_t* first, std::uint32_t channel);

  void next(const Channel& channel, std::uint8_t* record);

 private:
  struct Context {
    Context(const Item& item, const std::uint8_t* values);

    std::vector<std::uint8_t> values;
    std::optional<Colour> colour;
    std::optional<NearInfrared> infrared;
    std::optional<WavePacket> wave;
    std::optional<Bytes> bytes;
  };
  void decode(Context& context, std::uint8_t* values);

  Item item_;
  std::vector<LayerStream> streams_;
  std::array<std::unique_ptr<Context>, 4> contexts_;
  std::uint32_t present_;
};

class LayeredChunk {
 public:
  /// `bytes` of the chunk, or from its begin to the end of the file; `place` in the file. Throws Damage when they hold
  /// no such chunk.
  LayeredChunk(const Packing& packing, std::string_view bytes, std::size_t place, Layers wanted);

  /// Of points, as the chunk itself has it.
  [[nodiscard]] std::uint32_t points() const { return points_; }
  /// Bytes of the chunk, as its layers' sizes add up.
  [[nodiscard]] std::size_t size() const { return size_; }

  /// Writes the next record to `record`. Throws Damage.
  void next(std::uint8_t* record);

 private:
  void begin();
  [[nodiscard]] LayerStream stream(std::size_t layer, Layers which) const;

  const Packing& packing_;
  std::string_view bytes_;
  std::size_t place_;
  Layers wanted_;
  std::uint32_t points_ = 0;
  std::size_t size_ = 0;
  std::vector<std::uint32_t> sizes_;  ///< of the layers
  std::vector<std::size_t> begins_;   ///< of the layers, within the chunk
  bool first_ = true;
  std::optional<Point14> point_;
  std::array<LayerStream, kPoint14Layers> point_streams_;
  std::vector<LayeredItem> items_;
};

}  // namespace sparsha::pipeline::laz
