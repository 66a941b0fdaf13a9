// Khronos glTF 2.0 specification (ISO/IEC 12113), sections 3.6 (buffers) and 4 (GLB).
#include "pipeline/scan/formats/gltf/document.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/text/base64.h"
#include "pipeline/scan/formats/gltf/meshopt.hpp"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline::gltf {
namespace {

constexpr std::size_t kMostJson = std::size_t{256} << 20U;  // bytes: as a tree it takes many times that
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinaryChunk = 0x004E4942;

int hex(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// "a%20b" is "a b".
std::string without_percents(std::string_view uri) {
  std::string text;
  for (std::size_t k = 0; k < uri.size(); ++k) {
    const bool coded = uri[k] == '%' && k + 2 < uri.size() && hex(uri[k + 1]) >= 0 && hex(uri[k + 2]) >= 0;
    text += coded ? static_cast<char>(16 * hex(uri[k + 1]) + hex(uri[k + 2])) : uri[k];
    if (coded) k += 2;
  }
  return text;
}

}  // namespace

bool is_binary(std::string_view bytes) {
  return bytes.size() >= 8 && bytes.starts_with("glTF") && load<std::uint32_t>(bytes.data() + 4) < 256;
}

Document::~Document() = default;

Document::Document(const ScanFile& file) : file_(file), root_(std::make_unique<Json>()) {
  binary_ = gltf::is_binary(file.bytes);
  if (binary_) {
    read_binary();
  } else {
    parse(file.bytes, 0);
  }
  if (!root_->is_object()) throw file_.error("the glTF text is no JSON object", "{\"asset\": ..., ...}");
  const auto asset = root_->find("asset");
  const bool said =
      asset != root_->end() && asset->is_object() && asset->contains("version") && (*asset)["version"].is_string();
  const std::string version = said ? (*asset)["version"].get<std::string>() : "";
  if (!version.starts_with("2")) {
    throw file_.error(
        version.empty() ? "a glTF file that names no version" : "a glTF file of version " + in_quotes(version),
        "glTF 2.0; Blender and most converters write it");
  }
  if (const auto least = asset->find("minVersion"); least != asset->end()) {
    if (!least->is_string()) throw error("asset", "'minVersion' is no text", "\"2.0\"");
    const std::string needed = least->get<std::string>();
    if (needed != "2.0" && needed != "2" && !needed.starts_with("1.")) {
      throw file_.error("a glTF file that needs version " + in_quotes(needed) + " or later",
                        "glTF 2.0; Blender and most converters write it");
    }
  }
  buffers_.resize(static_cast<std::size_t>(size_of("buffers")));
}

void Document::read_binary() {
  constexpr std::size_t kHeader = 12;
  constexpr std::size_t kChunkHeader = 8;
  const std::string_view bytes = file_.bytes;
  if (bytes.size() < kHeader) throw file_.error("the file ends within the header of a GLB", "12 bytes and more");
  const auto version = load<std::uint32_t>(bytes.data() + 4);
  if (version != 2) {
    throw file_.error(fmt::format("a binary glTF file of version {}", version),
                      "version 2; Blender and most converters write it");
  }
  const std::uint64_t length = load<std::uint32_t>(bytes.data() + 8);
  if (length > bytes.size()) {
    throw file_.error(fmt::format("the header promises {} bytes, the file has {}", length, bytes.size()),
                      "a whole file; it may be cut short");
  }
  bool has_json = false;
  for (std::size_t at = kHeader; at + kChunkHeader <= length;) {
    const std::uint64_t size = load<std::uint32_t>(bytes.data() + at);
    const auto type = load<std::uint32_t>(bytes.data() + at + 4);
    at += kChunkHeader;
    if (size > length - at) {
      throw file_.error(
          fmt::format("a chunk at byte {} promises {} bytes, {} follow", at - kChunkHeader, size, length - at),
          "a whole file; it may be cut short");
    }
    const std::string_view chunk = bytes.substr(at, static_cast<std::size_t>(size));
    if (type == kJsonChunk && !has_json) {
      parse(chunk, at);
      has_json = true;
    } else if (type == kBinaryChunk && has_json && !has_chunk_) {
      chunk_ = chunk;
      has_chunk_ = true;
    }
    at += static_cast<std::size_t>(size);
  }
  if (!has_json) throw file_.error("a GLB without a JSON chunk", "JSON in the first chunk");
}

void Document::parse(std::string_view text, std::size_t at) {
  if (text.size() > kMostJson) {
    throw file_.error(fmt::format("the glTF text has {} bytes", text.size()),
                      fmt::format("at most {}; a GLB keeps numbers as bytes", kMostJson));
  }
  try {
    *root_ = Json::parse(text.begin(), text.end());
  } catch (const Json::out_of_range&) {
    throw file_.error("the JSON of the glTF file has a number that is too large", "numbers below 1e308");
  } catch (const Json::parse_error& error) {
    throw file_.error(fmt::format("the JSON of the glTF file is damaged at byte {}", at + error.byte),
                      "a whole JSON text");
  }
}

Error Document::error(const Place& place, const std::string& wrong, const std::string& expected) const {
  return file_.error(place + ": " + wrong, expected);
}

std::uint64_t Document::size_of(const char* list) const {
  const auto found = root_->find(list);
  if (found == root_->end()) return 0;
  if (!found->is_array()) throw error(list, "no list", "a list");
  return found->size();
}

const Json& Document::item(const char* list, std::uint64_t index, const Place& asked_by) const {
  const std::uint64_t count = size_of(list);
  if (index >= count) {
    throw error(asked_by, fmt::format("names {}[{}], and there are {}", list, index, count), "an index that exists");
  }
  const Json& found = (*root_)[list][static_cast<std::size_t>(index)];
  if (!found.is_object()) throw error(fmt::format("{}[{}]", list, index), "no object", "{...}");
  return found;
}

std::optional<std::uint64_t> Document::whole(const Json& object, const char* key, const Place& place) const {
  const auto found = object.find(key);
  if (found == object.end()) return std::nullopt;
  // 3.0 is written by some.
  if (found->is_number_unsigned()) return found->get<std::uint64_t>();
  if (found->is_number_float()) {
    const auto value = found->get<double>();
    if (value >= 0.0 && value < 9e15 && value == static_cast<double>(static_cast<std::uint64_t>(value)))
      return static_cast<std::uint64_t>(value);
  }
  throw error(place, fmt::format("'{}' is no whole number from 0", key));
}

std::uint64_t Document::whole(const Json& object, const char* key, std::uint64_t otherwise, const Place& place) const {
  return whole(object, key, place).value_or(otherwise);
}

std::uint64_t Document::required(const Json& object, const char* key, const Place& place) const {
  const std::optional<std::uint64_t> value = whole(object, key, place);
  if (!value) throw error(place, fmt::format("has no '{}'", key));
  return *value;
}

void Document::open_uri(const std::string& uri, const Place& place, Buffer& buffer) const {
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(',');
    const bool coded = comma != std::string::npos && std::string_view(uri).substr(0, comma).ends_with(";base64");
    if (!coded || !from_base64(std::string_view(uri).substr(comma + 1), buffer.owned)) {
      throw error(place, "a data URI that is no base64", "data:application/octet-stream;base64,...");
    }
    buffer.bytes = buffer.owned;
    return;
  }
  const std::string name = without_percents(uri);
  const std::filesystem::path path(name);
  const bool outside =
      path.is_absolute() || std::any_of(path.begin(), path.end(), [](const auto& part) { return part == ".."; });
  if (outside || name.find("://") != std::string::npos) {
    throw error(place, "its bytes are elsewhere: " + in_quotes(uri), "a file in the folder of the .gltf, or a GLB");
  }
  const std::filesystem::path beside = std::filesystem::path(file_.name).parent_path() / path;
  try {
    buffer.file = std::make_unique<MappedFile>(beside);
  } catch (const Error& found) {
    throw error(place, "its file cannot be read: " + found.wrong(),
                "the file " + in_quotes(name) + " beside the .gltf");
  }
  buffer.bytes = buffer.file->text();
}

