#include "pipeline/scan/formats/text/table.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/scan/formats/text/table_header.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_space(char c) { return is_blank(c) || c == '"'; }

/// True when the comma at `p` stands between two digits of a row [begin, end).
bool is_within_digits(const char* begin, const char* p, const char* end) {
  return p > begin && p + 1 < end && is_digit(p[-1]) && is_digit(p[1]);
}

/// A number in [p, end) whose decimal point may be a comma.
const char* number_at(const char* p, const char* end, bool decimal_comma, double& value) {
  if (!decimal_comma) return parse_number(p, end, value);
  std::array<char, 64> copy{};
  const auto length = std::min<std::size_t>(static_cast<std::size_t>(end - p), copy.size());
  for (std::size_t i = 0; i < length; ++i) {
    copy[i] = p[i] == ',' && is_within_digits(p, p + i, end) ? '.' : p[i];
  }
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

/// Columns of most rows; one that is empty in all of them comes from separators at the ends of lines.
std::size_t usual_count(const std::vector<TableRow>& sample) {
  std::array<std::size_t, kMostColumns + 1> votes{};
  for (const TableRow& row : sample) ++votes[row.count];
  const auto usual = static_cast<std::size_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
  const auto ends_empty = [&](const TableRow& row) { return row.count != usual || row.ends_empty(); };
  const bool empty_end = usual > 3 && std::all_of(sample.begin(), sample.end(), ends_empty);
  return empty_end ? usual - 1 : usual;
}

/// Unit vectors, not all of which point one way: as programs write normals behind coordinates.
bool look_like_normals(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first) {
  std::size_t rows = 0;
  bool negative = false;
  for (const TableRow& row : sample) {
    if (row.count != usual) continue;
    const Eigen::Vector3d normal(row.values[first], row.values[first + 1], row.values[first + 2]);
    if (normal.isZero(0.0)) continue;  // of points for which none was found
    if (!(std::abs(normal.norm() - 1.0) < 0.01)) return false;
    negative = negative || (normal.array() < 0.0).any();
    ++rows;
  }
  return negative && rows >= 3;
}

void set_normals(TableColumns& columns, int first) {
  columns.nx = first;
  columns.ny = first + 1;
  columns.nz = first + 2;
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
  } else if (usual == 6 && look_like_normals(sample, usual, 3)) {
    set_normals(columns, 3);
  } else if (usual >= 6 && look_like_colours(sample, usual, 3)) {
    set_colour(columns, 3);
    if (usual == 7) columns.intensity = 6;
    if (usual == 9 && look_like_normals(sample, usual, 6)) set_normals(columns, 6);
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
  label(columns.nx, "nx");
  label(columns.ny, "ny");
  label(columns.nz, "nz");
}

void use_names(TableColumns& columns, const std::vector<std::string>& names, const NamedCoordinates& named) {
  columns.fields = names;
  columns.x = named.columns[0];
  columns.y = named.columns[1];
  columns.z = named.columns[2];
  columns.degrees = named.degrees;
  columns.by = TextTable::By::names;
  const int red = find(names, {"red", "r", "rf"});
  const int green = find(names, {"green", "g", "gf"});
  const int blue = find(names, {"blue", "b", "bf"});
  if (red >= 0 && green >= 0 && blue >= 0) {
    columns.red = red;
    columns.green = green;
    columns.blue = blue;
  }
  columns.intensity = find(names, {"intensity", "scalar_intensity", "i", "reflectance"});
  const int nx = find(names, {"nx", "normal_x", "normalx"});
  const int ny = find(names, {"ny", "normal_y", "normaly"});
  const int nz = find(names, {"nz", "normal_z", "normalz"});
  if (nx >= 0 && ny >= 0 && nz >= 0) {
    columns.nx = nx;
    columns.ny = ny;
    columns.nz = nz;
  }
}

/// What the colours of the sample mean.
ColourScale scale_of(const TableColumns& columns, const std::vector<TableRow>& sample) {
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
  return colour_scale(largest, fractions);
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
  const auto is_comma = [&](const char* q) {
    return *q == ';' || (*q == ',' && !(decimal_comma && is_within_digits(line.data(), q, end)));
  };
  skip();
  if (p == end) return RowKind::blank;
  if (*p == '#' || *p == '%' || *p == '!' || (*p == '/' && p + 1 < end && p[1] == '/')) return RowKind::comment;
  bool any_number = false;
  bool any_word = false;
  while (p < end) {
    double value = kNaN;
    std::string_view word;
    if (!is_comma(p)) {
      const char* const stop = number_at(p, end, decimal_comma, value);
      if (stop != nullptr && (stop == end || is_space(*stop) || is_comma(stop))) {
        p = stop;
        any_number = true;
      } else {
        const char* const begin = p;
        while (p < end && !is_space(*p) && !is_comma(p)) ++p;
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
    if (p < end && is_comma(p)) {
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

std::vector<std::string> TableColumns::words() const {
  std::vector<std::string> words(std::max(usual, static_cast<std::size_t>(std::max(last(), nz)) + 1), "skip");
  const std::pair<int, const char*> named[] = {
      {x, "x"},   {y, "y"},   {z, "z"},  {red, "red"}, {green, "green"}, {blue, "blue"}, {intensity, "intensity"},
      {nx, "nx"}, {ny, "ny"}, {nz, "nz"}};
  for (const auto& [column, word] : named) {
    if (column >= 0 && static_cast<std::size_t>(column) < words.size()) words[static_cast<std::size_t>(column)] = word;
  }
  return words;
}

TableColumns guess_columns(const std::vector<std::string>& names, const std::vector<TableRow>& sample, bool pts) {
  TableColumns columns;
  columns.usual = usual_count(sample);
  const NamedCoordinates named = name_coordinates(names);
  const bool in_place = named.columns == std::array<int, 3>{0, 1, 2};
  if (named.complete() && (in_place || names.size() == columns.usual)) {
    use_names(columns, names, named);
  } else {
    guess_unnamed(columns, sample, pts);
    if (named.complete()) {
      columns.warnings.push_back("the header names " + std::to_string(names.size()) + " columns, the rows have " +
                                 std::to_string(columns.usual) + "; the first three are taken as x, y and z");
    } else if (names.size() >= 3 && names.size() == columns.usual) {
      columns.warnings.push_back("the header does not name x, y and z once each; the first three columns are taken");
    }
  }
  columns.scale = scale_of(columns, sample);
  return columns;
}

TableColumns configured_columns(const std::vector<std::string>& words, const std::vector<TableRow>& sample) {
  TableColumns columns;
  columns.by = TextTable::By::configuration;
  columns.usual = std::max(usual_count(sample), words.size());
  columns.x = find(words, {"x"});
  columns.y = find(words, {"y"});
  columns.z = find(words, {"z"});
  columns.red = find(words, {"red"});
  columns.green = find(words, {"green"});
  columns.blue = find(words, {"blue"});
  columns.intensity = find(words, {"intensity"});
  columns.nx = find(words, {"nx"});
  columns.ny = find(words, {"ny"});
  columns.nz = find(words, {"nz"});
  for (std::size_t i = 0; i < columns.usual; ++i) {
    const bool named = i < words.size() && words[i] != "skip";
    columns.fields.push_back(named ? words[i] : "column " + std::to_string(i + 1));
  }
  columns.scale = scale_of(columns, sample);
  return columns;
}

}  // namespace sparsha::pipeline
