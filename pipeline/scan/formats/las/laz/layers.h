// The streams of a chunk of compressor 3: one for each property of points, so that only the wanted ones are decoded.
#pragma once

#include <cstdint>

#include "pipeline/scan/formats/las/laz/arithmetic.h"

namespace sparsha::pipeline::laz {

/// Sets of layers, to choose what is decoded; the others keep the value of a chunk's first point.
using Layers = std::uint32_t;
inline constexpr std::size_t kPoint14Layers = 9;
inline constexpr Layers kXyLayer = 1, kZLayer = 2, kClassLayer = 4, kFlagsLayer = 8, kIntensityLayer = 16,
                        kAngleLayer = 32, kUserLayer = 64, kSourceLayer = 128, kTimeLayer = 256, kColourLayer = 512,
                        kInfraredLayer = 1024, kWaveLayer = 2048, kBytesLayers = 4096, kAllLayers = 8191;

/// A layer's stream; none when the layer has no bytes or is not wanted: the last value stays.
struct LayerStream {
  bool present = false;
  Decoder in;
};

}  // namespace sparsha::pipeline::laz
