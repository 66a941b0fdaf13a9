// Characters that look like those of numbers and are others: letters of other alphabets, digits and signs of other
// scripts and of typesetters, blanks that do not break.
#pragma once

#include <string_view>

namespace sparsha::pipeline {

/// True for text that is one number or several, but for such characters in it: "\u22120.5", "1\u00a0234.5". Some digit
/// is there. Bytes that are no UTF-8 are taken for Latin-1.
[[nodiscard]] bool are_numbers_but_for_look_alikes(std::string_view text);

}  // namespace sparsha::pipeline
