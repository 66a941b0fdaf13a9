#include "pipeline/scan/formats/text/header.h"

#include <algorithm>
#include <utility>

#include "base/text/lower_case.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kLongestHeader = 1 << 14;

void trim(std::string& text) {
  while (!text.empty() && is_blank(text.back())) text.pop_back();
  text.erase(0, static_cast<std::size_t>(skip_blanks(text.data(), text.data() + text.size()) - text.data()));
}

/// A name that is one letter of another alphabet, or a wide one, which looks like that of an axis, is meant as that.
void make_latin(std::string& name) {
  constexpr std::pair<std::string_view, char> kLetters[] = {
      {"\u0445", 'x'}, {"\u0425", 'x'}, {"\u03c7", 'x'}, {"\u03a7", 'x'}, {"\uff58", 'x'}, {"\uff38", 'x'},
      {"\u0443", 'y'}, {"\u0423", 'y'}, {"\u03c5", 'y'}, {"\u03a5", 'y'}, {"\uff59", 'y'}, {"\uff39", 'y'},
      {"\u0396", 'z'}, {"\u03b6", 'z'}, {"\uff5a", 'z'}, {"\uff3a", 'z'}};
  for (const auto& [letter, axis] : kLetters) {
    if (name == letter) name.assign(1, axis);
  }
}

/// What brackets behind a name say: its axis ("P[x]"), where the axis goes ("X (north)", which becomes "x/north"), or
/// else its unit.
void add_bracket(std::string& name, std::string& unit, const std::string& text) {
  const bool is_axis_number = text.size() == 1 && std::string_view("xyz012").find(text) != std::string_view::npos;
  if (is_axis_number && names_place(name)) {
    name += text;
  } else if (names_direction(text) && names_axis(name)) {
    name += "/" + text;
  } else if (unit.empty() || unit_named(unit) == NamedUnit::none) {
    unit = text;
  }
}

/// Adds a name and what it says of its unit.
void add_name(TableHeader& header, std::string name) {
  trim(name);
  std::string unit;
  std::size_t open = name.find_first_of("([{<");
  if (open != std::string::npos) {
    const std::string whole = name;
    if (open > 0) {
      name.resize(open);
      trim(name);
    }
    while (open != std::string::npos) {
      const std::size_t close = std::min(whole.find_first_of(")]}>", open), whole.size());
      std::string text = whole.substr(open + 1, close - open - 1);
      trim(text);
      add_bracket(name, unit, text);
      open = whole.find_first_of("([{<", close);
    }
  }
  split_unit(name, unit);
  make_latin(name);
  header.names.push_back(std::move(name));
  header.units.push_back(std::move(unit));
}

/// A line of a header, split at a separator (0: blanks); within `brackets`, a separator parts nothing.
TableHeader split(std::string_view line, char separator, bool brackets) {
  TableHeader header;
  header.separator = separator;
  std::string name;
  const auto keep = [&] {
    add_name(header, std::move(name));
    name.clear();
  };
  const std::string text = lower_case(line);
  bool quoted = false;
  int depth = 0;
  bool any = false;
  for (const char c : text) {
    if (c == '"') {
      quoted = !quoted;
      any = true;
      continue;
    }
    if (c == '(' || c == '[') ++depth;
    if ((c == ')' || c == ']') && depth > 0) --depth;
    const bool parts = !quoted && (separator == 0 ? is_blank(c) : c == separator);
    if (parts && (!brackets || depth == 0)) {
      if (separator != 0 || !name.empty() || any) keep();
      any = false;
    } else {
      name += c;
    }
  }
  if (!name.empty() || any || separator != 0) keep();
  return header;
}

/// The same, with brackets that hold separators, if that leaves three names.
TableHeader split(std::string_view line, char separator) {
  TableHeader header = split(line, separator, true);
  return separator == 0 || header.names.size() >= 3 ? header : split(line, separator, false);
}

/// Units in brackets go to the name before them; with `join`, names whose words belong together become one.
void join_words(TableHeader& header, bool join) {
  std::vector<std::string> names;
  std::vector<std::string> units;
  for (std::size_t k = 0; k < header.names.size(); ++k) {
    const std::string& name = header.names[k];
    const bool bracket = !name.empty() && (name.front() == '(' || name.front() == '[' || name.front() == '{');
    if (bracket && !names.empty()) {
      add_bracket(names.back(), units.back(), header.units[k]);
    } else if (join && !names.empty() && belong_together(names.back(), name)) {
      names.back() += " " + name;
      if (!header.units[k].empty()) units.back() = header.units[k];
    } else {
      names.push_back(name);
      units.push_back(header.units[k]);
    }
  }
  // "x y z in mm"
  if (const std::size_t n = names.size(); n == 5 && names[3] == "in" && length_of(unit_named(names[4]))) {
    for (std::size_t k = 0; k < 3; ++k)
      if (units[k].empty()) units[k] = names[4];
    names.resize(3);
    units.resize(3);
  }
  constexpr std::string_view kLabels = " columns column fields field format variables cols ";
  if (names.size() > 3 && is_one_of(letters_of(names.front()), kLabels)) {
    names.erase(names.begin());
    units.erase(units.begin());
  }
  header.names = std::move(names);
  header.units = std::move(units);
}

