#include "pipeline/scan/formats/text/first_lines.h"

#include <array>
#include <cstdint>
#include <utility>

#include "pipeline/scan/formats/remark_unit.h"
#include "pipeline/scan/formats/text/row_style.h"
#include "pipeline/scan/look_alikes.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kSampledBytes = 1 << 20;
constexpr std::size_t kMostHeaders = 64;

class Collector {
 public:
  explicit Collector(const ScanFile& file) : file_(file) {}

  TableHead read() {
    judge_commas();
    collect();
    return std::move(head_);
  }

 private:
  /// What commas are, by the vote of the first rows that have some.
  void judge_commas() {
    LineReader lines(file_.bytes);
    std::string_view line;
    std::array<std::size_t, 3> votes{};
    int thousands_line = 0;
    for (std::size_t seen = 0; seen < kSampledRows && lines.offset() < kSampledBytes && lines.next(line); ++seen) {
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
    head_.style.decimal_comma = decimal > others;
  }

  void collect() {
    TableStyle& style = head_.style;
    style.leading_words = !file_.columns.empty();
    LineReader lines(file_.bytes);
    std::string_view line;
    TableRow row;
    bool counted = false;
    while (head_.rows.size() < kSampledRows && lines.next(line)) {
      const RowKind kind = parse_table_row(line, style, row);
      if (kind == RowKind::numbers && is_count(row)) {
        if (counted && !head_.rows.empty()) break;
        counted = counted || head_.rows.empty();
        head_.declared_empty = head_.declared_empty || row.values[0] == 0.0;
        listed_ = row.values[0] <= static_cast<double>(kMostColumns) ? static_cast<std::size_t>(row.values[0]) : 0;
        list_.clear();
      } else if (kind == RowKind::numbers) {
        if (head_.rows.empty()) take_listed_names(row, lines.number());
        head_.rows.push_back(line);
        head_.row_lines.push_back(lines.number());
      } else if (kind != RowKind::blank && head_.rows.empty()) {
        header_line(line, lines.number(), kind);
      }
    }
  }

  /// Of remarks that differ, none is taken.
  void take_unit(std::string_view line, int number) {
    if (!gives_unit(line)) return;
    if (head_.unit_line == 0) {
      head_.unit_remark = line;
      head_.unit_line = number;
    } else if (unit_named(unit_in_remark(line)) != unit_named(unit_in_remark(head_.unit_remark))) {
      head_.unit_remark = {};
    }
  }

  void header_line(std::string_view line, int number, RowKind kind) {
    if (kind == RowKind::words && are_numbers_but_for_look_alikes(line)) {
      throw file_.error_at(number, in_quotes(line) + " is not a row of numbers",
                           "digits, signs, points and blanks of ASCII");
    }
    if (kind == RowKind::words && head_.first_words == 0) {
      head_.first_words = number;
      head_.words = line;
    }
    const bool row_behind_word = kind == RowKind::words && is_row_behind_a_word(line);
    if (const std::string_view word = overflow_in(line);
        row_behind_word && !word.empty() && line.find(word) == line.find_first_not_of(" \t"))
      throw file_.error_at(number, in_quotes(word) + kOverflow, kNoOverflow);
    if (row_behind_word && head_.left_out++ == 0) head_.first_left_out = number;
    if (kind == RowKind::words && listed_ > 0 && list_.size() < listed_) list_.push_back(line);
    bool units = false;
    for (TableHeader& header : head_.headers) {
      units = (header.line == head_.headers.back().line && add_units_row(line, header)) || units;
    }
    if (units) return;
    TableHeader header = parse_header(line);
    header.line = number;
    header.text = line;
    if (!header.columns.complete()) {
      take_unit(line, number);
      if (header.names.size() >= 3 && !row_behind_word) {
        head_.names = header.names.size();
        head_.unused = std::move(header);
      }
      return;
    }
    head_.style.leading_words = true;
    if (head_.headers.size() > kMostHeaders) head_.headers.erase(head_.headers.begin(), head_.headers.begin() + 2);
    TableHeader apart = parse_header(line, false);
    if (apart.columns.complete() && apart.names.size() != header.names.size()) {
      apart.line = number;
      apart.text = line;
      head_.headers.push_back(std::move(apart));
    }
    head_.headers.push_back(std::move(header));
  }

  [[nodiscard]] bool is_row_behind_a_word(std::string_view line) const {
    TableStyle style = head_.style;
    style.leading_words = true;
    TableRow row;
    (void)parse_table_row(line, style, row);
    return row.has_number(1) && row.has_number(2);
  }

  /// "3", then a name a line, as geostatistics' programs write it.
  void take_listed_names(const TableRow& row, int line) {
    if (listed_ < 3 || list_.size() != listed_ || row.count != listed_) return;
    TableHeader header = header_of_lines(list_);
    header.line = line;
    head_.listed_names = true;
    if (header.columns.complete()) head_.headers.push_back(std::move(header));
  }

  const ScanFile& file_;
  TableHead head_;
  std::size_t listed_ = 0;  ///< names that may follow, a line each
  std::vector<std::string_view> list_;
};

}  // namespace

bool is_count(const TableRow& row) {
  return row.count == 1 && row.words[0].empty() && row.values[0] >= 0.0 && row.values[0] < 9e15 &&
         row.values[0] == static_cast<double>(static_cast<std::int64_t>(row.values[0]));
}

TableHead read_head(const ScanFile& file) { return Collector(file).read(); }

}  // namespace sparsha::pipeline
