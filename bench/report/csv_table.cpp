#include "bench/report/csv_table.h"

#include <cmath>

#include "base/text/csv.h"
#include "base/text/html.h"

namespace sparsha::bench {

std::string shown(const std::string& field, double scale) {
  double value = 0.0;
  if (!csv::to_number(field, value)) return escape_html(field);
  value *= scale;
  if (value != 0.0 && std::abs(value) < 1e-9) return "&lt; 1e-9";
  const bool whole = value == static_cast<double>(static_cast<long long>(value)) && value < 1e12 && value > -1e12;
  return text_of(whole ? "%.0f" : "%.4g", value);
}

std::string html_of(const Table& table, const std::string& caption, const std::vector<Column>& columns,
                    const std::function<bool(std::size_t)>& keep) {
  std::vector<std::string> heads;
  for (const Column& column : columns)
    if (table.column(column.name)) heads.push_back(column.head);
  std::vector<HtmlRow> rows;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    if (keep && !keep(row)) continue;
    HtmlRow cells;
    for (const Column& column : columns) {
      if (!table.column(column.name)) continue;
      const double value = column.scale * table.number(row, column.name);
      cells.push_back(
          {shown(table.text(row, column.name), column.scale), value > column.fault_above, std::isnan(value)});
    }
    rows.push_back(cells);
  }
  return rows.empty() ? std::string() : html_table(caption, heads, rows);
}

std::string html_of(const std::filesystem::path& file, const std::string& caption, const std::vector<Column>& columns) {
  const auto table = read_table(file);
  return table ? html_of(*table, caption, columns) : std::string();
}

}  // namespace sparsha::bench
