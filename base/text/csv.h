// Tables of numbers as text: fields between commas, a header line with names.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace sparsha::csv {

/// The next line of `text` without its end, LF or CRLF; `text` loses it.
[[nodiscard]] std::string_view take_line(std::string_view& text);
/// The next field of `line`; `line` loses it and its comma.
[[nodiscard]] std::string_view take_field(std::string_view& line);
/// Without blanks and tabs at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view field);
/// The whole field as a number, "nan" and "inf" too; false when it is none.
[[nodiscard]] bool to_number(std::string_view field, double& value);
/// A field as it may stand in a message.
[[nodiscard]] std::string in_quotes(std::string_view field);

/// Append a field and a comma; doubles with 17 significant digits, so that reading gives back the same bits.
void append(std::string& row, double value);
void append(std::string& row, std::uint64_t value);
void append(std::string& row, std::int64_t value);
void append(std::string& row, const std::array<double, 3>& values);
/// The comma behind the last field becomes the line's end.
void end_row(std::string& row);

}  // namespace sparsha::csv
