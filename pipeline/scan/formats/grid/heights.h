// What grids of heights in text have in common: rows of numbers that become a mesh over the known ones.
#pragma once

#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/scan/file.h"
#include "pipeline/scan/formats/text/no_data.h"
#include "pipeline/scan/text.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline::grid {

/// Parses a whole word as a number with a point or a comma for decimals; nothing else may stand in it. `comma` and
/// `point` are set when one of the two was met.
[[nodiscard]] bool parse_value(std::string_view word, double& value, bool& comma, bool& point);

struct Raster {
  std::uint64_t columns = 0, rows = 0;
  double x = 0.0, y = 0.0;    ///< of the first value, file units
  double dx = 1.0, dy = 1.0;  ///< to the next column and to the next row; negative: it lies to the left, below
};

/// Throws Error{input} when so many values cannot be in the bytes that follow, or are more than a mesh may have.
void require_plausible(const ScanFile& file, int line, const Raster& raster, std::size_t bytes_left);

/// Reads a raster's values, row by row, into points and triangles. A row may go on over several lines, but when the
/// first ends where a line ends, all must. Values are unknown, invalid records without triangles, where they are not
/// finite, of 1e30 and more, or `no_data` (NaN: no such value) as a float32; and where they are another usual value for
/// unknown heights, in bulk and far from all others, which a warning says. Throws Error{input} with the line of a
/// value that is none, of a row that is too short or too long, and where the file ends early.
class HeightReader {
 public:
  HeightReader(const ScanFile& file, ScanWriter& out, const Raster& raster, double no_data);
  /// `first` is what is left of the line that `lines` has given last.
  void read(LineReader& lines, std::string_view first);
  /// Values that equalled `no_data`.
  [[nodiscard]] std::uint64_t no_data_count() const { return no_data_count_; }

 private:
  void add_value(double value);
  [[nodiscard]] bool is_no_data(double value) const;
  [[nodiscard]] bool is_unlisted_no_data(double value);
  void tell_unlisted_no_data();
  void end_row();
  void add_cell(std::uint64_t column);
  void check_row_end(bool at_line_end, int line, std::uint64_t found);
  void doubt_lengths();

  const ScanFile& file_;
  ScanWriter& out_;
  Raster raster_;
  double no_data_;
  std::vector<double> row_, before_;  ///< heights, NaN where unknown
  std::uint64_t rows_ = 0;            ///< complete ones
  int row_line_ = 0;                  ///< on which the present row began
  bool by_lines_ = false;             ///< the first row ended where a line ends
  bool one_line_ = false;             ///< and was one line
  std::uint64_t no_data_count_ = 0;
  LineReader values_;              ///< before the first value
  std::string_view first_values_;  ///< and what is left of its line
  NoDataValues unlisted_;          ///< all values, once one of them may be no data
  bool looked_for_unlisted_ = false;
  std::vector<std::pair<double, std::uint64_t>> unlisted_counts_;  ///< values that were taken as no data
  std::vector<double> steps_;                                      ///< of neighbouring heights, a sample without zeros
};

}  // namespace sparsha::pipeline::grid
