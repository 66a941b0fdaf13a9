#include "pipeline/scan/formats/text/xyz.h"
#include "pipeline/scan/formats/text/file_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pipeline/scan/colour_sample.h"
#include "pipeline/scan/formats/colmap.h"
#include "pipeline/scan/formats/remark_unit.h"
#include "pipeline/scan/formats/text/columns.h"
#include "pipeline/scan/formats/text/first_column.h"
#include "pipeline/scan/formats/text/first_lines.h"
#include "pipeline/scan/formats/text/header.h"
#include "pipeline/scan/formats/text/layout.h"
#include "pipeline/scan/formats/text/no_data.h"
#include "pipeline/scan/formats/text/rows.h"
#include "pipeline/scan/formats/text/triangle_rows.h"
#include "pipeline/scan/look_alikes.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string format_of(const std::string& extension) {
  std::string kind = extension;
  for (char& c : kind) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  return (kind == "TXT" || kind == "ASC" || kind == "CSV" || kind == "PTS" ? kind : "XYZ") + " text";
}

class Reader {
 public:
  Reader(const ScanFile& file, ScanWriter& out) : file_(file), out_(out), layout_(inspect_table(file)) {}

  void read() {
    begin();
    LineReader lines(file_.bytes);
    std::string_view line;
    TableRow row;
    std::size_t told = 0;
    while (lines.next(line)) {
      if (line == "\x1A" && lines.offset() == file_.bytes.size()) break;  // an end of file as DOS wrote it
      switch (parse_table_row(line, layout_.style, row)) {
        case RowKind::blank:
          break;
        case RowKind::comment:
          if (rows_ > 0) refuse_other_table(line, lines.number());
          break;
        case RowKind::words:
          if (lines.number() >= layout_.first_row && line != layout_.header) {
            if (line.front() == '\0') {
              throw file_.error_at(lines.number(),
                                   "zero bytes in place of rows, as where a file was not written to its end",
                                   "a complete file, or one without them");
            }
            refuse_overflow(line, lines.number());
            throw file_.error_at(lines.number(), in_quotes(line) + " is not a row of numbers", expected_row());
          }
          break;
        case RowKind::numbers:
          if (is_count(row)) {
            count_line(row, lines);
          } else if (lines.number() >= layout_.first_row) {
            if (may_begin_block(row)) follow_change(row, lines);
            point(row, lines.number());
          }
      }
      if (lines.offset() - told > (1U << 22)) {
        told = lines.offset();
        file_.done_before(told - 1);
      }
    }
    end_block(lines.number());
    tell();
  }

 private:
  [[nodiscard]] const TableColumns& columns() const { return layout_.columns; }

  void begin() {
    RawScan& scan = out_.scan();
    scan.format = format_of(file_.extension);
    scan.table = {columns().by, columns().words()};
    scan.fields = columns().fields;
    if (layout_.empty) scan.fields = {"x", "y", "z"};
    scan.warnings = columns().warnings;
    scan.notes.insert(scan.notes.end(), columns().notes.begin(), columns().notes.end());
    if (columns().track >= 0) scan.notes.emplace_back(kColmapNote);
    scan.degrees = columns().degrees;
    scan.unit = layout_.unit;
    if (!scan.degrees && !scan.unit) take_unit_of_remark(layout_.unit_remark, layout_.unit_line, scan);
    needed_ = columns().needed();
    ask_for_fields();
    find_colour_scale();
    out_.begin(0, columns().has_colour(), columns().intensity >= 0, columns().has_normals());
  }

  /// Of the columns that are no coordinates those that somebody asks for.
  void ask_for_fields() {
    fields_.clear();
    for (std::size_t k = 0; k < std::min(columns().fields.size(), kMostColumns); ++k) {
      const int column = static_cast<int>(k);
      if (column == columns().x || column == columns().y || column == columns().z) continue;
      const int slot = out_.want(columns().fields[k], column != columns().intensity);
      if (slot != ScanWriter::kUnwanted) fields_.emplace_back(column, slot);
    }
  }

