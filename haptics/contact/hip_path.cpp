// Paths of the hand from CSV files.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "haptics/contact/trace.h"
#include "pipeline/base/error.h"
#include "pipeline/base/files.h"

namespace sparsha::haptics {
namespace {

/// The next line of `text` without its end; `text` loses it.
std::string_view take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

std::string_view trimmed(std::string_view field) {
  while (!field.empty() && (field.front() == ' ' || field.front() == '\t')) field.remove_prefix(1);
  while (!field.empty() && (field.back() == ' ' || field.back() == '\t')) field.remove_suffix(1);
  return field;
}

constexpr std::array<std::string_view, 4> kPathNames = {"t_s", "x_m", "y_m", "z_m"};
constexpr std::array<std::string_view, 4> kRunNames = {"t_s", "hip_x_m", "hip_y_m", "hip_z_m"};

/// Columns of time and position in the header's order; throws when it has neither set of names.
std::array<std::size_t, 4> find_columns(std::string_view header, const std::string& file) {
  const std::vector<std::string_view> fields = split(header);
  for (const auto& names : {kRunNames, kPathNames}) {
    std::array<std::size_t, 4> columns{};
    std::size_t found = 0;
    for (std::size_t name = 0; name < names.size(); ++name)
      for (std::size_t field = 0; field < fields.size(); ++field)
        if (trimmed(fields[field]) == names[name]) {
          columns[name] = field;
          ++found;
          break;
        }
    if (found == names.size()) return columns;
  }
  throw input_error_at(file, 1, "the header names no path of the hand",
                       "columns t_s,x_m,y_m,z_m or those of a run.csv with hip_x_m,hip_y_m,hip_z_m");
}

double to_number(std::string_view field, const std::string& file, int line) {
  field = trimmed(field);
  if (!field.empty() && field.front() == '+') field.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size())
    throw input_error_at(file, line, "\"" + std::string(field.substr(0, 40)) + "\" is not a number",
                         "seconds and metres");
  return value;
}

}  // namespace

std::vector<HipSample> read_hip_path(const std::filesystem::path& file) {
  const std::string name = file.string();
  const MappedFile mapped(file);
  std::string_view text = mapped.text();
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const std::string_view header = take_line(text);
  const std::array<std::size_t, 4> columns = find_columns(header, name);
  const auto count = static_cast<std::size_t>(std::count(header.begin(), header.end(), ',')) + 1;

  std::vector<HipSample> path;
  for (int line = 2; !text.empty(); ++line) {
    const std::string_view row = take_line(text);
    if (trimmed(row).empty()) continue;
    std::array<double, 4> value{};
    std::array<bool, 4> seen{};
    std::size_t field_number = 0;
    for (std::string_view rest = row;; ++field_number) {
      const std::size_t comma = rest.find(',');
      for (std::size_t k = 0; k < columns.size(); ++k)
        if (columns[k] == field_number) {
          value[k] = to_number(rest.substr(0, comma), name, line);
          seen[k] = true;
        }
      if (comma == std::string_view::npos) break;
      rest.remove_prefix(comma + 1);
    }
    if (!(seen[0] && seen[1] && seen[2] && seen[3]) || field_number >= count)
      throw input_error_at(name, line, "the row has " + std::to_string(field_number + 1) + " fields",
                           "as many as the header");
    path.push_back({value[0], {value[1], value[2], value[3]}});
  }
  mapped.require_whole();
  if (path.empty()) throw input_error(name, "no positions of the hand", "at least one row below the header");
  return path;
}

}  // namespace sparsha::haptics
