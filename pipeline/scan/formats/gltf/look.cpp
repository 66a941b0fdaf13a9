// Sections 3.8 (textures) and 3.9 (materials) of the specification, and KHR_texture_transform.
#include "pipeline/scan/formats/gltf/look.hpp"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace sparsha::pipeline::gltf {
namespace {

/// A member that is an object; null without.
const Json* object_in(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_object() ? &*found : nullptr;
}

const Json* extension(const Json& object, const char* name) {
  const Json* const extensions = object_in(object, "extensions");
  return extensions != nullptr ? object_in(*extensions, name) : nullptr;
}

/// A list of exactly so many numbers; nothing else is one.
template <std::size_t n>
std::optional<std::array<double, n>> numbers_in(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->size() != n) return std::nullopt;
  std::array<double, n> numbers{};
  for (std::size_t k = 0; k < n; ++k) {
    if (!(*found)[k].is_number()) return std::nullopt;
    numbers[k] = (*found)[k].template get<double>();
  }
  return numbers;
}

Wrap wrap_of(const Document& document, const Json& sampler, const char* key, const Place& place) {
  switch (document.whole(sampler, key, 10497, place)) {
    case 33071:
      return Wrap::clamp;
    case 33648:
      return Wrap::mirror;
    default:
      return Wrap::repeat;
  }
}

/// Offset, then rotation about the origin (counter-clockwise as the picture is seen, with v downwards), then scale.
void turn(const Json& transform, Look& look) {
  const std::array<double, 2> offset = numbers_in<2>(transform, "offset").value_or(std::array<double, 2>{0, 0});
  const std::array<double, 2> scale = numbers_in<2>(transform, "scale").value_or(std::array<double, 2>{1, 1});
  const auto rotation = transform.find("rotation");
  const double angle = rotation != transform.end() && rotation->is_number() ? rotation->get<double>() : 0.0;
  const double c = std::cos(angle), s = std::sin(angle);
  look.turned = {c * scale[0], s * scale[1], offset[0], -s * scale[0], c * scale[1], offset[1]};
}

/// The number of the picture; of those that a texture offers, one that everybody reads.
std::optional<std::uint64_t> image_of(const Document& document, const Json& texture, const Place& place) {
  if (const std::optional<std::uint64_t> source = document.whole(texture, "source", place)) return source;
  for (const char* name : {"EXT_texture_webp", "KHR_texture_basisu"}) {
    if (const Json* const other = extension(texture, name)) return document.whole(*other, "source", place);
  }
  return std::nullopt;
}

void lay(const Document& document, const Json& info, const Place& place, Look& look) {
  const std::uint64_t number = document.required(info, "index", place);
  const Json& texture = document.item("textures", number, place);
  const Place here = fmt::format("textures[{}]", number);
  look.image = image_of(document, texture, here);
  look.coordinates = document.whole(info, "texCoord", 0, place);
  if (const std::optional<std::uint64_t> sampler = document.whole(texture, "sampler", here)) {
    const Json& wraps = document.item("samplers", *sampler, here);
    const Place at = fmt::format("samplers[{}]", *sampler);
    look.along_u = wrap_of(document, wraps, "wrapS", at);
    look.along_v = wrap_of(document, wraps, "wrapT", at);
  }
  if (const Json* const transform = extension(info, "KHR_texture_transform")) {
    turn(*transform, look);
    look.coordinates = document.whole(*transform, "texCoord", look.coordinates, place);
  }
}

std::string message_of(const Document& document, const Error& error) {
  // A place of the document's own is this scan's file.
  const std::string& file = error.place().file;
  return file.empty() || file == document.file().name ? error.wrong() : file + ": " + error.wrong();
}

}  // namespace

Light Look::light(const ColourPicture& picture, double u, double v) const {
  Light found = sample(picture, turned[0] * u + turned[1] * v + turned[2], turned[3] * u + turned[4] * v + turned[5],
                       along_u, along_v);
  if (opaque) found[3] = 1.0;
  return found;
}

Look look_of(const Document& document, const Json& primitive, const Place& place) {
  Look look;
  const std::optional<std::uint64_t> index = document.whole(primitive, "material", place);
  if (!index) return look;
  const Json& material = document.item("materials", *index, place);
  const Json* paint = object_in(material, "pbrMetallicRoughness");
  const Json* const glossy = extension(material, "KHR_materials_pbrSpecularGlossiness");
  const bool plain = paint == nullptr || (!paint->contains("baseColorTexture") && !paint->contains("baseColorFactor"));
  const bool of_gloss = plain && glossy != nullptr;
  if (of_gloss) paint = glossy;
  if (paint == nullptr) return look;
  look.factor = numbers_in<4>(*paint, of_gloss ? "diffuseFactor" : "baseColorFactor");
  const auto mode = material.find("alphaMode");
  look.opaque = mode == material.end() || !mode->is_string() || mode->get<std::string>() == "OPAQUE";
  const char* const key = of_gloss ? "diffuseTexture" : "baseColorTexture";
  if (const Json* const info = object_in(*paint, key)) {
    try {
      lay(document, *info, fmt::format("materials[{}].{}", *index, key), look);
    } catch (const Error& error) {
      look = {};
      look.why = message_of(document, error);
    }
  }
  return look;
}

std::shared_ptr<const ColourPicture> Pictures::find(std::uint64_t image) {
  constexpr std::size_t kMostPixels = std::size_t{1} << 28U;
  const auto known = pictures_.find(image);
  if (known != pictures_.end()) return known->second;
  if (why_.contains(image)) return nullptr;
  try {
    const Place place = fmt::format("images[{}]", image);
    auto picture = std::make_shared<const ColourPicture>(decode_picture(document_.picture(image), place));
    std::size_t pixels = picture->rgba.size();
    for (const auto& [number, other] : pictures_) pixels += other->rgba.size();
    if (pixels > kMostPixels) pictures_.clear();
    return pictures_[image] = std::move(picture);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    why_[image] = message_of(document_, error);
    return nullptr;
  }
}

}  // namespace sparsha::pipeline::gltf
