#include "pipeline/scan/formats/text/layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "pipeline/scan/formats/text/table_header.h"
#include "pipeline/scan/formats/text/table_style.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kSampledBytes = 1 << 20;
constexpr std::size_t kMostHeaders = 64;
constexpr double kDamaged = 0.1;  // share of rows that may be wrong below a header that is right
constexpr const char* kRemedy = "a header that names x, y and z, or 'columns' of the scan in the configuration";

/// True for text before the first row, though there are numbers in it: it begins with a word and has none in place of
/// any coordinate.
bool is_title(const TableRow& row, const TableColumns& columns) {
  const auto has_number = [&](int column) { return row.has_number(column); };
  const std::array<int, 3> xyz = {columns.x, columns.y, columns.z};
  return row.has_word(0) && std::none_of(xyz.begin(), xyz.end(), has_number);
}

constexpr const char* kMost = "coordinates among the first 64 columns";
static_assert(kMostColumns == 64);

class Inspector {
 public:
  explicit Inspector(const ScanFile& file) : file_(file), begin_(byte_order_mark(file.bytes)) {}

  TableLayout inspect() {
    judge_commas();
    collect();
    if (rows_.empty()) {
      if (!declared_empty_) refuse_without_rows();
      layout_.empty = true;
      return std::move(layout_);
    }
    if (are_commas_ambiguous(rows_, headers_.empty() ? names_ : headers_.back().names.size())) {
      throw file_.error_at(layout_.first_row,
                           "commas stand both between columns and for decimal points, so that nobody can tell which is "
                           "which in " +
                               in_quotes(rows_.front()),
                           "points as decimal signs, or semicolons, tabs or blanks between the columns");
    }
    separators_ = possible_separators(rows_, layout_.style.decimal_comma, !file_.columns.empty());
    if (!file_.columns.empty()) {
      take_configured();
    } else if (!take_named()) {
      take_unnamed();
    }
    return std::move(layout_);
  }

 private:
  /// What commas are, by the vote of the first rows that have some.
  void judge_commas() {
    LineReader lines(file_.bytes, begin_);
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
    layout_.style.decimal_comma = decimal > others;
  }

  /// The lines of the header and the first rows; of several counted blocks, those of the first.
  void collect() {
    TableStyle& style = layout_.style;
    style.leading_words = !file_.columns.empty();
    LineReader lines(file_.bytes, begin_);
    std::string_view line;
    TableRow row;
    bool counted = false;
    while (rows_.size() < kSampledRows && lines.next(line)) {
      const RowKind kind = parse_table_row(line, style, row);
      if (kind == RowKind::numbers && is_count(row)) {
        if (counted && !rows_.empty()) break;
        counted = counted || rows_.empty();
        declared_empty_ = declared_empty_ || row.values[0] == 0.0;
        listed_ = row.values[0] <= static_cast<double>(kMostColumns) ? static_cast<std::size_t>(row.values[0]) : 0;
        list_.clear();
      } else if (kind == RowKind::numbers) {
        if (rows_.empty()) {
          layout_.first_row = lines.number();
          take_listed_names(row, lines.number());
        }
        rows_.push_back(line);
        row_lines_.push_back(lines.number());
      } else if (kind != RowKind::blank && rows_.empty()) {
        header_line(line, lines.number(), kind);
      }
    }
  }

  void header_line(std::string_view line, int number, RowKind kind) {
    if (kind == RowKind::words && first_words_ == 0) {
      first_words_ = number;
      words_ = line;
    }
    const bool row_behind_word = kind == RowKind::words && is_row_behind_a_word(line);
    if (row_behind_word && left_out_++ == 0) first_left_out_ = number;
    if (kind == RowKind::words && listed_ > 0 && list_.size() < listed_) list_.push_back(line);
    bool units = false;
    for (TableHeader& header : headers_) {
      units = (header.line == headers_.back().line && add_units_row(line, header)) || units;
    }
    if (units) return;
    TableHeader header = parse_header(line);
    header.line = number;
    header.text = line;
    if (!header.columns.complete()) {
      if (header.names.size() >= 3 && !row_behind_word) names_ = header.names.size();
      return;
    }
    layout_.style.leading_words = true;
    if (headers_.size() > kMostHeaders) headers_.erase(headers_.begin(), headers_.begin() + 2);
    TableHeader apart = parse_header(line, false);
    if (apart.columns.complete() && apart.names.size() != header.names.size()) {
      apart.line = number;
      apart.text = line;
      headers_.push_back(std::move(apart));
    }
    headers_.push_back(std::move(header));
  }

  [[nodiscard]] bool is_row_behind_a_word(std::string_view line) const {
    TableStyle style = layout_.style;
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
    layout_.listed_names = true;
    if (header.columns.complete()) headers_.push_back(std::move(header));
  }

