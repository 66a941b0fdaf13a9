// UTF-8 read strictly, character by character.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace sparsha {

struct Utf8Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  ///< 0: no UTF-8
};

/// The first character of a text that is not empty; none when its bytes are not of shortest form, a surrogate, beyond
/// U+10FFFF or cut short.
[[nodiscard]] Utf8Character first_utf8(std::string_view text);

[[nodiscard]] bool is_utf8(std::string_view text);

}  // namespace sparsha