  /// Of rows all over the file that have as many values as those whose columns are known.
  void find_colour_scale() {
    if (!columns().has_colour()) return;
    const auto [known, is_new] = scales_.try_emplace({columns().usual, columns().red}, ColourScale::byte);
    if (is_new) known->second = sampled_scale();
    scale_ = known->second;
  }
  [[nodiscard]] ColourScale sampled_scale() const {
    const std::array<int, 3> channels = {columns().red, columns().green, columns().blue};
    const auto last = static_cast<std::size_t>(std::max({channels[0], channels[1], channels[2]}));
    double largest = 0.0;
    bool fractions = false;
    TableRow row;
    const std::vector<std::string_view> parts = sampled_lines(file_.bytes);
    for (const std::string_view part : parts) {
      LineReader lines(part);
      std::string_view line;
      while (lines.next(line)) {
        if (parse_table_row(line, layout_.style, row) != RowKind::numbers || row.count <= last) continue;
        if (part.data() == file_.bytes.data() && lines.number() < layout_.first_row) continue;
        const bool usual = row.count == columns().usual || (row.count == columns().usual + 1 && row.ends_empty());
        if (!usual && !columns().rows_vary) continue;
        for (const int channel : channels) {
          const double value = row.values[static_cast<std::size_t>(channel)];
          if (value > largest) largest = value;
          fractions = fractions || (std::isfinite(value) && value != std::floor(value));
        }
      }
      file_.throw_if_cancelled();
      if (colour_scale(largest, true) == ColourScale::word) break;
    }
    return colour_scale(largest, fractions);
  }

  [[nodiscard]] std::string expected_row() const {
    if (columns().by == TextTable::By::configuration) {
      return std::to_string(needed_) + " values, as 'columns' of the scan says";
    }
    if (columns().rows_vary || columns().by == TextTable::By::names) {
      return fmt::format("at least {} values, of which {}, {} and {} are x, y and z", needed_, columns().x + 1,
                         columns().y + 1, columns().z + 1);
    }
    return std::to_string(std::max<std::size_t>(columns().usual, 3)) + " numbers";
  }

  /// A remark between rows that names other columns, or gives another unit, begins another table.
  void refuse_other_table(std::string_view line, int number) const {
    constexpr std::size_t kLongest = 4096;
    if (line == layout_.header || line.size() > kLongest || columns().by == TextTable::By::configuration) return;
    const auto refuse = [&](const char* what) {
      throw file_.error_at(number, in_quotes(line) + what, "one table in a file, or 'columns' of the scan");
    };
    if (const NamedUnit unit = unit_named(unit_in_remark(line)); unit != NamedUnit::none) {
      const bool differs = length_of(unit) != out_.scan().unit && out_.scan().unit.has_value();
      if (differs) refuse(" gives the rows behind it another unit");
      return;
    }
    const TableHeader other = parse_header(line);
    if (!other.columns.complete() || other.prose) return;
    if (columns().by == TextTable::By::names) {
      const TableHeader own = parse_header(layout_.header);
      if (own.names != other.names) refuse(" names other columns than the header");
      if (own.units != other.units && unit_of(own).unit != unit_of(other).unit)
        refuse(" gives the rows behind it another unit");
    } else if (other.columns.xyz != std::array<int, 3>{columns().x, columns().y, columns().z}) {
      refuse(" names other columns than those that were read before it");
    }
  }

  void point(const TableRow& row, int line) {
    if (row.count < needed_) {
      throw file_.error_at(line, "a row of " + std::to_string(row.count) + (row.count == 1 ? " value" : " values"),
                           expected_row());
    }
    if (row.count > columns().usual + (row.ends_empty() ? 1 : 0)) ++longer_;
    const auto value = [&](int column) { return row.values[static_cast<std::size_t>(column)]; };
    for (const int column : {columns().x, columns().y, columns().z}) {
      const std::string_view word = row.words[static_cast<std::size_t>(column)];
      if (word.empty()) continue;
      refuse_overflow(word, line);
      throw file_.error_at(line, in_quotes(word) + " is not a number", expected_row());
    }
    refuse_look_alikes(row, line);
    double z = value(columns().z);
    if (NoDataValues::is_candidate(z) && is_no_data(z)) {
      if (no_data_++ == 0) first_no_data_ = z;
      z = kNaN;
    }
    const auto has = [&](int column) { return column >= 0 && static_cast<std::size_t>(column) < row.count; };
    std::uint32_t rgba = kNoColour;
    if (columns().has_colour() && has(std::max({columns().red, columns().green, columns().blue}))) {
      rgba = pack_rgba(colour_byte(value(columns().red), scale_), colour_byte(value(columns().green), scale_),
                       colour_byte(value(columns().blue), scale_));
    } else if (columns().has_colour()) {
      ++colourless_;
    }
    for (const auto& [column, slot] : fields_) {
      const bool is_track = column == columns().track;
      out_.set_field(slot, is_track ? track_length(row) : has(column) ? value(column) : kNaN);
    }
    if (columns().has_normals()) set_normal(row);
    if (columns().by == TextTable::By::position) {
      first_column_.add(value(columns().x), value(columns().y), value(columns().z), number_behind(row));
      if (row.count == 9) {
        TriangleRows::Row nine{};
        std::copy_n(row.values.begin(), nine.size(), nine.begin());
        triangle_rows_.add(nine);
      }
    }
    out_.add(value(columns().x), value(columns().y), z, rgba,
             has(columns().intensity) ? static_cast<float>(value(columns().intensity)) : kNoIntensity);
    ++rows_;
    ++rows_of_block_;
  }

