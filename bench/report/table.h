// CSV files that the benchmarks leave, as rows of text.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sparsha::bench {

struct Table {
  std::vector<std::string> names;              ///< of the header
  std::vector<std::vector<std::string>> rows;  ///< each as long as `names`

  /// Index of a column; nothing when there is none of that name.
  [[nodiscard]] std::optional<std::size_t> column(const std::string& name) const;
  /// Text of a row's field; empty when there is no such column.
  [[nodiscard]] std::string text(std::size_t row, const std::string& name) const;
  /// The field as a number; not a number when it is none.
  [[nodiscard]] double number(std::size_t row, const std::string& name) const;
};

/// Fields may stand in double quotes, a quote in them doubled. Short rows are filled up with empty fields. Nothing when
/// the file is missing or has no header. Throws std::runtime_error with file and line when a row has more fields than
/// the header: its figures would stand in the wrong columns.
[[nodiscard]] std::optional<Table> read_table(const std::filesystem::path& file);

}  // namespace sparsha::bench
