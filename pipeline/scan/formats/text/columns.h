// Which column of a text table is what.
#pragma once

#include <bitset>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/scan/formats/text/header.h"
#include "pipeline/scan/formats/text/rows.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/scalar.h"

namespace sparsha::pipeline {

/// -1 where there is no such column.
struct TableColumns {
  int x = 0, y = 1, z = 2;
  int red = -1, green = -1, blue = -1;
  int intensity = -1;
  int nx = -1, ny = -1, nz = -1;
  int track = -1;         ///< from here on COLMAP's rows name the pictures that show the point, two values each
  bool degrees = false;   ///< x and y are longitude and latitude
  std::size_t usual = 3;  ///< columns of most rows
  TextTable::By by = TextTable::By::position;
  bool numbered = false;            ///< the first column counts the rows, as far as the sample goes
  bool rows_vary = false;           ///< in length by their nature, behind the coordinates
  std::vector<std::string> fields;  ///< names, as far as known
  std::vector<std::string> warnings;
  std::vector<std::string> notes;
  std::bitset<kMostColumns> numbers;  ///< columns in which half of the first rows or more have numbers

  [[nodiscard]] bool has_colour() const { return red >= 0; }
  [[nodiscard]] bool has_normals() const { return nx >= 0; }
  /// Values that every row must have.
  [[nodiscard]] std::size_t needed() const;
  /// True where words are errors if they only look like numbers: in columns of numbers, and in those that are taken for
  /// colour, intensity or normal, whatever stands in them. Other columns of words are labels.
  [[nodiscard]] bool wants_numbers(std::size_t column) const;
  /// In the words of `scans: columns`, one for each of the usual columns.
  [[nodiscard]] std::vector<std::string> words() const;
};

/// As the configuration names them, of which x, y and z are there.
[[nodiscard]] TableColumns configured_columns(const std::vector<std::string>& words,
                                              const std::vector<TableRow>& sample);

/// Share of rows that may be wrong below a header that is right.
inline constexpr double kDamagedRows = 0.1;

/// Where a header's names are right above their values, or moved by names of several words or a column without a name.
struct HeaderPlace {
  int shift = 0;           ///< columns to the right
  bool exact = false;      ///< as many names as values
  bool ambiguous = false;  ///< values of several words may stand before the coordinates
};
/// Nothing when more than `damaged` of the rows have words for coordinates, or most of them nothing at all.
[[nodiscard]] std::optional<HeaderPlace> place_header(const TableHeader& header, const std::vector<TableRow>& sample,
                                                      char separator, double damaged);
[[nodiscard]] TableColumns named_columns(const TableHeader& header, const HeaderPlace& place,
                                         const std::vector<TableRow>& sample);

/// True when x, y and z of all rows are numbers or empty, and numbers in most.
[[nodiscard]] bool hold_coordinates(const TableColumns& columns, const std::vector<TableRow>& sample);

/// From the first rows alone. `pts`: a fourth column is an intensity before colours. `numbered` is set when the first
/// column counts the rows and leaves coordinates no other place than behind it.
[[nodiscard]] TableColumns guess_columns(const std::vector<TableRow>& sample, bool pts);
/// The same columns, taken by their places.
[[nodiscard]] TableColumns columns_by_position(const std::vector<TableRow>& sample, bool pts);
/// The same behind columns that count along a grid, which are not read.
[[nodiscard]] TableColumns columns_behind_indices(const std::vector<TableRow>& sample, std::size_t indices);

}  // namespace sparsha::pipeline
