// Khronos glTF, KHR_gaussian_splatting: lengths of axes and shares of opacity as they are, without logarithm and logit.
#include "pipeline/scan/formats/gltf/splats.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pipeline/scan/formats/texture/texture.h"

namespace sparsha::pipeline::gltf {

std::optional<Splats> Splats::of(const Document& document, const Json& primitive, std::uint64_t count,
                                 const Place& place) {
  const Json& attributes = primitive.at("attributes");
  const auto accessor = [&](const char* name, std::size_t components) -> std::optional<Accessor> {
    const std::string key = std::string("KHR_gaussian_splatting:") + name;
    const std::optional<std::uint64_t> index = document.whole(attributes, key.c_str(), place + ".attributes");
    if (!index) return std::nullopt;
    Accessor found(document, *index, place + "." + key);
    if (found.size() != count || found.components() != components) {
      throw document.error(found.place(), fmt::format("{} elements of {} numbers", found.size(), found.components()),
                           fmt::format("{} of {}", count, components));
    }
    return found;
  };
  std::optional<Accessor> opacities = accessor("OPACITY", 1), axes = accessor("SCALE", 3),
                          terms = accessor("SH_DEGREE_0_COEF_0", 3);
  if (!opacities || !axes || !terms) return std::nullopt;
  const Json::json_pointer space("/extensions/KHR_gaussian_splatting/colorSpace");
  const bool light = primitive.contains(space) && primitive[space].is_string() &&
                     primitive[space].get<std::string>().starts_with("lin_");
  return Splats(std::move(*opacities), std::move(*axes), std::move(*terms), light);
}

Splats::Splats(Accessor opacities, Accessor axes, Accessor terms, bool light)
    : opacities_(std::move(opacities)), axes_(std::move(axes)), terms_(std::move(terms)), light_(light) {
  const std::uint64_t every = std::max<std::uint64_t>(1, opacities_.size() / SplatSieve::kSample);
  for (std::uint64_t n = 0; n < opacities_.size(); n += every) sieve_.look_at(opacity(n), longest(n));
  sieve_.decide();
}

double Splats::longest(std::uint64_t n) const {
  const std::array<double, 4> axes = axes_(n);
  return std::max({axes[0], axes[1], axes[2]});
}

std::uint32_t Splats::colour(std::uint64_t n) const {
  const std::array<double, 4> terms = terms_(n);
  if (light_) return colour_of({colour_of_splat(terms[0]), colour_of_splat(terms[1]), colour_of_splat(terms[2]), 1.0});
  const auto byte = [&](std::size_t k) { return colour_byte(colour_of_splat(terms[k]), ColourScale::unit); };
  return pack_rgba(byte(0), byte(1), byte(2));
}

}  // namespace sparsha::pipeline::gltf
