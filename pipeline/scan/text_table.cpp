#include "pipeline/scan/text_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool is_comma(char c, bool decimal_comma) { return c == ';' || (c == ',' && !decimal_comma); }
bool is_space(char c) { return is_blank(c) || c == '"'; }

/// A number in [p, end) whose decimal point may be a comma.
const char* number_at(const char* p, const char* end, bool decimal_comma, double& value) {
  if (!decimal_comma) return parse_number(p, end, value);
  std::array<char, 64> copy{};
  const auto length = std::min<std::size_t>(static_cast<std::size_t>(end - p), copy.size());
  std::transform(p, p + length, copy.begin(), [](char c) { return c == ',' ? '.' : c; });
  const char* const stop = parse_number(copy.data(), copy.data() + length, value);
  return stop == nullptr ? nullptr : p + (stop - copy.data());
}

int find(const std::vector<std::string>& names, std::initializer_list<std::string_view> wanted) {
  for (const std::string_view word : wanted) {
    const auto found = std::find(names.begin(), names.end(), word);
    if (found != names.end()) return static_cast<int>(found - names.begin());
  }
  return -1;
}

/// True when all sampled rows have finite values of [low, high] in columns first to first + 2.
bool in_range(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first, double low, double high,
              bool whole) {
  if (usual < first + 3) return false;
  for (const TableRow& row : sample) {
    if (row.count != usual) continue;
    for (std::size_t k = first; k < first + 3; ++k) {
      const double v = row.values[k];
      if (!(v >= low && v <= high) || (whole && v != std::floor(v))) return false;
    }
  }
  return true;
}

/// Three neighbouring columns that look like colours: whole numbers of a byte, or fractions of one.
bool look_like_colours(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first) {
  return in_range(sample, usual, first, 0.0, 255.0, true) || in_range(sample, usual, first, 0.0, 1.0, false);
}

std::size_t usual_count(const std::vector<TableRow>& sample) {
  std::array<std::size_t, kMostColumns + 1> votes{};
  for (const TableRow& row : sample) ++votes[row.count];
  return static_cast<std::size_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
}

void set_colour(TableColumns& columns, int first) {
  columns.red = first;
  columns.green = first + 1;
  columns.blue = first + 2;
}

/// Columns without names, as scanners' programs write them.
void guess_unnamed(TableColumns& columns, const std::vector<TableRow>& sample, bool pts) {
  const std::size_t usual = columns.usual;
  if (usual >= 7 && pts && look_like_colours(sample, usual, 4)) {
    set_colour(columns, 4);
    columns.intensity = 3;
  } else if (usual >= 6 && look_like_colours(sample, usual, 3)) {
    set_colour(columns, 3);
    if (usual == 7) columns.intensity = 6;
  } else if (usual >= 7 && look_like_colours(sample, usual, 4)) {
    set_colour(columns, 4);
    columns.intensity = 3;
  } else if (usual == 4) {
    columns.intensity = 3;
  }
  columns.fields.assign(std::max<std::size_t>(usual, 3), "");
  for (std::size_t i = 0; i < columns.fields.size(); ++i) columns.fields[i] = "column " + std::to_string(i + 1);
  const auto label = [&](int column, const char* name) {
    if (column >= 0) columns.fields[static_cast<std::size_t>(column)] = name;
  };
  label(columns.x, "x");
  label(columns.y, "y");
  label(columns.z, "z");
  label(columns.red, "red");
  label(columns.green, "green");
  label(columns.blue, "blue");
  label(columns.intensity, "intensity");
}

void use_names(TableColumns& columns, const std::vector<std::string>& names) {
  columns.fields = names;
  columns.x = find(names, {"x", "easting"});
  columns.y = find(names, {"y", "northing"});
  columns.z = find(names, {"z", "elevation", "height"});
  const int red = find(names, {"red", "r", "rf"});
  const int green = find(names, {"green", "g", "gf"});
  const int blue = find(names, {"blue", "b", "bf"});
  if (red >= 0 && green >= 0 && blue >= 0) {
    columns.red = red;
    columns.green = green;
    columns.blue = blue;
  }
  columns.intensity = find(names, {"intensity", "scalar_intensity", "i", "reflectance"});
}

}  // namespace

