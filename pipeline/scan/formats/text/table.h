// Rows of a text table, whatever separates their values, and what its columns mean.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/scan/file.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/scalar.h"

namespace sparsha::pipeline {

inline constexpr std::size_t kMostColumns = 64;

/// One row. Values are between blanks, commas or semicolons, perhaps in quotes; empty ones and words are NaN.
struct TableRow {
  std::array<double, kMostColumns> values;
  std::array<std::string_view, kMostColumns> words;  ///< of the values that are no numbers; else empty
  std::size_t count = 0;

  /// True when nothing stands behind the last separator.
  [[nodiscard]] bool ends_empty() const {
    return count > 0 && std::isnan(values[count - 1]) && words[count - 1].empty();
  }
};

enum class RowKind : std::uint8_t { blank, comment, words, numbers };

/// How a file writes its rows.
struct TableStyle {
  bool decimal_comma = false;  ///< a comma between two digits belongs to a number
  bool leading_words = false;  ///< a row may begin with a name; else such a line is no row
};

/// Splits a line.
RowKind parse_table_row(std::string_view line, const TableStyle& style, TableRow& row);

/// Which column is what; -1 where there is none.
struct TableColumns {
  int x = 0, y = 1, z = 2;
  int red = -1, green = -1, blue = -1;
  int intensity = -1;
  int nx = -1, ny = -1, nz = -1;
  bool degrees = false;  ///< x and y are longitude and latitude
  ColourScale scale = ColourScale::byte;
  std::size_t usual = 3;  ///< columns of most rows
  TextTable::By by = TextTable::By::position;
  std::vector<std::string> fields;  ///< names, as far as known
  std::vector<std::string> warnings;

  [[nodiscard]] bool has_colour() const { return red >= 0; }
  [[nodiscard]] bool has_normals() const { return nx >= 0; }
  [[nodiscard]] int last() const;
  /// In the words of `scans: columns`, one for each of the usual columns.
  [[nodiscard]] std::vector<std::string> words() const;
};

/// As the configuration names them, of which x, y and z are there.
[[nodiscard]] TableColumns configured_columns(const std::vector<std::string>& words,
                                              const std::vector<TableRow>& sample);

/// From the header's names (may be empty) and the first rows. `pts`: a fourth column is an intensity before colours.
[[nodiscard]] TableColumns guess_columns(const std::vector<std::string>& names, const std::vector<TableRow>& sample,
                                         bool pts);

}  // namespace sparsha::pipeline
