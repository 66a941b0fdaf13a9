// A CSV file as a table of the page: which columns, under which heads, in which unit.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "bench/report/html.h"
#include "bench/report/table.h"

namespace sparsha::bench {

struct Column {
  std::string name;                                              ///< in the file
  std::string head;                                              ///< on the page, with its unit
  double scale = 1.0;                                            ///< number on the page = this times that of the file
  double fault_above = std::numeric_limits<double>::infinity();  ///< on the page
};

/// "1.23", with at most four significant digits; text as it is.
[[nodiscard]] std::string shown(const std::string& field, double scale = 1.0);

/// Rows for which `keep` holds (all without it); empty when none does. Columns that the file lacks are left out.
[[nodiscard]] std::string html_of(const Table& table, const std::string& caption, const std::vector<Column>& columns,
                                  const std::function<bool(std::size_t)>& keep = {});
/// The same of a file; empty when it is missing.
[[nodiscard]] std::string html_of(const std::filesystem::path& file, const std::string& caption,
                                  const std::vector<Column>& columns);

}  // namespace sparsha::bench
