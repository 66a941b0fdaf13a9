// The lines with which a text table begins: what stands above its rows, and the first of them.
#pragma once

#include <string_view>
#include <vector>

#include "pipeline/scan/file.h"
#include "pipeline/scan/formats/text/header.h"
#include "pipeline/scan/formats/text/rows.h"

namespace sparsha::pipeline {

inline constexpr std::size_t kSampledRows = 1000;

struct TableHead {
  TableStyle style;                    ///< commas and leading words; rows are not split at one separator yet
  std::vector<std::string_view> rows;  ///< of several counted blocks, those of the first
  std::vector<int> row_lines;          ///< their numbers
  std::string_view unit_remark;        ///< the first line before them that gives a unit, see remark_unit.h
  int unit_line = 0;
  std::vector<TableHeader> headers;  ///< lines that name x, y and z, in their order
  bool listed_names = false;         ///< the last of them has a name a line, below their number
  std::size_t names = 0;             ///< of a header that does not name them
  TableHeader unused;                ///< the same header
  std::size_t left_out = 0;          ///< lines above the rows that hold numbers behind a word
  int first_left_out = 0;            ///< the line
  bool declared_empty = false;       ///< the file says that it has no rows
  int first_words = 0;               ///< the first line of words, or 0
  std::string_view words;            ///< what it says
};

/// A line with nothing but one whole number: how many rows follow.
[[nodiscard]] bool is_count(const TableRow& row);

/// Throws Error{input} on separators of thousands, and on rows with characters that only look like a number's.
[[nodiscard]] TableHead read_head(const ScanFile& file);

}  // namespace sparsha::pipeline
