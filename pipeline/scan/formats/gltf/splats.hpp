// Gaussian splats in glTF: points of a primitive with KHR_gaussian_splatting, as they are or compressed as SPZ.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>

#include "pipeline/scan/formats/gltf/accessor.hpp"
#include "pipeline/scan/formats/splat/splats.h"
#include "pipeline/scan/formats/splat/spz.h"

namespace sparsha::pipeline::gltf {

class Splats {
 public:
  /// Of a primitive whose attributes have opacities, axes and the constant term of colour, or that has an SPZ stream;
  /// nothing without. Throws Error{input} where these are not one for each of `count` points, or are damaged.
  [[nodiscard]] static std::optional<Splats> of(const Document& document, const Json& primitive, std::uint64_t count,
                                                const Place& place);
  /// Whether the primitive's numbers are those of an SPZ stream, whatever its accessors have.
  [[nodiscard]] static bool are_packed(const Json& primitive);

  /// False for a splat that is no surface; counts.
  [[nodiscard]] bool keeps(std::uint64_t n) { return sieve_.keeps(opacity(n), longest(n)); }
  /// 0 to 1.
  [[nodiscard]] double opacity(std::uint64_t n) const;
  /// 0xAABBGGRR.
  [[nodiscard]] std::uint32_t colour(std::uint64_t n) const;
  /// The centre in the primitive's frame, where the stream has it.
  [[nodiscard]] std::optional<std::array<double, 3>> centre(std::uint64_t n) const;
  void warn(RawScan& scan) const { sieve_.warn(scan); }

 private:
  /// Numbers of accessors.
  struct Plain {
    Accessor opacities, axes, terms;
    bool light;  ///< colours are linear light, not sRGB
  };
  using Packed = std::shared_ptr<const SpzSplats>;

  Splats(std::variant<Plain, Packed> numbers, std::uint64_t count);
  [[nodiscard]] double longest(std::uint64_t n) const;

  std::variant<Plain, Packed> numbers_;
  SplatSieve sieve_;
};

}  // namespace sparsha::pipeline::gltf
