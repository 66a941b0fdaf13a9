// Bytes as text in base 64 (RFC 4648): pictures inside pages, names that are no text, buffers inside files.
#pragma once

#include <string>
#include <string_view>

namespace sparsha {

[[nodiscard]] std::string to_base64(std::string_view bytes);

/// The bytes of `text`, which may hold blanks and lines anywhere. False when it is not base 64.
[[nodiscard]] bool from_base64(std::string_view text, std::string& bytes);

}  // namespace sparsha