  [[noreturn]] void refuse_without_rows() const {
    if (std::count(words_.begin(), words_.end(), '|') >= 2) {
      throw file_.error_at(first_words_, "the values of " + in_quotes(words_) + " stand between bars",
                           "blanks, tabs, commas or semicolons between the columns");
    }
    if (first_words_ > 0) {
      throw file_.error_at(first_words_, "no rows of numbers; " + in_quotes(words_) + " is none",
                           std::string("lines 'x y z'; for rows that begin with names, ") + kRemedy);
    }
    throw file_.error("no rows of numbers", "lines 'x y z'");
  }

  [[nodiscard]] std::vector<TableRow> sample(char separator) {
    layout_.style.separator = separator;
    std::vector<TableRow> rows;
    rows.reserve(rows_.size());
    sampled_lines_.clear();
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      rows.emplace_back();
      sampled_lines_.push_back(row_lines_[k]);
      if (parse_table_row(rows_[k], layout_.style, rows.back()) == RowKind::numbers) continue;
      rows.pop_back();
      sampled_lines_.pop_back();
    }
    return rows;
  }

  static bool is_wrong_separator(char separator, const std::vector<TableRow>& rows) {
    return rows.empty() || (separator != 0 && hold_rows_in_values(rows));
  }

  void take_configured() {
    if (file_.columns.size() > kMostColumns) throw file_.error("the configuration names too many columns", kMost);
    for (const char separator : separators_) {
      std::vector<TableRow> rows = sample(separator);
      if (is_wrong_separator(separator, rows)) continue;
      layout_.columns = configured_columns(file_.columns, rows);
      const auto is_no_title = [&](const TableRow& row) { return !is_title(row, layout_.columns); };
      const auto first = std::find_if(rows.begin(), rows.end(), is_no_title);
      if (first == rows.end()) continue;
      layout_.first_row = sampled_lines_[static_cast<std::size_t>(first - rows.begin())];
      rows.erase(rows.begin(), first);
      layout_.columns = configured_columns(file_.columns, rows);
      const TableHeader* header = nullptr;
      const std::optional<HeaderPlace> place = find_header(rows, separator, kDamaged, header);
      if (place) compare_with_header(*header, named_columns(*header, *place, rows));
      if (hold_coordinates(layout_.columns, rows)) return;
    }
  }

  /// The configuration is right; where a header says something else, the user should know.
  void compare_with_header(const TableHeader& header, const TableColumns& named) {
    TableColumns& columns = layout_.columns;
    const std::vector<std::string> said = named.words();
    const std::vector<std::string>& wanted = file_.columns;
    std::string differences;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const std::string& name = k < said.size() ? said[k] : wanted[k];
      if (wanted[k] == "skip" || name == wanted[k]) continue;
      const bool is_named = name != "skip" || std::find(said.begin(), said.end(), wanted[k]) != said.end();
      if (!is_named) continue;
      const std::string title = k < named.fields.size() ? named.fields[k] : "";
      differences += (differences.empty() ? "" : ", ") + in_quotes(title) + " as " + wanted[k];
    }
    if (!differences.empty()) {
      columns.warnings.push_back("the header names the columns otherwise; as the configuration says, " + differences +
                                 " is taken");
    }
    if (columns.x == named.x && columns.y == named.y && columns.z == named.z) use_unit(header, named.degrees);
  }

  /// The last header that fits, one with as many names as the rows have values before others.
  std::optional<HeaderPlace> find_header(const std::vector<TableRow>& rows, char separator, double damaged,
                                         const TableHeader*& header) const {
    std::optional<HeaderPlace> best;
    if (rows.empty()) return best;
    for (auto each = headers_.rbegin(); each != headers_.rend(); ++each) {
      const std::optional<HeaderPlace> place = place_header(*each, rows, separator, damaged);
      if (!place || (best && (best->exact || !place->exact))) continue;
      best = place;
      header = &*each;
    }
    return best;
  }

  [[nodiscard]] bool take_named() {
    for (const double damaged : {0.0, kDamaged}) {
      for (const char separator : separators_) {
        const std::vector<TableRow> rows = sample(separator);
        const TableHeader* header = nullptr;
        const std::optional<HeaderPlace> place = find_header(rows, separator, damaged, header);
        if (!place || (!place->exact && is_wrong_separator(separator, rows))) continue;
        take_header(*header, *place, rows);
        return true;
      }
    }
    // A comment may be prose; a line of names right above the rows means them, whatever is wrong below it.
    if (headers_.empty() || headers_.back().comment || headers_.back().prose) return false;
    for (const char separator : separators_) {
      const std::vector<TableRow> rows = sample(separator);
      if (is_wrong_separator(separator, rows)) continue;
      HeaderPlace place;
      place.exact = true;
      take_header(headers_.back(), place, rows);
      return true;
    }
    return false;
  }

  void take_header(const TableHeader& header, const HeaderPlace& place, const std::vector<TableRow>& rows) {
    if (place.ambiguous) {
      throw file_.error_at(
          header.line,
          "the header names " + std::to_string(header.names.size()) + " columns, the rows have " +
              std::to_string(rows.front().count) + " values, and names in them may hold blanks",
          "semicolons, commas or tabs between the columns, or 'columns' of the scan in the configuration");
    }
    if (header.columns.repeated) {
      throw file_.error_at(header.line, "the header names a coordinate twice", "x, y and z once each");
    }
    const auto is_beyond = [](int column) { return column >= static_cast<int>(kMostColumns); };
    if (std::any_of(header.columns.xyz.begin(), header.columns.xyz.end(), is_beyond)) {
      throw file_.error_at(header.line, "the header names x, y or z behind too many columns", kMost);
    }
    layout_.columns = named_columns(header, place, rows);
    layout_.header = header.text;
    use_unit(header, layout_.columns.degrees);
  }

  void use_unit(const TableHeader& header, bool degrees) {
    layout_.columns.degrees = degrees;
    const HeaderUnit unit = unit_of(header);
    if (!unit.several.empty()) {
      throw file_.error_at(header.line, "the header gives the coordinates in several units: " + unit.several,
                           "one unit for x, y and z");
    }
    if (!unit.unknown.empty()) {
      layout_.columns.warnings.push_back("the header gives the coordinates in " + in_quotes(unit.unknown) +
                                         ", which no 'units' can be; they are not converted");
    }
    layout_.unit = unit.unit;
  }

  void take_unnamed() {
    for (const char separator : separators_) {
      const std::vector<TableRow> rows = sample(separator);
      if (is_wrong_separator(separator, rows)) continue;
      const bool pts = file_.extension == "pts";
      layout_.columns = guess_columns(rows, pts);
      if (layout_.columns.numbered && !counts_all_rows()) layout_.columns = columns_by_position(rows, pts);
      warn_of_unused_header();
      if (left_out_ > 0) {
        layout_.columns.warnings.push_back("line " + std::to_string(first_left_out_) +
                                           " begins with a word and is left out" +
                                           (left_out_ > 1 ? ", as " + std::to_string(left_out_ - 1) + " more" : ""));
      }
      if (hold_coordinates(layout_.columns, rows)) return;
    }
    layout_.style.separator = 0;
  }

  void warn_of_unused_header() {
    TableColumns& columns = layout_.columns;
    if (columns.by != TextTable::By::position) return;
    if (!headers_.empty() && headers_.back().prose) return;
    const std::size_t names = headers_.empty() ? names_ : headers_.back().names.size();
    if (!headers_.empty()) {
      columns.warnings.push_back("the header names " + std::to_string(names) + " columns, the rows have " +
                                 std::to_string(columns.usual) + "; the first three are taken as x, y and z");
    } else if (names >= 3 && names == columns.usual) {
      columns.warnings.emplace_back("the header does not name x, y and z once each; the first three columns are taken");
    }
  }

  /// Whether the whole numbers in front of all rows rise by one.
  [[nodiscard]] bool counts_all_rows() const {
    LineReader lines(file_.bytes, begin_, 0);
    std::string_view line;
    TableStyle style = layout_.style;
    TableRow row;
    double last = std::nan("");
    std::size_t seen = 0;
    while (lines.next(line)) {
      if ((++seen & 0xFFFF) == 0) file_.throw_if_cancelled();
      // The number alone: the rest of a row need not be parsed.
      const char* p = skip_blanks(line.data(), line.data() + line.size());
      const char* const end = line.data() + line.size();
      if (p < end && *p == '"') ++p;
      std::int64_t number = 0;
      const char* const stop = parse_integer(p, end, number);
      if (stop == nullptr || (stop < end && *stop == '.')) {
        if (parse_table_row(line, style, row) == RowKind::numbers) return false;
        continue;
      }
      const auto value = static_cast<double>(number);
      if (!std::isnan(last) && value != last + 1.0) return false;
      last = value;
    }
    return true;
  }

  const ScanFile& file_;
  std::size_t begin_;
  TableLayout layout_;
  std::vector<std::string_view> rows_;
  std::vector<int> row_lines_;      ///< their numbers
  std::vector<int> sampled_lines_;  ///< of the sample taken last
  std::vector<char> separators_;
  std::vector<TableHeader> headers_;  ///< lines that name x, y and z, in their order
  std::size_t names_ = 0;             ///< of a header that does not
  std::size_t left_out_ = 0;          ///< lines before the first row that hold numbers behind a word
  int first_left_out_ = 0;
  std::size_t listed_ = 0;  ///< names that may follow, a line each
  std::vector<std::string_view> list_;
  bool declared_empty_ = false;
  int first_words_ = 0;
  std::string_view words_;
};

}  // namespace

bool is_count(const TableRow& row) {
  return row.count == 1 && row.words[0].empty() && row.values[0] >= 0.0 && row.values[0] < 9e15 &&
         row.values[0] == static_cast<double>(static_cast<std::int64_t>(row.values[0]));
}

TableLayout inspect_table(const ScanFile& file) { return Inspector(file).inspect(); }

}  // namespace sparsha::pipeline