std::string_view Document::buffer(std::uint64_t index) const {
  const Json& object = item("buffers", index, "bufferViews");
  Buffer& buffer = buffers_[static_cast<std::size_t>(index)];
  if (buffer.known) return buffer.bytes;
  const Place place = fmt::format("buffers[{}]", index);
  const auto uri = object.find("uri");
  if (uri == object.end()) {
    if (index != 0 || !has_chunk_) throw error(place, "has no 'uri', and the file no binary chunk for it");
    buffer.bytes = chunk_;
  } else {
    if (!uri->is_string()) throw error(place, "'uri' is no text");
    open_uri(uri->get_ref<const std::string&>(), place, buffer);
  }
  const std::uint64_t length = required(object, "byteLength", place);
  if (length > buffer.bytes.size()) {
    throw error(place, fmt::format("promises {} bytes, {} are there", length, buffer.bytes.size()),
                "a whole file; it may be cut short");
  }
  buffer.bytes = buffer.bytes.substr(0, static_cast<std::size_t>(length));
  buffer.known = true;
  return buffer.bytes;
}

Document::View Document::view(std::uint64_t index, const Place& asked_by) const {
  const Json& object = item("bufferViews", index, asked_by);
  const Place place = fmt::format("bufferViews[{}]", index);
  if (const Json* const packed = meshopt_of(object)) return unpacked(index, *packed, place);
  return {part_of_buffer(object, place), whole(object, "byteStride", 0, place)};
}

std::string_view Document::part_of_buffer(const Json& object, const Place& place) const {
  const std::string_view bytes = buffer(required(object, "buffer", place));
  const std::uint64_t offset = whole(object, "byteOffset", 0, place);
  const std::uint64_t length = required(object, "byteLength", place);
  if (offset > bytes.size() || length > bytes.size() - offset) {
    throw error(place, fmt::format("bytes {} to {} of a buffer of {}", offset, offset + length, bytes.size()));
  }
  return bytes.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

Document::View Document::unpacked(std::uint64_t index, const Json& packed, const Place& place) const {
  // Views may name the same bytes again and again.
  constexpr std::uint64_t kTimes = 32, kAlways = 512'000'000;
  const auto known = unpacked_.find(index);
  if (known == unpacked_.end()) {
    const std::string_view bytes = part_of_buffer(packed, place);
    const std::uint64_t most = kTimes * std::max(file_.bytes.size(), bytes.size()) + kAlways;
    std::string data = unpack_meshopt(*this, packed, bytes, most - std::min(most, unpacked_bytes_), place);
    unpacked_bytes_ += data.size();
    return {unpacked_[index] = std::move(data), required(packed, "byteStride", place)};
  }
  return {known->second, required(packed, "byteStride", place)};
}

std::string_view Document::picture(std::uint64_t index) const {
  const Json& object = item("images", index, "textures");
  const Place place = fmt::format("images[{}]", index);
  if (const std::optional<std::uint64_t> in_view = whole(object, "bufferView", place))
    return view(*in_view, place).bytes;
  const auto uri = object.find("uri");
  if (uri == object.end() || !uri->is_string()) throw error(place, "has no 'uri' and no 'bufferView'");
  Buffer& buffer = pictures_[index];
  if (!buffer.known) open_uri(uri->get_ref<const std::string&>(), place, buffer);
  buffer.known = true;
  return buffer.bytes;
}

}  // namespace sparsha::pipeline::gltf
