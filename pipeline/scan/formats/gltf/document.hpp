// The JSON of a glTF file and the bytes that it names. Nothing is trusted: each index, offset and length is compared
// with what there is.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "base/files/files.h"
#include "pipeline/scan/file.h"

namespace sparsha::pipeline::gltf {

using Json = nlohmann::json;

/// Where something stands, for messages: "meshes[2].primitives[0]".
using Place = std::string;

/// The mark of a GLB with a version, which no word of a text has behind it.
[[nodiscard]] bool is_binary(std::string_view bytes);

class Document {
 public:
  /// Reads header and JSON; buffers when they are asked for. Throws Error{input}.
  explicit Document(const ScanFile& file);
  ~Document();
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  [[nodiscard]] const Json& root() const { return *root_; }
  [[nodiscard]] bool is_binary() const { return binary_; }
  [[nodiscard]] const ScanFile& file() const { return file_; }
  [[nodiscard]] Error error(const Place& place, const std::string& wrong, const std::string& expected = {}) const;

  /// The object list[index], as "accessors", 3.
  [[nodiscard]] const Json& item(const char* list, std::uint64_t index, const Place& asked_by) const;
  /// How many the list has; 0 where there is none.
  [[nodiscard]] std::uint64_t size_of(const char* list) const;
  /// A whole number that is not negative; `otherwise` where there is none.
  [[nodiscard]] std::optional<std::uint64_t> whole(const Json& object, const char* key, const Place& place) const;
  [[nodiscard]] std::uint64_t whole(const Json& object, const char* key, std::uint64_t otherwise,
                                    const Place& place) const;
  /// A number that must be there.
  [[nodiscard]] std::uint64_t required(const Json& object, const char* key, const Place& place) const;

  /// The bytes of a buffer view.
  struct View {
    std::string_view bytes;
    std::uint64_t stride = 0;  ///< 0: elements follow each other
  };
  [[nodiscard]] View view(std::uint64_t index, const Place& asked_by) const;
  /// The bytes of images[index], of which nobody has said that they are a picture. Throws Error{input} where there are
  /// none.
  [[nodiscard]] std::string_view picture(std::uint64_t index) const;

 private:
  struct Buffer {
    bool known = false;
    std::string_view bytes;
    std::string owned;                   ///< of data: URIs
    std::unique_ptr<MappedFile> file{};  ///< of others
  };
  void read_binary();
  void parse(std::string_view text, std::size_t at);
  [[nodiscard]] std::string_view buffer(std::uint64_t index) const;
  [[nodiscard]] std::string_view part_of_buffer(const Json& object, const Place& place) const;
  [[nodiscard]] View unpacked(std::uint64_t index, const Json& packed, const Place& place) const;
  void open_uri(const std::string& uri, const Place& place, Buffer& buffer) const;

  const ScanFile& file_;
  std::unique_ptr<Json> root_;
  std::string_view chunk_;  ///< the binary chunk of a GLB
  bool has_chunk_ = false;
  bool binary_ = false;
  mutable std::vector<Buffer> buffers_;
  mutable std::map<std::uint64_t, std::string> unpacked_;  ///< compressed views
  mutable std::uint64_t unpacked_bytes_ = 0;
  mutable std::map<std::uint64_t, Buffer> pictures_;  ///< of those with a URI
};

}  // namespace sparsha::pipeline::gltf
