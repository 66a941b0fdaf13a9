// How a text table writes its rows, told from its first lines: decimal commas, separators of thousands, separators.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "pipeline/scan/formats/text/rows.h"

namespace sparsha::pipeline {

/// What a row's commas are.
enum class Commas : std::uint8_t {
  none_or_separators,
  decimal,    ///< "1,5;2,5", "1,5 2,5", "\"1,5\",\"2,5\""
  thousands,  ///< "1,234.5 6,789.1 ..."
};
[[nodiscard]] Commas commas_of_row(std::string_view line);

/// True when rows hold commas and digits alone, and every second value is written with leading zeros as decimals are:
/// "0,0200,0,0000,0,0004" is three numbers or six. `names`: how many a header has; 0 without one.
[[nodiscard]] bool are_commas_ambiguous(const std::vector<std::string_view>& rows, std::size_t names);

/// True when blanks part the thousands of coordinates between other separators, in most of the rows: "1 234.5; 2 345.0;
/// 3". Colours behind the coordinates may stand between blanks.
[[nodiscard]] bool are_thousands_spaced(const std::vector<std::string_view>& rows, bool decimal_comma);

/// What alone may part the values of all rows: tabs, semicolons or commas that stand in each of them, outside quotes;
/// last 0, when blanks, commas and semicolons all do. `titles`: the first lines may be text and have none.
[[nodiscard]] std::vector<char> possible_separators(const std::vector<std::string_view>& rows, bool decimal_comma,
                                                    bool titles);

/// True when a column of `rows`, split at one separator, holds several numbers between blanks wherever it holds
/// anything: "1, 2, 3, 255 128 0" has more separators than one.
[[nodiscard]] bool hold_rows_in_values(const std::vector<TableRow>& rows);

}  // namespace sparsha::pipeline
