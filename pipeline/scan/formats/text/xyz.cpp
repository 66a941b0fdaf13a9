#include "pipeline/scan/formats/text/xyz.h"

#include <algorithm>

#include "pipeline/scan/formats/text/table.h"
#include "pipeline/scan/formats/text/table_header.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kSample = 1000;
constexpr std::size_t kSampledBytes = 1 << 20;

/// A line with nothing but one whole number: how many rows follow.
bool is_count(const TableRow& row) {
  return row.count == 1 && row.words[0].empty() && row.values[0] >= 0.0 && row.values[0] < 9e15 &&
         row.values[0] == static_cast<double>(static_cast<std::int64_t>(row.values[0]));
}

class Reader {
 public:
  Reader(const ScanFile& file, ScanWriter& out) : file_(file), out_(out) { begin_ = byte_order_mark(file.bytes); }

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
  /// What commas are, by the vote of the first rows that have some.
  void judge_commas() {
    LineReader lines(file_.bytes, begin_);
    std::string_view line;
    std::array<std::size_t, 3> votes{};
    int thousands_line = 0;
    for (std::size_t seen = 0; seen < kSample && lines.offset() < kSampledBytes && lines.next(line); ++seen) {
      if (line.find(',') == std::string_view::npos) continue;
      const Commas commas = commas_of_row(line);
      ++votes[static_cast<std::size_t>(commas)];
      if (commas == Commas::thousands && thousands_line == 0) thousands_line = lines.number();
    }
    const std::size_t decimal = votes[static_cast<std::size_t>(Commas::decimal)];
    const std::size_t thousands = votes[static_cast<std::size_t>(Commas::thousands)];
    const std::size_t others = votes[static_cast<std::size_t>(Commas::none_or_separators)];
    if (thousands > others && thousands >= decimal) {
      throw file_.error_at(thousands_line, "numbers with a comma and a point", "no separators of thousands");
    }
    style_.decimal_comma = decimal > others;
  }

  /// Header and meaning of the columns, from the first rows.
  void inspect() {
    judge_commas();
    LineReader lines(file_.bytes, begin_);
    std::string_view line;
    std::vector<std::string> names;
    std::vector<TableRow> sample;
    TableRow row;
    bool declared_empty = false;
    int first_words = 0;
    std::string_view words;
    while (sample.size() < kSample && lines.next(line)) {
      const RowKind kind = parse_table_row(line, style_, row);
      if (kind == RowKind::numbers && is_count(row)) {
        declared_empty = declared_empty || row.values[0] == 0.0;
      } else if (kind == RowKind::numbers) {
        sample.push_back(row);
      } else if (kind != RowKind::blank && sample.empty()) {
        std::vector<std::string> found = header_names(line);
        if (found.size() >= 3) names = std::move(found);
        style_.leading_words = !file_.columns.empty() || name_coordinates(names).complete();
        if (kind == RowKind::words && first_words == 0) {
          first_words = lines.number();
          words = line;
        }
      }
    }
    RawScan& scan = out_.scan();
    std::string kind = file_.extension;
    for (char& c : kind) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
    scan.format = (kind == "TXT" || kind == "ASC" || kind == "CSV" || kind == "PTS" ? kind : "XYZ") + " text";
    scan.table.emplace();
    if (sample.empty()) {
      if (!declared_empty && first_words > 0) {
        throw file_.error_at(first_words, "no rows of numbers; " + in_quotes(words) + " is none", "lines 'x y z'");
      }
      if (!declared_empty) throw file_.error("no rows of numbers", "lines 'x y z'");
      scan.fields = {"x", "y", "z"};
      out_.begin(0, false, false);
      return;
    }
    columns_ = file_.columns.empty() ? guess_columns(names, sample, file_.extension == "pts")
                                     : configured_columns(file_.columns, sample);
    needed_ = static_cast<std::size_t>(columns_.last()) + 1;
    scan.fields = columns_.fields;
    scan.warnings = columns_.warnings;
    scan.degrees = columns_.degrees;
    scan.table = {columns_.by, columns_.words()};
    out_.begin(0, columns_.has_colour(), columns_.intensity >= 0, columns_.has_normals());
  }

  [[nodiscard]] std::string expected_row() const {
    return std::to_string(std::max<std::size_t>(columns_.usual, 3)) + " numbers";
  }

  void point(const TableRow& row, int line) {
    if (row.count < needed_) {
      throw file_.error_at(line, "a row of " + std::to_string(row.count) + " values", expected_row());
    }
    if (row.count > columns_.usual + (row.ends_empty() ? 1 : 0)) ++longer_;
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
    if (columns_.has_normals()) set_normal(row);
    out_.add(value(columns_.x), value(columns_.y), value(columns_.z), rgba,
             columns_.intensity >= 0 ? static_cast<float>(value(columns_.intensity)) : 0.0F);
    ++rows_;
    ++rows_of_block_;
  }

  /// A row may end before its normal.
  void set_normal(const TableRow& row) {
    const auto value = [&](int column) {
      const auto i = static_cast<std::size_t>(column);
      return i < row.count ? row.values[i] : 0.0;
    };
    out_.set_normal(value(columns_.nx), value(columns_.ny), value(columns_.nz));
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