bool is_prose(const std::vector<std::string>& words) {
  constexpr std::string_view kWords =
      " the of with and is are this file from by for contains has have as per each to und mit der die von et avec des ";
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) { return is_one_of(word, kWords); });
}

/// Takes "variables =", "columns:" and the like off; a column's own name stays.
std::string_view without_label(std::string_view line) {
  const std::size_t at = line.find_first_of(":=");
  if (at == std::string_view::npos || at + 1 >= line.size()) return line;
  const std::string_view label = line.substr(0, at);
  if (label.find_first_of(",;\t\"([") != std::string_view::npos) return line;
  if (line[at] == ':' && !is_blank(line[at + 1])) return line;
  const std::string letters = letters_of(lower_case(label));
  if (names_coordinate(letters)) return line;
  const std::ptrdiff_t blanks = std::count_if(label.begin(), label.end(), is_blank);
  if (letters.size() < 2 && line[at] == ':') return line;
  return blanks > 3 ? line : line.substr(at + 1);
}

/// Takes the signs of a comment off the front; `comment` tells whether there were any.
std::string_view without_comment_signs(std::string_view line, bool& comment) {
  std::string_view text = line;
  const auto is_sign = [&](char c) {
    return c == '#' || c == '/' || c == '%' || c == '!' || c == '*' ||
           (c == ';' && text.find(';', 1) == std::string_view::npos);
  };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  comment = false;
  while (!text.empty() && (is_sign(text.front()) || (comment && is_blank(text.front())))) {
    comment = true;
    text.remove_prefix(1);
  }
  return comment ? text : line;
}

}  // namespace

TableHeader parse_header(std::string_view line, bool join) {
  if (line.size() > kLongestHeader) return {};
  bool comment = false;
  const std::string_view text = without_label(without_comment_signs(line, comment));
  const bool gap = !line.empty() && is_blank(line.front());
  TableHeader best;
  for (const char separator : {'\t', ';', ',', '|', '\0'}) {
    if (separator != 0 && text.find(separator) == std::string_view::npos) continue;
    TableHeader header = split(text, separator);
    header.comment = comment;
    if (separator == 0) {
      header.gap = gap && !comment;
      header.prose = is_prose(header.names);
      join_words(header, join);
    }
    if (header.names.size() < 3) continue;
    header.columns = name_columns(header.names, header.units);
    if (header.columns.complete()) return header;
    if (best.names.empty()) best = std::move(header);
  }
  return best;
}

TableHeader header_of_lines(const std::vector<std::string_view>& lines) {
  TableHeader header;
  for (const std::string_view line : lines) {
    std::string name = lower_case(line.substr(0, kLongestHeader));
    std::erase(name, '"');
    add_name(header, std::move(name));
  }
  header.columns = name_columns(header.names, header.units);
  return header;
}

std::optional<scene::LengthUnit> length_of(NamedUnit unit) {
  constexpr std::pair<NamedUnit, scene::LengthUnit> kLengths[] = {{NamedUnit::metre, scene::LengthUnit::m},
                                                                  {NamedUnit::centimetre, scene::LengthUnit::cm},
                                                                  {NamedUnit::millimetre, scene::LengthUnit::mm},
                                                                  {NamedUnit::foot, scene::LengthUnit::ft},
                                                                  {NamedUnit::us_foot, scene::LengthUnit::us_ft}};
  for (const auto& [name, length] : kLengths) {
    if (unit == name) return length;
  }
  return std::nullopt;
}

HeaderUnit unit_of(const TableHeader& header) {
  HeaderUnit result;
  NamedUnit first = NamedUnit::none;
  bool differ = false;
  std::string words;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string& text = header.units[static_cast<std::size_t>(header.columns.xyz[axis])];
    const NamedUnit unit = unit_named(text);
    if (unit == NamedUnit::none || unit == NamedUnit::degree) continue;
    if (unit == NamedUnit::unknown) result.unknown = text;
    if (first == NamedUnit::none) first = unit;
    differ = differ || unit != first;
    words += (words.empty() ? "" : ", ") + std::string(1, "xyz"[axis]) + " in " + text;
  }
  if (header.columns.degrees) return {};
  if (differ) result.several = words;
  if (!differ) result.unit = length_of(first);
  return result;
}

bool add_units_row(std::string_view line, TableHeader& header) {
  if (line.size() > kLongestHeader) return false;
  bool comment = false;
  const std::string_view text = without_comment_signs(line, comment);
  for (const char separator : {header.separator, '\0'}) {
    TableHeader row = split(text, separator);
    if (row.names.size() != header.names.size()) continue;
    for (std::size_t k = 0; k < row.names.size(); ++k) {
      if (row.names[k].empty() || row.names[k].front() == '[' || row.names[k].front() == '(')
        row.names[k] = row.units[k];
    }
    const auto is_unit = [&](int column) {
      return unit_named(row.names[static_cast<std::size_t>(column)]) != NamedUnit::none;
    };
    if (!std::all_of(header.columns.xyz.begin(), header.columns.xyz.end(), is_unit)) continue;
    header.units = row.names;
    header.columns = name_columns(header.names, header.units);
    return true;
  }
  return false;
}

}  // namespace sparsha::pipeline
