// Tables of other people's programs: rows one by one, and errors with file, line and column.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/files/files.h"

namespace sparsha::protocol {

/// A CSV file with a header. Columns may stand in any order, and others beside them. A field may stand in double
/// quotes, as R's write.csv has it; commas in them do not end it. Memory does not grow with the file.
class TableReader {
 public:
  /// Throws Error{input} when the file cannot be read, is empty, or lacks one of `columns` or has it twice. Columns of
  /// `optional` may be missing; their index follows those of `columns`.
  TableReader(const std::filesystem::path& file, const std::vector<std::string>& columns,
              const std::vector<std::string>& optional = {});

  /// Goes to the next row; false at the end. Throws Error{input} when it has other than the header's number of fields.
  [[nodiscard]] bool next();
  /// Line of the row, from 1; behind the last row that of the end.
  [[nodiscard]] int line() const { return line_; }
  [[nodiscard]] bool has(std::size_t column) const { return place_[column] != kAbsent; }
  /// Without its quotes.
  [[nodiscard]] std::string_view word(std::size_t column) const { return fields_[place_[column]]; }
  /// A finite number of at most `limit` in size. Throws Error{input} otherwise; `meaning` says what belongs there.
  [[nodiscard]] double number(std::size_t column, const std::string& meaning, double limit) const;
  /// What is wrong at a column of this row.
  [[nodiscard]] Error wrong_at(std::size_t column, std::string wrong, std::string expected) const;
  /// What is wrong with the row.
  [[nodiscard]] Error wrong_row(std::string wrong, std::string expected) const;
  /// Throws Error{input} when the file became shorter meanwhile.
  void require_whole() const { mapped_.require_whole(); }

 private:
  static constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);

  std::string name_;
  MappedFile mapped_;
  std::string_view rest_;
  std::string_view row_;
  std::vector<std::string_view> fields_;
  std::vector<std::size_t> place_;  ///< of each asked column among the fields
  std::size_t count_ = 0;           ///< fields in the header
  int line_ = 0;
};

}  // namespace sparsha::protocol
