// Rows of a text table, whatever separates their values, and what its columns mean.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/scan/scalar.h"
#include "pipeline/scan/scan_file.h"

namespace sparsha::pipeline {

inline constexpr std::size_t kMostColumns = 64;

/// One row. Values are between blanks, commas or semicolons, perhaps in quotes; empty ones and words are NaN.
struct TableRow {
  std::array<double, kMostColumns> values;
  std::array<std::string_view, kMostColumns> words;  ///< of the values that are no numbers; else empty
  std::size_t count = 0;
};

enum class RowKind : std::uint8_t { blank, comment, words, numbers };

/// How a file writes its rows.
struct TableStyle {
  bool decimal_comma = false;  ///< commas belong to the numbers, semicolons part them
  bool leading_words = false;  ///< a row may begin with a name; else such a line is no row
};

/// Splits a line.
RowKind parse_table_row(std::string_view line, const TableStyle& style, TableRow& row);

/// Which column is what; -1 where there is none.
struct TableColumns {
  int x = 0, y = 1, z = 2;
  int red = -1, green = -1, blue = -1;
  int intensity = -1;
  ColourScale scale = ColourScale::byte;
  std::size_t usual = 3;            ///< columns of most rows
  std::vector<std::string> fields;  ///< names, as far as known
  std::vector<std::string> warnings;

  [[nodiscard]] bool has_colour() const { return red >= 0; }
  [[nodiscard]] int last() const;
};

/// True when the names tell where x, y and z are.
[[nodiscard]] bool name_coordinates(const std::vector<std::string>& names);

/// From the header's names (may be empty) and the first rows. `pts`: a fourth column is an intensity before colours.
[[nodiscard]] TableColumns guess_columns(const std::vector<std::string>& names, const std::vector<TableRow>& sample,
                                         bool pts);

/// The names in a header line: lower case, without quotes, comment signs and units in brackets.
[[nodiscard]] std::vector<std::string> header_names(std::string_view line);

}  // namespace sparsha::pipeline
