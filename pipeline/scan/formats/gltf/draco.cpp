// Khronos glTF, KHR_draco_mesh_compression; the library is Draco's.
#include "pipeline/scan/formats/gltf/draco.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <map>
#include <new>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#ifdef SPARSHA_HAS_DRACO
#include <draco/compression/decode.h>
#include <draco/core/decoder_buffer.h>
#include <draco/mesh/mesh.h>
#endif

namespace sparsha::pipeline::gltf {
namespace {

constexpr const char* kRemedy = "a file without compression: export again, or 'gltf-transform copy'";

/// Null where nothing is compressed, or the same numbers are there without compression.
const Json* extension_of(const Document& document, const Json& primitive, const Place& place) {
  const auto extensions = primitive.find("extensions");
  if (extensions == primitive.end() || !extensions->is_object()) return nullptr;
  const auto found = extensions->find("KHR_draco_mesh_compression");
  if (found == extensions->end() || !found->is_object()) return nullptr;
  const std::uint64_t positions = document.required(primitive.at("attributes"), "POSITION", place);
  return document.item("accessors", positions, place).contains("bufferView") ? nullptr : &*found;
}

}  // namespace

#ifdef SPARSHA_HAS_DRACO
struct DracoMesh::Implementation {
  const Document& document;
  std::unique_ptr<draco::Mesh> mesh;
  std::map<std::string, std::uint64_t> attributes;  ///< their numbers in the compressed mesh
};

namespace {

/// Reads the numbers at the beginning of a stream: Draco would take memory for what it claims.
class Head {
 public:
  explicit Head(std::string_view bytes) : bytes_(bytes) {}

  /// Triangles and vertices; nothing where they do not stand at the beginning (metadata, versions before 2.2).
  std::optional<std::array<std::uint64_t, 2>> counts() {
    constexpr std::size_t kHeader = 11;
    if (bytes_.size() < kHeader + 2 || !bytes_.starts_with("DRACO")) return std::nullopt;
    const bool mesh = bytes_[7] == 1, edges = bytes_[8] == 1, plain = bytes_[9] == 0 && (bytes_[10] & '\x80') == 0;
    if (!mesh || !plain || bytes_[5] != 2 || bytes_[6] < 2) return std::nullopt;
    at_ = kHeader + (edges ? 1 : 0);
    const std::uint64_t first = next(), second = next();
    return edges ? std::array{second, first} : std::array{first, second};
  }

 private:
  std::uint64_t next() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; at_ < bytes_.size() && shift < 63; shift += 7) {
      const auto byte = static_cast<unsigned char>(bytes_[at_++]);
      value |= std::uint64_t{byte & 127U} << shift;
      if (byte < 128) break;
    }
    return value;
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
};

/// What accessors promise is what there may be; and so much must be in the bytes at all.
void refuse_lies(const Document& document, std::string_view bytes, std::uint64_t vertices, std::uint64_t corners,
                 const Place& place) {
  constexpr std::uint64_t kPerByte = 200, kAlways = 1U << 20U;
  const auto counts = Head(bytes).counts();
  if (!counts) throw document.error(place, "a Draco stream of another kind or version", kRemedy);
  const auto [triangles, points] = *counts;
  if (triangles > corners / 3 || points > 3 * std::max(vertices, triangles) ||
      std::max(triangles, vertices) > kPerByte * bytes.size() + kAlways) {
    throw document.error(
        place,
        fmt::format("a Draco stream of {} triangles over {} vertices in {} bytes, while accessors have "
                    "{} and {}",
                    triangles, points, bytes.size(), corners / 3, vertices),
        "a whole file");
  }
}

template <typename T>
bool convert(const draco::Mesh& mesh, const draco::PointAttribute& attribute, std::size_t components,
             std::string& data) {
  std::array<T, 4> value{};
  for (std::uint32_t k = 0; k < mesh.num_points(); ++k) {
    const draco::AttributeValueIndex at = attribute.mapped_index(draco::PointIndex(k));
    if (at.value() >= attribute.size() ||
        !attribute.ConvertValue<T>(at, static_cast<std::int8_t>(components), value.data()))
      return false;
    std::memcpy(data.data() + k * components * sizeof(T), value.data(), components * sizeof(T));
  }
  return true;
}

std::unique_ptr<draco::Mesh> decode(const Document& document, std::string_view bytes, const Place& place) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  try {
    draco::Decoder decoder;
    auto result = decoder.DecodeMeshFromBuffer(&buffer);
    if (result.ok()) return std::move(result).value();
  } catch (const std::bad_alloc&) {
    throw document.error(place, "a Draco stream that claims more memory than there is", "a whole file");
  }
  throw document.error(place, "its bytes are no Draco mesh, or damaged", "a whole file");
}

}  // namespace

