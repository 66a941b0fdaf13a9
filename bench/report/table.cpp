#include "bench/report/table.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <utility>

#include "base/text/csv.h"

namespace sparsha::bench {
namespace {

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const char c = line[k];
    if (quoted && c == '"' && k + 1 < line.size() && line[k + 1] == '"') {
      fields.back() += line[++k];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return fields;
}

}  // namespace

std::optional<std::size_t> Table::column(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

std::string Table::text(std::size_t row, const std::string& name) const {
  const auto at = column(name);
  return at ? rows[row][*at] : std::string();
}

double Table::number(std::size_t row, const std::string& name) const {
  double value = 0.0;
  return csv::to_number(text(row, name), value) ? value : std::numeric_limits<double>::quiet_NaN();
}

std::optional<Table> read_table(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  if (!stream || !std::getline(stream, line) || line.empty()) return std::nullopt;
  Table table;
  table.names = fields_of(line);
  for (int number = 2; std::getline(stream, line); ++number) {
    if (line.empty()) continue;
    std::vector<std::string> row = fields_of(line);
    if (row.size() > table.names.size())
      throw std::runtime_error(file.string() + ':' + std::to_string(number) + ": error: the row has " +
                               std::to_string(row.size()) + " fields; " + std::to_string(table.names.size()) +
                               ", as many as the header");
    row.resize(table.names.size());
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace sparsha::bench
