// Numbers as people read and hear them.
#pragma once

#include <cstdint>
#include <string>

namespace sparsha {

/// `plain`: ASCII, for terminals. `screen`: with the sign for micro, for a window's fonts. `typeset`: with narrow
/// no-break spaces too, for pages. `spoken`: words, few digits.
enum class TextStyle { plain, screen, typeset, spoken };

/// Up to `digits` significant digits (1 to 7), no trailing zeros, no exponent.
[[nodiscard]] std::string value_text(double value, int digits = 3, TextStyle style = TextStyle::plain);

/// The fewest digits that give the same number back when they are read; "-0", "nan" and "inf" too. For files.
[[nodiscard]] std::string exact_text(double value);

/// A length, metres, in the unit that keeps its number short: "36 cm", "0.21 mm", "41 um", "3.5 centimetres". "unknown"
/// for what is not finite.
[[nodiscard]] std::string length_text(double metres, TextStyle style = TextStyle::plain);

/// 1, 2 or 5 times a power of ten, the largest that is at most `limit`; 0 when that is not positive and finite.
[[nodiscard]] double round_number(double limit);

/// 1234567 as "1 234 567".
[[nodiscard]] std::string count_text(std::uint64_t count, TextStyle style = TextStyle::plain);

}  // namespace sparsha
