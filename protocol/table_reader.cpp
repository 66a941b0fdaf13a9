#include "protocol/table_reader.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/text/csv.h"
#include "base/text/text.h"

namespace sparsha::protocol {
namespace {

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

/// The inside of a field in quotes that begins `line`, which loses it with its comma; nothing when there is none. A
/// quote in it is written twice and stays so.
std::optional<std::string_view> take_quoted(std::string_view& line) {
  const std::size_t first = line.find_first_not_of(" \t");
  if (first == std::string_view::npos || line[first] != '"') return std::nullopt;
  std::size_t close = line.find('"', first + 1);
  while (close != std::string_view::npos && line.substr(close + 1).starts_with('"')) close = line.find('"', close + 2);
  if (close == std::string_view::npos) return std::nullopt;
  std::string_view rest = line.substr(close + 1);
  if (!csv::trimmed(csv::take_field(rest)).empty()) return std::nullopt;
  const std::string_view inside = line.substr(first + 1, close - first - 1);
  line = rest;
  return inside;
}

/// The fields of a line; of more than `most` the first ones. Returns how many there are.
std::size_t split(std::string_view line, std::size_t most, std::vector<std::string_view>& fields) {
  fields.clear();
  for (std::size_t count = 1;; ++count) {
    const std::string_view before = line;
    const std::optional<std::string_view> quoted = take_quoted(line);
    const std::string_view field = quoted ? *quoted : csv::take_field(line);
    if (count <= most) fields.push_back(field);
    if (!before.substr(0, before.size() - line.size()).ends_with(',')) return count;
  }
}

}  // namespace

TableReader::TableReader(const std::filesystem::path& file, const std::vector<std::string>& columns,
                         const std::vector<std::string>& optional)
    : name_(file.string()), mapped_(file), rest_(mapped_.text()) {
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
  if (csv::trimmed(rest_.substr(0, 1)).empty() && rest_.find_first_not_of(" \t\r\n") == std::string_view::npos)
    throw input_error(name_, "the file is empty", "a header with the columns " + listed(columns));
  line_ = 1;
  const std::string_view header = csv::take_line(rest_);
  constexpr std::size_t kMostColumns = 1000;
  count_ = split(header, kMostColumns, fields_);
  if (count_ > kMostColumns)
    throw input_error_at(name_, 1, "the header has " + std::to_string(count_) + " columns", "1000 at most");
  std::vector<std::string> asked = columns;
  asked.insert(asked.end(), optional.begin(), optional.end());
  place_.assign(asked.size(), kAbsent);
  for (std::size_t field = 0; field < count_; ++field) {
    const auto column = static_cast<int>(fields_[field].data() - header.data()) + 1;
    const std::string_view word = csv::trimmed(fields_[field]);
    const auto found = std::find(asked.begin(), asked.end(), word);
    if (found == asked.end()) continue;
    std::size_t& place = place_[static_cast<std::size_t>(found - asked.begin())];
    if (place != kAbsent)
      throw Error(ErrorKind::input, {name_, 1, column}, "column " + *found + " a second time", "each column once");
    place = field;
  }
  for (std::size_t k = 0; k < columns.size(); ++k)
    if (place_[k] == kAbsent) throw input_error_at(name_, 1, "the header has no column " + columns[k], listed(columns));
}

bool TableReader::next() {
  ++line_;
  if (rest_.find_first_not_of(" \t\r\n") == std::string_view::npos) return false;
  row_ = csv::take_line(rest_);
  const std::size_t count = split(row_, count_, fields_);
  if (count != count_)
    throw wrong_row("the row has " + count_text(count) + (count == 1 ? " field" : " fields"),
                    count_text(count_) + ", as many as the header");
  return true;
}

double TableReader::number(std::size_t column, const std::string& meaning, double limit) const {
  double value = 0.0;
  if (!csv::to_number(word(column), value))
    throw wrong_at(column, csv::in_quotes(csv::trimmed(word(column))) + " is not a number", meaning);
  if (!std::isfinite(value))
    throw wrong_at(column, csv::in_quotes(csv::trimmed(word(column))) + " is not finite", meaning);
  if (std::abs(value) > limit)
    throw wrong_at(column, csv::in_quotes(csv::trimmed(word(column))) + " is out of range",
                   meaning + " of at most " + value_text(limit) + " in size");
  return value;
}

Error TableReader::wrong_at(std::size_t column, std::string wrong, std::string expected) const {
  const auto at = static_cast<int>(word(column).data() - row_.data()) + 1;
  return Error(ErrorKind::input, {name_, line_, at}, std::move(wrong), std::move(expected));
}

Error TableReader::wrong_row(std::string wrong, std::string expected) const {
  return Error(ErrorKind::input, {name_, line_, 1}, std::move(wrong), std::move(expected));
}

}  // namespace sparsha::protocol
