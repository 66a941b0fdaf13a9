// The header of a text table: its line split into names, whatever separates them, and units.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/scan/formats/text/column_names.h"
#include "scene/config/scans.h"

namespace sparsha::pipeline {

struct TableHeader {
  std::vector<std::string> names;  ///< lower case, without quotes, comment signs and units in brackets
  std::vector<std::string> units;  ///< one per name, lower case; empty where none is given
  NamedColumns columns;            ///< x, y and z, or none at all
  char separator = 0;              ///< between the names; 0: blanks
  bool gap = false;                ///< begins with blanks: programs leave the place of row numbers empty
  bool comment = false;            ///< it began with a comment sign
  bool prose = false;              ///< it holds words of sentences
  int line = 0;
  std::string_view text;  ///< the line
};

/// From a line before the first row: with the separator that makes x, y and z names, else the likeliest. A line that is
/// too long for a header has no names. `join`: between blanks, two words may be one name, as "Point No." and "X
/// coord.".
[[nodiscard]] TableHeader parse_header(std::string_view line, bool join = true);

/// From names that stand on lines of their own.
[[nodiscard]] TableHeader header_of_lines(const std::vector<std::string_view>& lines);

/// What x, y and z are given in; several units, or one that no configuration has, are told in words.
struct HeaderUnit {
  std::optional<scene::LengthUnit> unit;
  std::string several;  ///< "x in mm, y in mm, z in m"
  std::string unknown;  ///< "in", "km"
};
[[nodiscard]] HeaderUnit unit_of(const TableHeader& header);

/// The length that configurations have for a unit.
[[nodiscard]] std::optional<scene::LengthUnit> length_of(NamedUnit unit);

/// True for a line such as "m,m,m" below a header: its units go into the header.
[[nodiscard]] bool add_units_row(std::string_view line, TableHeader& header);

}  // namespace sparsha::pipeline
