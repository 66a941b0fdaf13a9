// Buffer views that are compressed by meshoptimizer (EXT_meshopt_compression).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "pipeline/scan/formats/gltf/document.hpp"

namespace sparsha::pipeline::gltf {

/// The extension's object of a buffer view, of either of its names; null without.
[[nodiscard]] const Json* meshopt_of(const Json& view);
/// What it unpacks to: count * byteStride bytes. Throws Error{input} for what is damaged, for more than `most` bytes or
/// more than so few bytes can hold, and everywhere where the library was not there when the program was built.
[[nodiscard]] std::string unpack_meshopt(const Document& document, const Json& extension, std::string_view bytes,
                                         std::uint64_t most, const Place& place);

}  // namespace sparsha::pipeline::gltf