RowKind parse_table_row(std::string_view line, const TableStyle& style, TableRow& row) {
  const bool decimal_comma = style.decimal_comma;
  row.count = 0;
  const char* p = line.data();
  const char* const end = p + line.size();
  const auto skip = [&] {
    while (p < end && is_space(*p)) ++p;
  };
  skip();
  if (p == end) return RowKind::blank;
  if (*p == '#' || (*p == '/' && p + 1 < end && p[1] == '/')) return RowKind::comment;
  bool any_number = false;
  bool any_word = false;
  while (p < end) {
    double value = kNaN;
    std::string_view word;
    if (!is_comma(*p, decimal_comma)) {
      const char* const stop = number_at(p, end, decimal_comma, value);
      if (stop != nullptr && (stop == end || is_space(*stop) || is_comma(*stop, decimal_comma))) {
        p = stop;
        any_number = true;
      } else {
        const char* const begin = p;
        while (p < end && !is_space(*p) && !is_comma(*p, decimal_comma)) ++p;
        word = {begin, static_cast<std::size_t>(p - begin)};
        value = kNaN;
        any_word = true;
        if (row.count == 0 && !style.leading_words) return RowKind::words;
      }
    }
    if (row.count < kMostColumns) {
      row.values[row.count] = value;
      row.words[row.count] = word;
      ++row.count;
    }
    skip();
    if (p < end && is_comma(*p, decimal_comma)) {
      ++p;
      skip();
      if (p == end && row.count < kMostColumns) {  // a separator at the end leaves an empty field
        row.values[row.count] = kNaN;
        row.words[row.count] = {};
        ++row.count;
      }
    }
  }
  if (any_number) return RowKind::numbers;
  return any_word ? RowKind::words : RowKind::blank;  // spreadsheets write empty rows as separators alone
}

int TableColumns::last() const { return std::max({x, y, z, red, green, blue, intensity}); }

std::vector<std::string> header_names(std::string_view line) {
  while (!line.empty() && (is_blank(line.front()) || line.front() == '#' || line.front() == '/')) line.remove_prefix(1);
  std::vector<std::string> names;
  const bool commas = line.find_first_of(",;") != std::string_view::npos;
  std::string name;
  const auto keep = [&] {
    while (!name.empty() && is_blank(name.back())) name.pop_back();
    const std::size_t bracket = name.find_first_of("([");
    if (bracket != std::string::npos && bracket > 0) name.resize(bracket);
    while (!name.empty() && is_blank(name.back())) name.pop_back();
    names.push_back(lower_case(name));
    name.clear();
  };
  for (const char c : line) {
    if (c == '"') continue;
    if (commas ? (c == ',' || c == ';') : is_blank(c)) {
      if (commas || !name.empty()) keep();
    } else if (!(name.empty() && is_blank(c))) {
      name += c;
    }
  }
  if (!name.empty()) keep();
  return names;
}

bool name_coordinates(const std::vector<std::string>& names) {
  return find(names, {"x", "easting"}) >= 0 && find(names, {"y", "northing"}) >= 0 &&
         find(names, {"z", "elevation", "height"}) >= 0;
}

TableColumns guess_columns(const std::vector<std::string>& names, const std::vector<TableRow>& sample, bool pts) {
  TableColumns columns;
  columns.usual = usual_count(sample);
  if (name_coordinates(names)) {
    use_names(columns, names);
  } else {
    guess_unnamed(columns, sample, pts);
    if (names.size() >= 3 && names.size() == columns.usual && find(names, {"x", "y", "z"}) >= 0) {
      columns.warnings.push_back("the header does not name x, y and z once each; the first three columns are taken");
    }
  }
  double largest = 0.0;
  bool fractions = false;
  for (const TableRow& row : sample) {
    for (const int column : {columns.red, columns.green, columns.blue}) {
      if (column < 0 || static_cast<std::size_t>(column) >= row.count) continue;
      const double v = row.values[static_cast<std::size_t>(column)];
      if (v > largest) largest = v;
      fractions = fractions || v != std::floor(v);
    }
  }
  columns.scale = colour_scale(largest, fractions);
  return columns;
}

}  // namespace sparsha::pipeline
