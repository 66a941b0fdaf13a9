// Khronos glTF, EXT_meshopt_compression; the library is meshoptimizer's.
#include "pipeline/scan/formats/gltf/meshopt.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#ifdef SPARSHA_HAS_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace sparsha::pipeline::gltf {

const Json* meshopt_of(const Json& view) {
  const auto extensions = view.find("extensions");
  if (extensions == view.end() || !extensions->is_object()) return nullptr;
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    const auto found = extensions->find(name);
    if (found != extensions->end() && found->is_object()) return &*found;
  }
  return nullptr;
}

#ifdef SPARSHA_HAS_MESHOPTIMIZER
namespace {

std::string word(const Json& object, const char* key, const char* otherwise) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : otherwise;
}

/// Filters work in place; false for one that does not fit the stride.
bool filter(std::string& data, std::size_t count, std::size_t stride, const std::string& name) {
  if (name == "NONE") return true;
  if (name == "OCTAHEDRAL" && (stride == 4 || stride == 8)) {
    meshopt_decodeFilterOct(data.data(), count, stride);
  } else if (name == "QUATERNION" && stride == 8) {
    meshopt_decodeFilterQuat(data.data(), count, stride);
  } else if (name == "EXPONENTIAL" && stride % 4 == 0) {
    meshopt_decodeFilterExp(data.data(), count, stride);
  } else {
    return false;
  }
  return true;
}

}  // namespace

std::string unpack_meshopt(const Document& document, const Json& extension, std::string_view bytes, std::uint64_t most,
                           const Place& place) {
  constexpr std::uint64_t kPerByte = 64;  // 256 times the same byte are four bytes
  constexpr std::uint64_t kMostStride = 256;
  const std::uint64_t count = document.required(extension, "count", place);
  const std::uint64_t stride = document.required(extension, "byteStride", place);
  const std::string mode = word(extension, "mode", "");
  const bool vertices = mode == "ATTRIBUTES", triangles = mode == "TRIANGLES", indices = mode == "INDICES";
  const bool fits = vertices ? stride > 0 && stride % 4 == 0 && stride <= kMostStride : stride == 2 || stride == 4;
  if (!(vertices || triangles || indices) || !fits || (triangles && count % 3 != 0)) {
    throw document.error(place, fmt::format("meshopt mode '{}', {} elements of {} bytes", mode, count, stride),
                         "ATTRIBUTES of 4 to 256 bytes, TRIANGLES or INDICES of 2 or 4");
  }
  if (count / kPerByte > bytes.size() || count * stride > kPerByte * bytes.size() + kMostStride * kMostStride ||
      count * stride > most) {
    throw document.error(place, fmt::format("{} elements of {} bytes from {} bytes", count, stride, bytes.size()),
                         "no more than these can hold");
  }
  std::string data(static_cast<std::size_t>(count * stride), '\0');
  const auto* const from = reinterpret_cast<const unsigned char*>(bytes.data());
  const auto size = static_cast<std::size_t>(count), width = static_cast<std::size_t>(stride);
  int failed = 0;
  if (size > 0) {
    failed = vertices    ? meshopt_decodeVertexBuffer(data.data(), size, width, from, bytes.size())
             : triangles ? meshopt_decodeIndexBuffer(data.data(), size, width, from, bytes.size())
                         : meshopt_decodeIndexSequence(data.data(), size, width, from, bytes.size());
  }
  if (failed != 0) throw document.error(place, "its bytes are no meshopt stream, or damaged", "a whole file");
  const std::string name = word(extension, "filter", "NONE");
  if (vertices && !filter(data, size, width, name))
    throw document.error(place, "meshopt filter '" + name + "'", "OCTAHEDRAL, QUATERNION or EXPONENTIAL that fits");
  return data;
}
#else
std::string unpack_meshopt(const Document& document, const Json& /*extension*/, std::string_view /*bytes*/,
                           std::uint64_t /*most*/, const Place& place) {
  throw document.error(place, "is compressed by meshoptimizer (EXT_meshopt_compression), which was not built in",
                       "a file without compression: 'gltfpack' without -c, or export again");
}
#endif

}  // namespace sparsha::pipeline::gltf