  /// The number behind z; not a number where there is none.
  [[nodiscard]] double number_behind(const TableRow& row) const {
    const int column = columns().z + 1;
    return row.has_number(column) ? row.values[static_cast<std::size_t>(column)] : kNaN;
  }

  /// Pictures that show the point.
  [[nodiscard]] double track_length(const TableRow& row) const {
    const std::size_t values = row.count + row.beyond - (row.ends_empty() ? 1 : 0);
    const std::size_t before = std::min(static_cast<std::size_t>(columns().track), values);
    return static_cast<double>((values - before) / 2);
  }

  void refuse_overflow(std::string_view text, int line) const {
    if (const std::string_view word = overflow_in(text); !word.empty())
      throw file_.error_at(line, in_quotes(word) + kOverflow, kNoOverflow);
  }

  /// In columns of numbers that nobody asks for, too: colours with a letter for a digit are not taken for colours.
  void refuse_look_alikes(const TableRow& row, int line) const {
    for (std::size_t k = 0; k < row.count; ++k) {
      const bool skipped = k < file_.columns.size() && file_.columns[k] == "skip";
      if (row.words[k].empty() || skipped || !columns().wants_numbers(k)) continue;
      refuse_overflow(row.words[k], line);
      if (!are_numbers_but_for_look_alikes(row.words[k])) continue;
      throw file_.error_at(line, in_quotes(row.words[k]) + " is not a number",
                           "digits, signs and points of ASCII; or 'skip' for the column in 'columns' of the scan");
    }
  }

  /// A row may end before its normal.
  void set_normal(const TableRow& row) {
    const auto value = [&](int column) {
      return column >= 0 && static_cast<std::size_t>(column) < row.count ? row.values[static_cast<std::size_t>(column)]
                                                                         : 0.0;
    };
    out_.set_normal(value(columns().nx), value(columns().ny), value(columns().nz));
  }

  /// Whether a height that may be no data is; looks through all rows when the first one is met.
  bool is_no_data(double z) {
    if (!looked_for_no_data_) {
      looked_for_no_data_ = true;
      for_each_row(file_, layout_.style, [&](const TableRow& row) {
        if (row.has_number(columns().z)) no_data_values_.add(row.values[static_cast<std::size_t>(columns().z)]);
        return true;
      });
      no_data_values_.decide();
    }
    return no_data_values_.contains(z);
  }

  /// PTS files may hold several scans, each with its count and its own columns.
  void count_line(const TableRow& row, const LineReader& lines) {
    if (layout_.listed_names && rows_ == 0) return;
    end_block(lines.number());
    promised_ = row.values[0];
    rows_of_block_ = 0;
    ++blocks_;
    if (rows_ > 0 && columns().by == TextTable::By::position) inspect_block(lines);
  }

  /// Tables that were joined have rows of another length from some line on.
  [[nodiscard]] bool may_begin_block(const TableRow& row) const {
    return columns().by == TextTable::By::position && !columns().rows_vary && !layout_.empty && rows_ > 0 &&
           row.count != columns().usual && !row.ends_empty();
  }

  /// Takes the columns of the rows from `first` on, behind which `lines` stands, when enough of them are as long.
  void follow_change(const TableRow& first, const LineReader& lines) {
    constexpr std::size_t kRows = 20;
    if (first.count < 3 || lines.number() < next_look_) return;
    std::vector<TableRow> sample = {first};
    LineReader ahead = lines;
    std::string_view line;
    TableRow row;
    while (sample.size() < kSampledRows && ahead.next(line)) {
      if (parse_table_row(line, layout_.style, row) != RowKind::numbers) continue;
      if (row.count != first.count) break;
      sample.push_back(row);
    }
    if (sample.size() < kRows) {
      next_look_ = ahead.number();
      return;
    }
    if (changes_++ == 0) {
      change_ = fmt::format("line {}, from {} to {}", lines.number(), columns().usual, first.count);
    }
    take_columns_of(sample);
  }

