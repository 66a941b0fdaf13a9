// Item POINT14: the 30 bytes that begin the points of formats 6 to 10, in nine streams.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "pipeline/scan/formats/las/laz/gps_time.h"
#include "pipeline/scan/formats/las/laz/layers.h"

namespace sparsha::pipeline::laz {

inline constexpr std::size_t kPoint14Size = 30;

/// Which of the four contexts further items of a point use (one for each scanner channel).
struct Channel {
  std::uint32_t of_point = 0;
  bool changed = false;  ///< at this point
};

class Point14 {
 public:
  /// `first`: the chunk's first record.
  explicit Point14(const std::uint8_t* first);

  /// Writes the next point to `item`. `streams`: kPoint14Layers of them.
  Channel next(std::array<LayerStream, kPoint14Layers>& streams, std::uint8_t* item);

 private:
  struct Context {
    Context(const std::uint8_t* last);

    std::array<std::uint8_t, kPoint14Size> point{};
    bool time_changed = false;
    std::vector<SymbolModel> changed = models(8, 128), returns = models(16, 16), number = models(16, 16);
    std::vector<SymbolModel> class_of = models(64, 256), flags = models(64, 64), user = models(64, 256);
    SymbolModel channel{3}, number_same_time{13};
    IntegerModel dx{32, 2}, dy{32, 22}, z{32, 20}, intensity{16, 4}, angle{16, 2}, source{16, 1};
    std::array<RunningMedian, 12> median_x, median_y;
    std::array<std::int32_t, 8> last_z{};
    std::array<std::uint16_t, 8> last_intensity{};
    GpsTime time{true};
  };

  static std::uint32_t next_return(Decoder& in, Context& context, std::uint32_t kind, bool time_changed,
                                   std::uint32_t last);
  static void next_rest(std::array<LayerStream, kPoint14Layers>& streams, Context& context, std::uint32_t changed,
                        std::uint32_t place);

  std::array<std::unique_ptr<Context>, 4> contexts_;
  std::uint32_t present_ = 0;
};

}  // namespace sparsha::pipeline::laz
