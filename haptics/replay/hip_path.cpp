// Paths of the hand from CSV files.
#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/files/files.h"
#include "base/text/csv.h"
#include "haptics/replay/trace.h"

namespace sparsha::haptics {
namespace {

constexpr std::array<std::string_view, 4> kPathNames = {"t_s", "x_m", "y_m", "z_m"};
constexpr std::array<std::string_view, 4> kRunNames = {"t_s", "hip_x_m", "hip_y_m", "hip_z_m"};

/// Columns of time and position in the header's order; throws when it has neither set of names.
std::array<std::size_t, 4> find_columns(std::string_view header, const std::string& file) {
  std::vector<std::string_view> fields;
  while (!header.empty()) fields.push_back(csv::trimmed(csv::take_field(header)));
  for (const auto& names : {kRunNames, kPathNames}) {
    std::array<std::size_t, 4> columns{};
    std::size_t found = 0;
    for (std::size_t name = 0; name < names.size(); ++name)
      for (std::size_t field = 0; field < fields.size(); ++field)
        if (fields[field] == names[name]) {
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
  double value = 0.0;
  if (!csv::to_number(field, value))
    throw input_error_at(file, line, csv::in_quotes(csv::trimmed(field)) + " is not a number", "seconds and metres");
  return value;
}

}  // namespace

std::vector<HipSample> read_hip_path(const std::filesystem::path& file) {
  const std::string name = file.string();
  const MappedFile mapped(file);
  std::string_view text = mapped.text();
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const std::string_view header = csv::take_line(text);
  const std::array<std::size_t, 4> columns = find_columns(header, name);
  const auto count = static_cast<std::size_t>(std::count(header.begin(), header.end(), ',')) + 1;

  std::vector<HipSample> path;
  for (int line = 2; !text.empty(); ++line) {
    const std::string_view row = csv::take_line(text);
    if (csv::trimmed(row).empty()) continue;
    std::array<double, 4> value{};
    std::array<bool, 4> seen{};
    const auto fields = static_cast<std::size_t>(std::count(row.begin(), row.end(), ',')) + 1;
    std::string_view rest = row;
    for (std::size_t field = 0; field < fields; ++field) {
      const std::string_view text_of_field = csv::take_field(rest);
      for (std::size_t k = 0; k < columns.size(); ++k)
        if (columns[k] == field) {
          value[k] = to_number(text_of_field, name, line);
          seen[k] = true;
        }
    }
    if (!(seen[0] && seen[1] && seen[2] && seen[3]) || fields > count)
      throw input_error_at(name, line, "the row has " + std::to_string(fields) + " fields", "as many as the header");
    path.push_back({value[0], {value[1], value[2], value[3]}});
  }
  mapped.require_whole();
  if (path.empty()) throw input_error(name, "no positions of the hand", "at least one row below the header");
  return path;
}

}  // namespace sparsha::haptics
