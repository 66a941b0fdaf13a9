// The base colour of a glTF material: a factor, and a picture with the way that it lies on the mesh.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/scan/formats/gltf/document.hpp"
#include "pipeline/scan/formats/texture/texture.h"

namespace sparsha::pipeline::gltf {

struct Look {
  std::optional<Light> factor;         ///< linear light
  std::optional<std::uint64_t> image;  ///< number in "images"
  std::uint64_t coordinates = 0;       ///< TEXCOORD_n
  Wrap along_u = Wrap::repeat, along_v = Wrap::repeat;
  std::array<double, 6> turned{1, 0, 0, 0, 1, 0};  ///< u' = [0] u + [1] v + [2], v' = [3] u + [4] v + [5]
  bool opaque = true;                              ///< the picture's alpha means nothing

  std::string why{};  ///< not empty: its texture contradicts itself, and is left out

  [[nodiscard]] Light light(const ColourPicture& picture, double u, double v) const;
};

/// Of a primitive's material; that of KHR_materials_pbrSpecularGlossiness where there is no other. Throws Error{input}
/// for a material that does not exist.
[[nodiscard]] Look look_of(const Document& document, const Json& primitive, const Place& place);

/// The pictures of a file, decoded when they are asked for. The last ones stay, up to 1 GB.
class Pictures {
 public:
  explicit Pictures(const Document& document) : document_(document) {}
  /// Null when it cannot be read; then why() has a sentence for each such picture.
  [[nodiscard]] std::shared_ptr<const ColourPicture> find(std::uint64_t image);
  [[nodiscard]] const std::map<std::uint64_t, std::string>& why() const { return why_; }

 private:
  const Document& document_;
  std::map<std::uint64_t, std::shared_ptr<const ColourPicture>> pictures_;
  std::map<std::uint64_t, std::string> why_;
};

}  // namespace sparsha::pipeline::gltf