std::unique_ptr<const DracoMesh> DracoMesh::of(const Document& document, const Json& primitive, const Place& place) {
  const Json* const extension = extension_of(document, primitive, place);
  if (extension == nullptr) return nullptr;
  const Place here = place + ".KHR_draco_mesh_compression";
  const std::string_view bytes = document.view(document.required(*extension, "bufferView", here), here).bytes;
  const auto count = [&](const Json& object, const char* key) {
    const std::uint64_t accessor = document.required(object, key, here);
    return document.required(document.item("accessors", accessor, here), "count", here);
  };
  refuse_lies(document, bytes, count(primitive.at("attributes"), "POSITION"), count(primitive, "indices"), here);
  auto implementation = std::make_unique<Implementation>(Implementation{document, decode(document, bytes, here), {}});
  const auto attributes = extension->find("attributes");
  if (attributes == extension->end() || !attributes->is_object()) throw document.error(here, "has no 'attributes'");
  for (const auto& [name, id] : attributes->items()) {
    implementation->attributes[name] = document.required(*attributes, name.c_str(), here);
  }
  return std::unique_ptr<const DracoMesh>(new DracoMesh(std::move(implementation)));
}

bool DracoMesh::has(const std::string& attribute) const { return implementation_->attributes.contains(attribute); }

std::shared_ptr<const std::string> DracoMesh::values(const std::string& attribute, ScalarType type,
                                                     std::size_t components, std::uint64_t count,
                                                     const Place& place) const {
  const draco::Mesh& mesh = *implementation_->mesh;
  const std::uint64_t id = implementation_->attributes.at(attribute);
  const draco::PointAttribute* const found = id <= std::numeric_limits<std::uint32_t>::max()
                                                 ? mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id))
                                                 : nullptr;
  const auto wrong = [&](const std::string& what) { return implementation_->document.error(place, what); };
  if (found == nullptr) throw wrong(fmt::format("names attribute {} of a Draco mesh that has none", id));
  if (mesh.num_points() != count)
    throw wrong(fmt::format("{} elements of a Draco mesh of {} vertices", count, mesh.num_points()));
  auto data = std::make_shared<std::string>(static_cast<std::size_t>(count) * components * size_of(type), '\0');
  const auto as = [&](auto zero) { return convert<decltype(zero)>(mesh, *found, components, *data); };
  bool done = false;
  switch (type) {
    case ScalarType::i8:
      done = as(std::int8_t{});
      break;
    case ScalarType::u8:
      done = as(std::uint8_t{});
      break;
    case ScalarType::i16:
      done = as(std::int16_t{});
      break;
    case ScalarType::u16:
      done = as(std::uint16_t{});
      break;
    case ScalarType::u32:
      done = as(std::uint32_t{});
      break;
    default:
      done = as(float{});
  }
  if (!done) throw wrong("its Draco values do not fit its type");
  return data;
}

std::shared_ptr<const std::string> DracoMesh::corners() const {
  const draco::Mesh& mesh = *implementation_->mesh;
  auto data = std::make_shared<std::string>();
  data->reserve(std::size_t{12} * mesh.num_faces());
  for (std::uint32_t k = 0; k < mesh.num_faces(); ++k) {
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(k))) {
      const std::uint32_t number = corner.value();
      data->append(reinterpret_cast<const char*>(&number), sizeof number);
    }
  }
  return data;
}
#else
struct DracoMesh::Implementation {};

std::unique_ptr<const DracoMesh> DracoMesh::of(const Document& document, const Json& primitive, const Place& place) {
  if (extension_of(document, primitive, place) == nullptr) return nullptr;
  throw document.error(place, "is compressed by Draco (KHR_draco_mesh_compression), which was not built in", kRemedy);
}

bool DracoMesh::has(const std::string& /*attribute*/) const { return false; }

std::shared_ptr<const std::string> DracoMesh::values(const std::string& /*attribute*/, ScalarType /*type*/,
                                                     std::size_t /*components*/, std::uint64_t /*count*/,
                                                     const Place& /*place*/) const {
  return nullptr;
}

std::shared_ptr<const std::string> DracoMesh::corners() const { return nullptr; }
#endif

DracoMesh::DracoMesh(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
DracoMesh::~DracoMesh() = default;

}  // namespace sparsha::pipeline::gltf
