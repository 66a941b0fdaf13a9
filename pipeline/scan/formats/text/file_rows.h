// All rows of a text table, for what its first lines cannot tell.
#pragma once

#include <cstddef>
#include <string_view>

#include "pipeline/scan/file.h"
#include "pipeline/scan/formats/text/rows.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {

/// Calls `use(row)` with each row of numbers, in the order of the file, until it gives false; false then. Throws
/// Cancelled.
template <typename Use>
bool for_each_row(const ScanFile& file, const TableStyle& style, const Use& use) {
  LineReader lines(file.bytes);
  std::string_view line;
  TableRow row;
  std::size_t seen = 0;
  while (lines.next(line)) {
    if ((++seen & 0xFFFF) == 0) file.throw_if_cancelled();
    if (parse_table_row(line, style, row) == RowKind::numbers && !use(row)) return false;
  }
  return true;
}

}  // namespace sparsha::pipeline
