#include "pipeline/scan/formats/text/layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "pipeline/scan/formats/text/column_shapes.h"
#include "pipeline/scan/formats/text/file_rows.h"
#include "pipeline/scan/formats/text/first_lines.h"
#include "pipeline/scan/formats/text/header.h"
#include "pipeline/scan/formats/text/raster_indices.h"
#include "pipeline/scan/formats/text/row_style.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

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
  explicit Inspector(const ScanFile& file) : file_(file), head_(read_head(file)) {
    layout_.style = head_.style;
    layout_.listed_names = head_.listed_names;
    layout_.unit_remark = head_.unit_remark;
    layout_.unit_line = head_.unit_line;
    if (!head_.rows.empty()) layout_.first_row = head_.row_lines.front();
  }

  TableLayout inspect() {
    if (head_.rows.empty()) {
      if (!head_.declared_empty) refuse_without_rows();
      layout_.empty = true;
      return std::move(layout_);
    }
    if (are_commas_ambiguous(head_.rows, head_.headers.empty() ? head_.names : head_.headers.back().names.size())) {
      throw file_.error_at(layout_.first_row,
                           "commas stand both between columns and for decimal points, so that nobody can tell which is "
                           "which in " +
                               in_quotes(head_.rows.front()),
                           "points as decimal signs, or semicolons, tabs or blanks between the columns");
    }
    if (are_thousands_spaced(head_.rows, layout_.style.decimal_comma)) {
      throw file_.error_at(layout_.first_row,
                           "blanks part the thousands of numbers in " + in_quotes(head_.rows.front()),
                           "numbers without separators of thousands");
    }
    separators_ = possible_separators(head_.rows, layout_.style.decimal_comma, !file_.columns.empty());
    if (!file_.columns.empty()) {
      take_configured();
    } else if (!take_named()) {
      take_unnamed();
    }
    return std::move(layout_);
  }

 private:
  [[noreturn]] void refuse_without_rows() const {
    if (std::count(head_.words.begin(), head_.words.end(), '|') >= 2) {
      throw file_.error_at(head_.first_words, "the values of " + in_quotes(head_.words) + " stand between bars",
                           "blanks, tabs, commas or semicolons between the columns");
    }
    const bool names_alone = !head_.headers.empty() && !head_.headers.front().prose &&
                             (head_.first_words == 0 || head_.headers.front().line == head_.first_words);
    if (names_alone) throw file_.empty("the file names its columns and has no rows", "lines 'x y z'");
    if (head_.first_words > 0) {
      throw file_.error_at(head_.first_words, "no rows of numbers; " + in_quotes(head_.words) + " is none",
                           std::string("lines 'x y z'; for rows that begin with names, ") + kRemedy);
    }
    throw file_.empty("no rows of numbers", "lines 'x y z'");
  }

  [[nodiscard]] std::vector<TableRow> sample(char separator) {
    layout_.style.separator = separator;
    std::vector<TableRow> rows;
    rows.reserve(head_.rows.size());
    sampled_lines_.clear();
    for (std::size_t k = 0; k < head_.rows.size(); ++k) {
      rows.emplace_back();
      sampled_lines_.push_back(head_.row_lines[k]);
      if (parse_table_row(head_.rows[k], layout_.style, rows.back()) == RowKind::numbers) continue;
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
      const std::optional<HeaderPlace> place = find_header(rows, separator, kDamagedRows, header);
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
    for (auto each = head_.headers.rbegin(); each != head_.headers.rend(); ++each) {
      const std::optional<HeaderPlace> place = place_header(*each, rows, separator, damaged);
      if (!place || (best && (best->exact || !place->exact))) continue;
      best = place;
      header = &*each;
    }
    return best;
  }

  [[nodiscard]] bool take_named() {
    for (const double damaged : {0.0, kDamagedRows}) {
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
    if (head_.headers.empty() || head_.headers.back().comment || head_.headers.back().prose) return false;
    for (const char separator : separators_) {
      const std::vector<TableRow> rows = sample(separator);
      if (is_wrong_separator(separator, rows)) continue;
      HeaderPlace place;
      place.exact = true;
      take_header(head_.headers.back(), place, rows);
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
      throw file_.error_at(header.line, "the header names a coordinate twice",
                           "x, y and z once each, or 'columns' of the scan in the configuration");
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
      std::vector<TableRow> rows = sample(separator);
      if (is_wrong_separator(separator, rows)) continue;
      keep_first_table(rows);
      const bool pts = file_.extension == "pts";
      layout_.columns = guess_columns(rows, pts);
      if (layout_.columns.numbered && !counts_all_rows()) layout_.columns = columns_by_position(rows, pts);
      if (has_raster_indices(rows)) layout_.columns = columns_behind_indices(rows, RasterIndices::kBehind);
      refuse_no_table(rows);
      speak_of_header();
      warn_of_unused_header(rows);
      if (head_.left_out > 0) {
        layout_.columns.warnings.push_back(
            "line " + std::to_string(head_.first_left_out) + " begins with a word and is left out" +
            (head_.left_out > 1 ? ", as " + std::to_string(head_.left_out - 1) + " more" : ""));
      }
      if (hold_coordinates(layout_.columns, rows)) return;
    }
    layout_.style.separator = 0;
  }

  /// Of tables that were joined, the rows of the first: others follow where their rows begin.
  static void keep_first_table(std::vector<TableRow>& rows) {
    constexpr std::size_t kRows = 20;  // of each, as for those that follow
    const auto run = [&](std::size_t from) {
      std::size_t to = from;
      while (to < rows.size() && rows[to].count == rows[from].count) ++to;
      return to;
    };
    const std::size_t first = run(0);
    if (first < kRows || first == rows.size() || rows.front().count < 3 || rows[first].count < 3) return;
    // Numbers of points in front of the first part alone would become x: that stays an error.
    const std::vector<TableRow> part(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(first));
    if (run(first) - first >= kRows && !counts_rows(part, 0)) rows.resize(first);
  }

  /// What has numbers in rows, but no coordinates in them.
  void refuse_no_table(const std::vector<TableRow>& rows) const {
    if (layout_.columns.by == TextTable::By::names) return;
    if (look_like_poses(rows, layout_.columns.usual)) {
      throw file_.error_at(
          layout_.first_row,
          "rows of a time, a place and a quaternion are the path of a scanner, and no points of a surface",
          "the scan itself, or 'columns: [skip, x, y, z]' of the scan in the configuration where the "
          "places are its points");
    }
    const TableHeader& header = head_.unused;
    const bool says_something = head_.headers.empty() && header.names.size() == layout_.columns.usual && !header.prose;
    if (!says_something && layout_.columns.by == TextTable::By::shape) return;
    if (says_something) {
      const std::string why = why_no_coordinates(header.names, header.units);
      if (!why.empty()) throw file_.error_at(header.line, "the header names " + why, kRemedy);
    } else if (head_.headers.empty() && looks_like_matrix(rows, layout_.columns.usual)) {
      throw file_.error_at(layout_.first_row,
                           "rows of " + std::to_string(layout_.columns.usual) +
                               " numbers that go on from one to the next are a matrix of heights, and no points",
                           "an ESRI ASCII grid, with lines 'ncols', 'nrows', 'xllcorner', 'yllcorner' and 'cellsize' "
                           "before the rows, or 'columns' of the scan in the configuration");
    }
  }

  /// A header that was not understood is one.
  void speak_of_header() {
    constexpr std::string_view kWithout = "without a header";
    if (head_.names < 3 && head_.headers.empty()) return;
    for (std::vector<std::string>* said : {&layout_.columns.warnings, &layout_.columns.notes}) {
      for (std::string& sentence : *said) {
        if (sentence.starts_with(kWithout))
          sentence.replace(0, kWithout.size(), "the header does not name x, y and z once each;");
      }
    }
  }

  void warn_of_unused_header(const std::vector<TableRow>& rows) {
    TableColumns& columns = layout_.columns;
    if (columns.by != TextTable::By::position) return;
    if (!head_.headers.empty() && head_.headers.back().prose) return;
    const std::size_t names = head_.headers.empty() ? head_.names : head_.headers.back().names.size();
    if (!head_.headers.empty()) {
      columns.warnings.push_back("the header names " + std::to_string(names) + " columns, the rows have " +
                                 std::to_string(columns.usual) + "; the first three are taken as x, y and z");
    } else if (names >= 3 && names == columns.usual) {
      columns.warnings.emplace_back("the header does not name x, y and z once each; the first three columns are taken");
    } else if (const std::size_t whole = whole_before_fractions(rows, columns.usual); names == 0 && whole > 0) {
      columns.warnings.push_back(std::string(whole == 1   ? "the first column holds"
                                             : whole == 2 ? "the first two columns hold"
                                                          : "the first three columns hold") +
                                 " whole numbers and the three behind them fractions, as numbers, classes or colours "
                                 "stand before coordinates; "
                                 "name the columns in the configuration, for example 'columns: [" +
                                 (whole == 1   ? "skip, x"
                                  : whole == 2 ? "skip, skip, x"
                                               : "red, green, blue, x") +
                                 ", y, z]', if it is so");
    }
  }

  /// Whether the whole numbers in front of all rows rise by one.
  [[nodiscard]] bool counts_all_rows() const {
    LineReader lines(file_.bytes);
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

  /// Whether rows and columns of a grid stand in front of the coordinates, which nothing names.
  [[nodiscard]] bool has_raster_indices(const std::vector<TableRow>& sample) const {
    const TableColumns& columns = layout_.columns;
    if (columns.by != TextTable::By::position || !head_.headers.empty() || head_.names > 0) return false;
    for (const std::size_t fast : {1U, 0U}) {
      if (may_have_raster_indices(sample, columns.usual, fast) && runs_along_grid(fast)) return true;
    }
    return false;
  }

  [[nodiscard]] bool runs_along_grid(std::size_t fast) const {
    RasterIndices indices(fast);
    return for_each_row(file_, layout_.style, [&](const TableRow& row) { return indices.add(row); }) && indices.found();
  }

  const ScanFile& file_;
  TableHead head_;
  TableLayout layout_;
  std::vector<int> sampled_lines_;  ///< of the sample taken last
  std::vector<char> separators_;
};

}  // namespace

TableLayout inspect_table(const ScanFile& file) { return Inspector(file).inspect(); }

}  // namespace sparsha::pipeline
