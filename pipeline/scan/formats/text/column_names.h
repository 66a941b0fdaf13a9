// Names of columns in text tables: coordinates, colours, normals and units as programs and surveyors of several
// countries write them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sparsha::pipeline {

/// Columns by their names; -1 where there is none.
struct NamedColumns {
  std::array<int, 3> xyz = {-1, -1, -1};
  std::array<int, 3> colour = {-1, -1, -1};
  std::array<int, 3> normal = {-1, -1, -1};
  int intensity = -1;
  bool degrees = false;      ///< x and y are longitude and latitude
  bool by_initials = false;  ///< of easting, northing and height, which might be other words'
  bool exchanged = false;    ///< x is the column 'y', since the names say which of them is east or north
  bool repeated = false;     ///< one of the three is there twice
  bool other_set = false;    ///< other columns are named after the axes, too

  [[nodiscard]] bool complete() const { return xyz[0] >= 0; }
};
/// From lower-case names and their units, as many.
[[nodiscard]] NamedColumns name_columns(const std::vector<std::string>& names, const std::vector<std::string>& units);

enum class NamedUnit : std::uint8_t { none, metre, centimetre, millimetre, foot, us_foot, degree, unknown };
/// `unknown` is a unit that no configuration has; `none` no unit at all.
[[nodiscard]] NamedUnit unit_named(std::string_view text);

/// Splits the name of a coordinate "x_mm", "x / mm", "x in mm", "x mm" or "xmm" into name and unit.
void split_unit(std::string& name, std::string& unit);

/// What names, and units as many, have in place of x, y and z, where the first three columns are surely not these:
/// angles, or x and y beside what is no height. Empty where they may be.
[[nodiscard]] std::string why_no_coordinates(const std::vector<std::string>& names,
                                             const std::vector<std::string>& units);

/// Whether a name is one that x, y or z, or longitude and latitude go by.
[[nodiscard]] bool names_coordinate(std::string_view name);
/// Whether it is that of x, y or z.
[[nodiscard]] bool names_axis(std::string_view name);
/// Whether a word says where an axis goes: "north", "easting", "h".
[[nodiscard]] bool names_direction(std::string_view word);
/// Whether it is that of a place, of which brackets choose a coordinate: "P[x]".
[[nodiscard]] bool names_place(std::string_view name);
/// Words that make one name of two: "point no.", "x coordinate".
[[nodiscard]] bool belong_together(std::string_view first, std::string_view second);

/// Letters and digits of a lower-case name, and bytes beyond ASCII: "coord. x" and "coord_x" are the same.
[[nodiscard]] std::string letters_of(std::string_view name);
/// Whether a word is one of a list that has blanks between them and at both ends.
[[nodiscard]] inline bool is_one_of(std::string_view word, std::string_view list) {
  return !word.empty() && list.find(" " + std::string(word) + " ") != std::string_view::npos;
}

}  // namespace sparsha::pipeline
