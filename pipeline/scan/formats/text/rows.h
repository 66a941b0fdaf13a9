// Rows of a text table, whatever separates their values.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace sparsha::pipeline {

inline constexpr std::size_t kMostColumns = 64;

/// One row. Empty values, words and NA, N/A, null and None are NaN.
struct TableRow {
  std::array<double, kMostColumns> values;
  std::array<std::string_view, kMostColumns> words;  ///< of the values that are no numbers; else empty
  std::size_t count = 0;
  std::size_t beyond = 0;  ///< values behind these, which are only counted

  /// True when nothing stands behind the last separator.
  [[nodiscard]] bool ends_empty() const {
    return count > 0 && std::isnan(values[count - 1]) && words[count - 1].empty();
  }
  [[nodiscard]] bool has_word(int column) const {
    return static_cast<std::size_t>(column) < count && !words[static_cast<std::size_t>(column)].empty();
  }
  [[nodiscard]] bool has_number(int column) const {
    return static_cast<std::size_t>(column) < count && !std::isnan(values[static_cast<std::size_t>(column)]);
  }
};

enum class RowKind : std::uint8_t { blank, comment, words, numbers };

/// How a file writes its rows.
struct TableStyle {
  char separator = 0;  ///< what alone parts values, which may hold blanks then; 0: blanks, commas and semicolons
  bool decimal_comma = false;  ///< a comma between two digits belongs to a number
  bool leading_words = false;  ///< a row may begin with a name; else such a line is no row
};

/// Splits a line. Values may be in quotes, with separators between them.
RowKind parse_table_row(std::string_view line, const TableStyle& style, TableRow& row);

/// The first value of a text that has stars where a number was wider than its column, as Fortran writes it: "********",
/// "1.000********". Empty without.
[[nodiscard]] std::string_view overflow_in(std::string_view text);
inline constexpr const char* kOverflow = " stands where a number was wider than its column, as Fortran writes it";
inline constexpr const char* kNoOverflow = "wider columns, or NaN where there is no value";

}  // namespace sparsha::pipeline
