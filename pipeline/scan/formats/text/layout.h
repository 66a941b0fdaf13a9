// What the first lines of a text table say of all of it: how rows are written and which column is what.
#pragma once

#include <optional>

#include "pipeline/scan/file.h"
#include "pipeline/scan/formats/text/columns.h"
#include "pipeline/scan/formats/text/rows.h"
#include "scene/config/scans.h"

namespace sparsha::pipeline {

struct TableLayout {
  TableStyle style;
  TableColumns columns;
  std::optional<scene::LengthUnit> unit;  ///< what the header says
  int first_row = 0;                      ///< its line; text stands before it, with numbers perhaps
  std::string_view header;       ///< the line with the names, which may stand there again where files were joined
  bool listed_names = false;     ///< the header has a name a line, below their number
  std::string_view unit_remark;  ///< a line before the rows that gives their unit; its number is 0 without one
  int unit_line = 0;
  bool empty = false;  ///< the file declares that it has no rows
};

/// Throws Error{input} on a file without rows, and where what is read would be a matter of luck.
[[nodiscard]] TableLayout inspect_table(const ScanFile& file);

}  // namespace sparsha::pipeline
