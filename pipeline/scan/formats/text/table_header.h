// What the header and the first rows of a text table say of it: names of columns in several languages, decimal commas.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace sparsha::pipeline {

/// The names in a header line: lower case, without quotes, comment signs and units in brackets. A line that is too long
/// for a header has none.
[[nodiscard]] std::vector<std::string> header_names(std::string_view line);

/// Columns of x, y and z by their names; all -1 unless the three are there.
struct NamedCoordinates {
  std::array<int, 3> columns = {-1, -1, -1};
  bool degrees = false;  ///< longitude and latitude

  [[nodiscard]] bool complete() const { return columns[0] >= 0; }
};
[[nodiscard]] NamedCoordinates name_coordinates(const std::vector<std::string>& names);

/// What a row's commas are.
enum class Commas : std::uint8_t {
  none_or_separators,
  decimal,    ///< "1,5;2,5", "1,5 2,5", "\"1,5\",\"2,5\""
  thousands,  ///< "1,234.5 6,789.1 ..."
};
[[nodiscard]] Commas commas_of_row(std::string_view line);

}  // namespace sparsha::pipeline
