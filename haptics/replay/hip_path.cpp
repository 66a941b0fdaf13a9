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
#include "base/threads/progress.h"
#include "haptics/replay/trace.h"

namespace sparsha::haptics {
namespace {

constexpr std::array<std::string_view, 4> kPathNames = {"t_s", "x_m", "y_m", "z_m"};
constexpr std::array<std::string_view, 4> kRunNames = {"t_s", "hip_x_m", "hip_y_m", "hip_z_m"};

/// Why a header without the columns' names has none, as far as it can be told.
std::string fault_of(std::string_view header) {
  const auto has = [&](std::string_view separator) {
    return header.find(std::string("t_s").append(separator)) != std::string_view::npos;
  };
  if (header.find(',') == std::string_view::npos) {
    if (has(";")) return "the header has semicolons between its names";
    if (has("\t")) return "the header has tabs between its names";
    if (has(" ")) return "the header has blanks between its names";
  }
  if (header.find('"') != std::string_view::npos) return "the header has its names in quotes";
  std::string lower(header);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (lower != header && lower.find("t_s") != std::string::npos) return "the header has capital letters in its names";
  double number = 0.0;
  if (std::string_view first = header; csv::to_number(csv::take_field(first), number))
    return "the first line is a row, and no header";
  return "the header names no path of the hand";
}

/// Columns of time and position in the header's order; throws when it has neither set of names, or one of them twice.
std::array<std::size_t, 4> find_columns(std::string_view header, const std::string& file) {
  std::vector<std::string_view> fields;
  for (std::string_view rest = header; !rest.empty();) fields.push_back(csv::trimmed(csv::take_field(rest)));
  for (const auto& names : {kRunNames, kPathNames}) {
    std::array<std::size_t, 4> columns{};
    std::size_t found = 0;
    for (std::size_t name = 0; name < names.size(); ++name) {
      const auto at = std::find(fields.begin(), fields.end(), names[name]);
      if (at == fields.end()) break;
      columns[name] = static_cast<std::size_t>(at - fields.begin());
      if (std::find(at + 1, fields.end(), names[name]) != fields.end())
        throw input_error_at(file, 1, "the header names " + std::string(names[name]) + " twice", "each column once");
      ++found;
    }
    if (found == names.size()) return columns;
  }
  throw input_error_at(file, 1, fault_of(header),
                       "columns t_s,x_m,y_m,z_m or those of a run.csv with hip_x_m,hip_y_m,hip_z_m, between commas");
}

double to_number(std::string_view field, const std::string& file, int line) {
  double value = 0.0;
  if (!csv::to_number(field, value))
    throw input_error_at(file, line, csv::in_quotes(csv::trimmed(field)) + " is not a number", "seconds and metres");
  return value;
}

HipSample sample_of(std::string_view row, const std::array<std::size_t, 4>& columns, std::size_t count,
                    const std::string& file, int line) {
  std::array<double, 4> value{};
  std::array<bool, 4> seen{};
  const auto fields = static_cast<std::size_t>(std::count(row.begin(), row.end(), ',')) + 1;
  for (std::size_t field = 0; field < fields; ++field) {
    const std::string_view text_of_field = csv::take_field(row);
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (columns[k] == field) {
        value[k] = to_number(text_of_field, file, line);
        seen[k] = true;
      }
  }
  if (!(seen[0] && seen[1] && seen[2] && seen[3]) || fields > count)
    throw input_error_at(file, line, "the row has " + std::to_string(fields) + " fields", "as many as the header");
  return {value[0], {value[1], value[2], value[3]}};
}

}  // namespace

std::vector<HipSample> read_hip_path(const std::filesystem::path& file, Progress* progress) {
  const std::string name = file.string();
  const MappedFile mapped(file);
  std::string_view text = mapped.text();
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const bool ends_whole = text.ends_with('\n');
  const std::string_view header = csv::take_line(text);
  const std::array<std::size_t, 4> columns = find_columns(header, name);
  const auto count = static_cast<std::size_t>(std::count(header.begin(), header.end(), ',')) + 1;

  std::vector<HipSample> path;
  for (int line = 2; !text.empty(); ++line) {
    const std::string_view row = csv::take_line(text);
    if (csv::trimmed(row).empty()) continue;
    try {
      path.push_back(sample_of(row, columns, count, name, line));
    } catch (const Error&) {
      const bool cut = text.empty() && !ends_whole && !path.empty();
      if (!cut) throw;
      if (progress != nullptr) progress->warn("the path " + name + " ends in the middle of a row, which is left out");
    }
  }
  mapped.require_whole();
  if (path.empty()) throw input_error(name, "no positions of the hand", "at least one row below the header");
  return path;
}

}  // namespace sparsha::haptics
