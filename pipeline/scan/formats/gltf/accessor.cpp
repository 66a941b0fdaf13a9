// Section 3.6.2 of the specification.
#include "pipeline/scan/formats/gltf/accessor.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pipeline/scan/formats/gltf/draco.hpp"

namespace sparsha::pipeline::gltf {
namespace {

ScalarType component_type(const Document& document, std::uint64_t code, const Place& place) {
  switch (code) {
    case 5120:
      return ScalarType::i8;
    case 5121:
      return ScalarType::u8;
    case 5122:
      return ScalarType::i16;
    case 5123:
      return ScalarType::u16;
    case 5125:
      return ScalarType::u32;
    case 5126:
      return ScalarType::f32;
    default:
      throw document.error(place, fmt::format("componentType {}", code), "5120 to 5123, 5125 or 5126");
  }
}

double largest_of(ScalarType type) {
  switch (type) {
    case ScalarType::i8:
      return std::numeric_limits<std::int8_t>::max();
    case ScalarType::u8:
      return std::numeric_limits<std::uint8_t>::max();
    case ScalarType::i16:
      return std::numeric_limits<std::int16_t>::max();
    case ScalarType::u16:
      return std::numeric_limits<std::uint16_t>::max();
    default:
      return 1.0;
  }
}

/// The part of a view with `count` elements of `size` bytes.
std::string_view part_of(const Document& document, const Document::View& view, std::uint64_t offset,
                         std::uint64_t count, std::uint64_t size, std::uint64_t stride, const Place& place) {
  const std::uint64_t bytes = view.bytes.size();
  const bool inside =
      offset <= bytes && (count == 0 || (size <= bytes - offset && (count - 1) <= (bytes - offset - size) / stride));
  if (!inside) {
    throw document.error(
        place,
        fmt::format("{} elements of {} bytes from byte {} do not fit into the {} bytes of their buffer view", count,
                    size, offset, bytes),
        "a count that fits; the file may be cut short");
  }
  return view.bytes.substr(static_cast<std::size_t>(offset));
}

}  // namespace

const Json& Accessor::read_form(const Document& document, std::uint64_t index, const Place& asked_by) {
  const Json& object = document.item("accessors", index, asked_by);
  count_ = document.required(object, "count", place_);
  type_ = component_type(document, document.required(object, "componentType", place_), place_);
  const auto shape = object.find("type");
  const std::string name = shape != object.end() && shape->is_string() ? shape->get<std::string>() : "";
  if (name == "SCALAR") {
    components_ = 1;
  } else if (name.size() == 4 && name.starts_with("VEC") && name[3] >= '2' && name[3] <= '4') {
    components_ = static_cast<std::size_t>(name[3] - '0');
  } else {
    throw document.error(place_, "type '" + name + "'", "SCALAR, VEC2, VEC3 or VEC4");
  }
  const auto normalised = object.find("normalized");
  normalised_ = normalised != object.end() && normalised->is_boolean() && normalised->get<bool>();
  stride_ = components_ * sparsha::pipeline::size_of(type_);
  return object;
}

Accessor::Accessor(const Document& document, std::uint64_t index, const Place& asked_by, const DracoMesh& mesh,
                   const std::string& attribute)
    : place_(fmt::format("accessors[{}]", index)) {
  (void)read_form(document, index, asked_by);
  if (attribute.empty()) {
    unpacked_ = mesh.corners();
    type_ = ScalarType::u32;
    components_ = 1;
    stride_ = sparsha::pipeline::size_of(type_);
    count_ = unpacked_->size() / stride_;
  } else {
    unpacked_ = mesh.values(attribute, type_, components_, count_, place_);
  }
  bytes_ = *unpacked_;
}

Accessor::Accessor(const Document& document, std::uint64_t index, const Place& asked_by, FormOnly)
    : place_(fmt::format("accessors[{}]", index)) {
  (void)read_form(document, index, asked_by);
}

Accessor::Accessor(const Document& document, std::uint64_t index, const Place& asked_by)
    : place_(fmt::format("accessors[{}]", index)) {
  const Json& object = read_form(document, index, asked_by);
  const std::uint64_t size = stride_;
  const std::optional<std::uint64_t> view_index = document.whole(object, "bufferView", place_);
  if (view_index) {
    const Document::View view = document.view(*view_index, place_);
    if (view.stride > 0 && view.stride < size) {
      throw document.error(
          place_,
          fmt::format("its elements of {} bytes overlap: its buffer view has a byteStride of {}", size, view.stride),
          fmt::format("a byteStride of {} or more, or none", size));
    }
    if (view.stride > 0) stride_ = view.stride;
    bytes_ = part_of(document, view, document.whole(object, "byteOffset", 0, place_), count_, size, stride_, place_);
  }
  const auto sparse = object.find("sparse");
  if (sparse != object.end()) {
    if (!sparse->is_object()) throw document.error(place_, "'sparse' is no object");
    read_sparse(document, *sparse);
  }
  // Zeros alone are allowed, but nobody's scan, and their number could be anything.
  if (!view_index && count_ > document.file().bytes.size()) {
    throw document.error(place_, fmt::format("{} elements without bytes", count_), "a buffer view");
  }
}

void Accessor::read_sparse(const Document& document, const Json& sparse) {
  const Place place = place_ + ".sparse";
  const std::uint64_t count = document.required(sparse, "count", place);
  if (!sparse.contains("indices") || !sparse["indices"].is_object() || !sparse.contains("values") ||
      !sparse["values"].is_object()) {
    throw document.error(place, "has no 'indices' or no 'values'");
  }
  const Json& indices = sparse["indices"];
  const Json& values = sparse["values"];
  const ScalarType type = component_type(document, document.required(indices, "componentType", place), place);
  if (type != ScalarType::u8 && type != ScalarType::u16 && type != ScalarType::u32)
    throw document.error(place, "indices that are no unsigned numbers", "componentType 5121, 5123 or 5125");
  const std::uint64_t index_size = sparsha::pipeline::size_of(type);
  const std::uint64_t size = components_ * sparsha::pipeline::size_of(type_);
  const std::string_view at =
      part_of(document, document.view(document.required(indices, "bufferView", place), place),
              document.whole(indices, "byteOffset", 0, place), count, index_size, index_size, place);
  const std::string_view of = part_of(document, document.view(document.required(values, "bufferView", place), place),
                                      document.whole(values, "byteOffset", 0, place), count, size, size, place);
  sparse_.reserve(static_cast<std::size_t>(count));
  for (std::uint64_t k = 0; k < count; ++k) {
    const auto n = static_cast<std::uint64_t>(load_scalar(at.data() + k * index_size, type));
    if (n >= count_) throw document.error(place, fmt::format("element {} of {}", n, count_), "indices below the count");
    if (!sparse_.empty() && n <= sparse_.back().first)
      throw document.error(place, fmt::format("index {} after {}", n, sparse_.back().first), "ascending indices");
    sparse_.emplace_back(n, of.data() + k * size);
  }
}

const char* Accessor::element(std::uint64_t n) const {
  if (!sparse_.empty()) {
    const auto found =
        std::lower_bound(sparse_.begin(), sparse_.end(), n, [](const auto& s, std::uint64_t k) { return s.first < k; });
    if (found != sparse_.end() && found->first == n) return found->second;
  }
  return bytes_.empty() ? nullptr : bytes_.data() + n * stride_;
}

std::array<double, 4> Accessor::operator()(std::uint64_t n) const {
  std::array<double, 4> values{};
  const char* const from = element(n);
  if (from == nullptr) return values;
  const double scale = normalised_ ? 1.0 / largest_of(type_) : 1.0;
  for (std::size_t k = 0; k < components_; ++k) {
    const double value = load_scalar(from + k * sparsha::pipeline::size_of(type_), type_) * scale;
    values[k] = normalised_ ? std::max(value, -1.0) : value;  // -128 is -1 too
  }
  return values;
}

std::uint32_t Accessor::index(std::uint64_t n) const {
  const char* const from = element(n);
  return from == nullptr ? 0 : static_cast<std::uint32_t>(load_scalar(from, type_));
}

}  // namespace sparsha::pipeline::gltf
