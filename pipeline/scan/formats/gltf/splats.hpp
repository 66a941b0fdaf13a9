// Gaussian splats in glTF: points of a primitive with KHR_gaussian_splatting.
#pragma once

#include <cstdint>
#include <optional>

#include "pipeline/scan/formats/gltf/accessor.hpp"
#include "pipeline/scan/formats/splat/splats.h"

namespace sparsha::pipeline::gltf {

class Splats {
 public:
  /// Of a primitive whose attributes have opacities, axes and the constant term of colour; nothing without. Throws
  /// Error{input} where these are not one for each of `count` points.
  [[nodiscard]] static std::optional<Splats> of(const Document& document, const Json& primitive, std::uint64_t count,
                                                const Place& place);

  /// False for a splat that is no surface; counts.
  [[nodiscard]] bool keeps(std::uint64_t n) { return sieve_.keeps(opacity(n), longest(n)); }
  /// 0 to 1.
  [[nodiscard]] double opacity(std::uint64_t n) const { return opacities_(n)[0]; }
  /// 0xAABBGGRR.
  [[nodiscard]] std::uint32_t colour(std::uint64_t n) const;
  void warn(RawScan& scan) const { sieve_.warn(scan); }

 private:
  Splats(Accessor opacities, Accessor axes, Accessor terms, bool light);
  [[nodiscard]] double longest(std::uint64_t n) const;

  Accessor opacities_, axes_, terms_;
  bool light_;  ///< colours are linear light, not sRGB
  SplatSieve sieve_;
};

}  // namespace sparsha::pipeline::gltf
