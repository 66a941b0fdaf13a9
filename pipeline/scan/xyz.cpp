#include "pipeline/scan/xyz.h"

#include <algorithm>

#include "pipeline/scan/text.h"
#include "pipeline/scan/text_table.h"

namespace sparsha::pipeline {
namespace {

/// Semicolons between values and commas within them: the way of half of Europe's spreadsheets.
bool uses_decimal_comma(std::string_view line) {
  if (line.find(';') == std::string_view::npos) return false;
  for (std::size_t i = 1; i + 1 < line.size(); ++i) {
    const auto digit = [&](std::size_t k) { return line[k] >= '0' && line[k] <= '9'; };
    if (line[i] == ',' && digit(i - 1) && digit(i + 1)) return true;
  }
  return false;
}

/// A line with nothing but one whole number: how many rows follow.
bool is_count(const TableRow& row) {
  return row.count == 1 && row.words[0].empty() && row.values[0] >= 0.0 && row.values[0] < 9e15 &&
         row.values[0] == static_cast<double>(static_cast<std::int64_t>(row.values[0]));
}

class Reader {
 public:
  Reader(const ScanFile& file, ScanWriter& out) : file_(file), out_(out) {
    begin_ = file.bytes.substr(0, 3) == "\xEF\xBB\xBF" ? 3 : 0;  // byte order mark of UTF-8
  }

  void read() {
    inspect();
    LineReader lines(file_.bytes, begin_);
    std::string_view line;
    TableRow row;
    std::size_t told = 0;
    while (lines.next(line)) {
      switch (parse_table_row(line, style_, row)) {
        case RowKind::blank:
        case RowKind::comment:
          break;
        case RowKind::words:
          if (rows_ > 0) {
            throw file_.error_at(lines.number(), in_quotes(line) + " is not a row of numbers", expected_row());
          }
          break;
        case RowKind::numbers:
          is_count(row) ? count_line(row, lines.number()) : point(row, lines.number());
      }
      if (lines.offset() - told > (1U << 22)) {
        told = lines.offset();
        file_.done_before(told - 1);
      }
    }
    end_block(lines.number());
    if (longer_ > 0) {
      out_.scan().warnings.push_back(std::to_string(longer_) + (longer_ == 1 ? " row has" : " rows have") +
                                     " more values than most; the first " + std::to_string(columns_.usual) +
                                     " are taken");
    }
    if (blocks_ > 1) out_.scan().scans = blocks_;
  }

 private:
  /// Header and meaning of the columns, from the first rows.
  void inspect() {
    constexpr std::size_t kSample = 1000;
    LineReader lines(file_.bytes, begin_);
    std::string_view line;
    std::vector<std::string> names;
    std::vector<TableRow> sample;
    TableRow row;
    bool declared_empty = false;
    while (sample.size() < kSample && lines.next(line)) {
      if (sample.empty()) style_.decimal_comma = uses_decimal_comma(line);
      const RowKind kind = parse_table_row(line, style_, row);
      if (kind == RowKind::numbers && is_count(row)) {
        declared_empty = declared_empty || row.values[0] == 0.0;
      } else if (kind == RowKind::numbers) {
        sample.push_back(row);
      } else if (kind != RowKind::blank && sample.empty()) {
        std::vector<std::string> found = header_names(line);
        if (found.size() >= 3) names = std::move(found);
        style_.leading_words = name_coordinates(names);
      }
    }
    RawScan& scan = out_.scan();
    std::string kind = file_.extension;
    for (char& c : kind) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
    scan.format = (kind == "TXT" || kind == "ASC" || kind == "CSV" || kind == "PTS" ? kind : "XYZ") + " text";
    if (sample.empty()) {
      if (!declared_empty) throw file_.error("no rows of numbers", "lines 'x y z'");
      scan.fields = {"x", "y", "z"};
      out_.begin(0, false, false);
      return;
    }
    columns_ = guess_columns(names, sample, file_.extension == "pts");
    needed_ = static_cast<std::size_t>(columns_.last()) + 1;
    scan.fields = columns_.fields;
    scan.warnings = columns_.warnings;
    out_.begin(0, columns_.has_colour(), columns_.intensity >= 0);
  }

  [[nodiscard]] std::string expected_row() const {
    return std::to_string(std::max<std::size_t>(columns_.usual, 3)) + " numbers";
  }

  void point(const TableRow& row, int line) {
    if (row.count < needed_) {
      throw file_.error_at(line, "a row of " + std::to_string(row.count) + " values", expected_row());
    }
    if (row.count > columns_.usual) ++longer_;
    const auto value = [&](int column) { return row.values[static_cast<std::size_t>(column)]; };
    for (const int column : {columns_.x, columns_.y, columns_.z}) {
      const std::string_view word = row.words[static_cast<std::size_t>(column)];
      if (!word.empty()) throw file_.error_at(line, in_quotes(word) + " is not a number", expected_row());
    }
    std::uint32_t rgba = kWhite;
    if (columns_.has_colour()) {
      rgba = pack_rgba(colour_byte(value(columns_.red), columns_.scale),
                       colour_byte(value(columns_.green), columns_.scale),
                       colour_byte(value(columns_.blue), columns_.scale));
    }
    out_.add(value(columns_.x), value(columns_.y), value(columns_.z), rgba,
             columns_.intensity >= 0 ? static_cast<float>(value(columns_.intensity)) : 0.0F);
    ++rows_;
    ++rows_of_block_;
  }

  /// PTS files may hold several scans, each with its count.
  void count_line(const TableRow& row, int line) {
    end_block(line);
    promised_ = row.values[0];
    rows_of_block_ = 0;
    ++blocks_;
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

  const ScanFile& file_;
  ScanWriter& out_;
  std::size_t begin_ = 0;
  TableStyle style_;
  TableColumns columns_;
  std::size_t needed_ = 3;
  std::uint64_t rows_ = 0;
  std::uint64_t rows_of_block_ = 0;
  std::uint64_t longer_ = 0;
  std::size_t blocks_ = 0;
  double promised_ = -1.0;
};

}  // namespace

void read_xyz(const ScanFile& file, ScanWriter& out) { Reader(file, out).read(); }

}  // namespace sparsha::pipeline