  void inspect_block(LineReader lines) {
    std::vector<TableRow> sample;
    std::string_view line;
    TableRow row;
    while (sample.size() < kSampledRows && lines.next(line)) {
      if (parse_table_row(line, layout_.style, row) != RowKind::numbers) continue;
      if (is_count(row)) break;
      sample.push_back(row);
    }
    if (!sample.empty()) take_columns_of(sample);
  }

  void take_columns_of(const std::vector<TableRow>& sample) {
    TableColumns found = columns_by_position(sample, file_.extension == "pts");
    if (found.usual == columns().usual && found.words() == columns().words()) return;
    layout_.columns = std::move(found);
    needed_ = columns().needed();
    ask_for_fields();
    find_colour_scale();
    out_.set_attributes(columns().has_colour(), columns().intensity >= 0, columns().has_normals());
    RawScan& scan = out_.scan();
    for (const std::string& field : columns().fields) {
      if (std::find(scan.fields.begin(), scan.fields.end(), field) == scan.fields.end()) scan.fields.push_back(field);
    }
    if (columns().words().size() > scan.table->columns.size()) scan.table->columns = columns().words();
  }

  void end_block(int line) {
    const auto found = static_cast<double>(rows_of_block_);
    if (promised_ > found) {
      throw file_.error_at(line,
                           "only " + std::to_string(rows_of_block_) + " rows follow the count " +
                               std::to_string(static_cast<std::int64_t>(promised_)),
                           "as many rows as promised; the file may be cut short");
    }
    if (promised_ >= 0.0 && promised_ < found) {
      out_.scan().warnings.push_back(std::to_string(rows_of_block_) + " rows follow the count " +
                                     std::to_string(static_cast<std::int64_t>(promised_)) + "; all are taken");
    }
  }

  /// What a reader of the result should know.
  void tell() {
    RawScan& scan = out_.scan();
    for (const std::string& doubt :
         {first_column_.doubt(columns().red == 3 || columns().nx == 3), triangle_rows_.doubt()}) {
      if (!doubt.empty()) scan.warnings.push_back(doubt);
    }
    if (longer_ > 0 && !columns().rows_vary) {
      scan.warnings.push_back(std::to_string(longer_) + (longer_ == 1 ? " row has" : " rows have") +
                              " more values than most; the first " + std::to_string(columns().usual) + " are taken");
    }
    if (changes_ > 0) {
      scan.warnings.push_back(
          fmt::format("the number of values in a row changes at {}{}; each part has its own columns", change_,
                      changes_ > 1 ? fmt::format(", and {} times more", changes_ - 1) : ""));
    }
    if (colourless_ > 0) scan.warnings.push_back(fmt::format("{} of {} points have no colour", colourless_, rows_));
    if (no_data_ > 0) {
      scan.warnings.push_back(
          fmt::format("{} of {} points have the no-data value {:.10g} as z; they are counted as invalid", no_data_,
                      rows_, first_no_data_));
    }
    if (blocks_ > 1) scan.scans = blocks_;
  }

  const ScanFile& file_;
  ScanWriter& out_;
  TableLayout layout_;
  FirstColumn first_column_;
  TriangleRows triangle_rows_;
  std::size_t needed_ = 3;
  ColourScale scale_ = ColourScale::byte;
  std::map<std::pair<std::size_t, int>, ColourScale> scales_;  ///< by values in a row and the place of red
  std::vector<std::pair<int, int>> fields_;                    ///< columns that somebody asks for, and their slots
  std::uint64_t rows_ = 0;
  std::uint64_t rows_of_block_ = 0;
  std::uint64_t colourless_ = 0;  ///< rows that end before the columns of colour
  std::uint64_t longer_ = 0;
  std::size_t blocks_ = 0;
  std::size_t changes_ = 0;  ///< of the number of values in a row, where no count announces it
  std::string change_;       ///< the first of them
  int next_look_ = 0;        ///< line up to which rows of other lengths are known to be few
  double promised_ = -1.0;
  NoDataValues no_data_values_;
  bool looked_for_no_data_ = false;
  std::uint64_t no_data_ = 0;
  double first_no_data_ = 0.0;
};

}  // namespace

void read_xyz(const ScanFile& file, ScanWriter& out) { Reader(file, out).read(); }

}  // namespace sparsha::pipeline
