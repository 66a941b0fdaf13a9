// Khronos glTF, KHR_gaussian_splatting: lengths of axes and shares of opacity as they are, without logarithm and logit;
// KHR_gaussian_splatting_compression_spz_2: all of them in an SPZ stream.
#include "pipeline/scan/formats/gltf/splats.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pipeline/scan/formats/texture/texture.h"

namespace sparsha::pipeline::gltf {
namespace {

/// The extension's drafts.
constexpr std::array<const char*, 3> kSpz{"KHR_gaussian_splatting_compression_spz_2",
                                          "KHR_gaussian_splatting_compression_spz",
                                          "KHR_spz_gaussian_splats_compression"};

/// The object that names the SPZ stream, within the splats' extension or beside it.
const Json* spz_of(const Json& primitive) {
  for (const char* const name : kSpz) {
    for (const char* const parent : {"/extensions/KHR_gaussian_splatting/extensions/", "/extensions/"}) {
      const Json::json_pointer path(std::string(parent) + name);
      if (primitive.contains(path)) return &primitive[path];
    }
  }
  return nullptr;
}

SpzSplats unpack(const Document& document, const Json& primitive, const Json& spz, std::uint64_t count,
                 const Place& place) {
  const Place here = place + ".SPZ";
  if (!spz.is_object()) throw document.error(here, "no object", "{\"bufferView\": ...}");
  if (document.whole(primitive, "mode", 4, place) != 0) {
    throw document.error(place, "Gaussian splats that are no points", "mode 0");
  }
  ScanFile stream = document.file();
  stream.name += ": " + here;
  stream.map = nullptr;
  stream.bytes = document.view(document.required(spz, "bufferView", here), here).bytes;
  SpzSplats splats(stream);
  if (splats.size() != count) {
    throw document.error(here, fmt::format("{} splats", splats.size()),
                         fmt::format("{}, as there are positions", count));
  }
  return splats;
}

}  // namespace

bool Splats::are_packed(const Json& primitive) { return spz_of(primitive) != nullptr; }

std::optional<Splats> Splats::of(const Document& document, const Json& primitive, std::uint64_t count,
                                 const Place& place) {
  if (const Json* const spz = spz_of(primitive)) {
    return Splats(std::make_shared<const SpzSplats>(unpack(document, primitive, *spz, count, place)), count);
  }
  if (document.whole(primitive, "mode", 4, place) != 0) return std::nullopt;
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
  return Splats(Plain{std::move(*opacities), std::move(*axes), std::move(*terms), light}, count);
}

Splats::Splats(std::variant<Plain, Packed> numbers, std::uint64_t count) : numbers_(std::move(numbers)) {
  const std::uint64_t every = std::max<std::uint64_t>(1, count / SplatSieve::kSample);
  for (std::uint64_t n = 0; n < count; n += every) sieve_.look_at(opacity(n), longest(n));
  sieve_.decide();
}

double Splats::opacity(std::uint64_t n) const {
  if (const auto* const packed = std::get_if<Packed>(&numbers_)) return (*packed)->opacity(n);
  return std::get<Plain>(numbers_).opacities(n)[0];
}

double Splats::longest(std::uint64_t n) const {
  if (const auto* const packed = std::get_if<Packed>(&numbers_)) return (*packed)->longest(n);
  const std::array<double, 4> axes = std::get<Plain>(numbers_).axes(n);
  return longer_axis(axes[0], longer_axis(axes[1], axes[2]));
}

std::optional<std::array<double, 3>> Splats::centre(std::uint64_t n) const {
  const auto* const packed = std::get_if<Packed>(&numbers_);
  if (packed == nullptr) return std::nullopt;
  // glTF's frame is left, up, front.
  return std::array{-(*packed)->coordinate(n, 0), (*packed)->coordinate(n, 1), -(*packed)->coordinate(n, 2)};
}

std::uint32_t Splats::colour(std::uint64_t n) const {
  if (const auto* const packed = std::get_if<Packed>(&numbers_)) return (*packed)->colour(n);
  const Plain& plain = std::get<Plain>(numbers_);
  const std::array<double, 4> terms = plain.terms(n);
  if (plain.light)
    return colour_of({colour_of_splat(terms[0]), colour_of_splat(terms[1]), colour_of_splat(terms[2]), 1.0});
  const auto byte = [&](std::size_t k) { return colour_byte(colour_of_splat(terms[k]), ColourScale::unit); };
  return pack_rgba(byte(0), byte(1), byte(2));
}

}  // namespace sparsha::pipeline::gltf
