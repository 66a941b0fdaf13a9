#include "pipeline/scan/formats/text/rows.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "base/text/lower_case.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// True when the comma at `p` stands between two digits of a row [begin, end).
bool is_within_digits(const char* begin, const char* p, const char* end) {
  return p > begin && p + 1 < end && is_digit(p[-1]) && is_digit(p[1]);
}

/// A number in [p, end) whose decimal point may be a comma.
const char* number_at(const char* p, const char* end, bool decimal_comma, double& value) {
  if (!decimal_comma) return parse_number(p, end, value);
  std::array<char, 64> copy{};
  const auto length = std::min<std::size_t>(static_cast<std::size_t>(end - p), copy.size());
  for (std::size_t i = 0; i < length; ++i) {
    copy[i] = p[i] == ',' && is_within_digits(p, p + i, end) ? '.' : p[i];
  }
  const char* const stop = parse_number(copy.data(), copy.data() + length, value);
  return stop == nullptr ? nullptr : p + (stop - copy.data());
}

std::string_view trimmed(const char* begin, const char* end) {
  begin = skip_blanks(begin, end);
  while (end > begin && is_blank(end[-1])) --end;
  return {begin, static_cast<std::size_t>(end - begin)};
}

/// What programs write where they have no number, in any case.
bool stands_for_nothing(std::string_view word) {
  constexpr std::string_view kWords[] = {
      "na",  "n/a",     "#n/a",  "n.a.", "n.d.",    "null",      "<null>", "none",    "nil",    "\\n",    "nodata",
      "n/d", "no data", "blank", "void", "missing", "undefined", "empty",  "no_data", "-",      "--",     "---",
      "*",   "?",       ".",     "..",   "...",     "#value!",   "#num!",  "#ref!",   "#name?", "#null!", "#div/0!"};
  constexpr std::size_t kLongest = 9;
  if (word.size() > kLongest) return false;
  return std::find(std::begin(kWords), std::end(kWords), lower_case(word)) != std::end(kWords);
}

/// A semicolon opens a comment when no other follows and no number: else it parts columns, of which the first is empty.
bool is_comment(const char* p, const char* end) {
  if (*p == '#' || *p == '%' || *p == '!' || (*p == '/' && p + 1 < end && p[1] == '/')) return true;
  if (*p != ';') return false;
  const char* const next = skip_blanks(p + 1, end);
  double value = 0.0;
  return next < end && *next != ',' && parse_number(next, end, value) == nullptr &&
         std::memchr(next, ';', static_cast<std::size_t>(end - next)) == nullptr;
}

/// Collects the values of one line.
class Fields {
 public:
  Fields(std::string_view line, const TableStyle& style, TableRow& row)
      : begin_(line.data()), end_(line.data() + line.size()), style_(style), row_(row) {}

  /// From `p` on, where something stands.
  RowKind split(const char* p) {
    const bool first_may_be_a_word = style_.leading_words;
    for (bool more = true; more;) {
      value_ = kNaN;
      word_ = {};
      p = style_.separator != 0 ? separated(p, more) : loose(p, more);
      if (!word_.empty() && row_.count == 0 && !first_may_be_a_word) return RowKind::words;
      store();
    }
    if (any_number_) return RowKind::numbers;
    return any_word_ ? RowKind::words : RowKind::blank;  // spreadsheets write empty rows as separators alone
  }

 private:
  void store() {
    any_number_ = any_number_ || is_number_;
    any_word_ = any_word_ || !word_.empty();
    is_number_ = false;
    if (row_.count == kMostColumns) {
      ++row_.beyond;
      return;
    }
    row_.values[row_.count] = value_;
    row_.words[row_.count] = word_;
    ++row_.count;
  }

  void take(std::string_view text) {
    const char* const stop = number_at(text.data(), text.data() + text.size(), style_.decimal_comma, value_);
    if (stop == text.data() + text.size()) {
      is_number_ = !text.empty();
      return;
    }
    value_ = kNaN;
    if (!stands_for_nothing(text)) word_ = text;
  }

  [[nodiscard]] const char* skip_to_value(const char* p) const {
    while (p < end_ && is_blank(*p) && *p != style_.separator) ++p;
    return p;
  }

  /// The value at `p` and what follows its separator; `more` when there is one.
  const char* separated(const char* p, bool& more) {
    const auto after = [&](const char* stop) {
      more = stop < end_;
      return more ? stop + 1 : stop;
    };
    const auto ends_at = [&](const char* q) { return q == end_ || *q == style_.separator; };
    p = skip_to_value(p);
    if (p < end_ && *p == '"') {
      const void* const close = std::memchr(p + 1, '"', static_cast<std::size_t>(end_ - p - 1));
      if (close != nullptr) {
        const char* const quote = static_cast<const char*>(close);
        const char* const next = skip_to_value(quote + 1);
        if (ends_at(next)) {
          take(trimmed(p + 1, quote));
          return after(next);
        }
      }
    } else if (p < end_) {
      const bool decimal = style_.decimal_comma && style_.separator != ',';
      const char* const stop = number_at(p, end_, decimal, value_);
      if (stop != nullptr) {
        const char* const next = skip_to_value(stop);
        if (ends_at(next)) {
          is_number_ = true;
          return after(next);
        }
      }
    }
    value_ = kNaN;
    const void* const found = p < end_ ? std::memchr(p, style_.separator, static_cast<std::size_t>(end_ - p)) : nullptr;
    const char* const stop = found != nullptr ? static_cast<const char*>(found) : end_;
    const std::string_view text = trimmed(p, stop);
    if (!stands_for_nothing(text)) word_ = text;
    return after(stop);
  }

  [[nodiscard]] bool is_comma(const char* p) const {
    return *p == ';' || (*p == ',' && !(style_.decimal_comma && is_within_digits(begin_, p, end_)));
  }
  static bool is_space(char c) { return is_blank(c) || c == '"'; }
  [[nodiscard]] const char* skip_spaces(const char* p) const {
    while (p < end_ && is_space(*p)) ++p;
    return p;
  }

  /// A value in quotes at `p`; null when the quote opens none: some programs put whole rows in quotes.
  const char* quoted(const char* p) {
    const void* const close = std::memchr(p + 1, '"', static_cast<std::size_t>(end_ - p - 1));
    if (close == nullptr) return nullptr;
    const char* const quote = static_cast<const char*>(close);
    const std::string_view text = trimmed(p + 1, quote);
    take(text);
    double value = 0.0;
    if (!word_.empty() && number_at(text.data(), text.data() + text.size(), style_.decimal_comma, value) != nullptr) {
      word_ = {};
      return nullptr;
    }
    return quote + 1;
  }

  /// The same where any blanks, commas and semicolons part values.
  const char* loose(const char* p, bool& more) {
    p = skip_blanks(p, end_);
    const char* behind = p;
    bool done = false;
    if (p < end_ && *p == '"') {
      behind = quoted(p);
      done = behind != nullptr;
      if (!done) behind = p = skip_spaces(p);
    }
    if (!done && p < end_ && !is_comma(p)) {
      const char* const stop = number_at(p, end_, style_.decimal_comma, value_);
      if (stop != nullptr && (stop == end_ || is_space(*stop) || is_comma(stop))) {
        behind = stop;
        is_number_ = true;
      } else {
        while (behind < end_ && !is_space(*behind) && !is_comma(behind)) ++behind;
        value_ = kNaN;
        const std::string_view text(p, static_cast<std::size_t>(behind - p));
        if (!stands_for_nothing(text)) word_ = text;
      }
    }
    behind = skip_spaces_before_quotes(behind);
    more = behind < end_;
    if (more && is_comma(behind)) ++behind;  // one at the end leaves an empty field
    return behind;
  }
  /// Up to the next value, the quote that opens it, or separator.
  [[nodiscard]] const char* skip_spaces_before_quotes(const char* p) const {
    const char* q = skip_blanks(p, end_);
    if (q < end_ && *q == '"' && q == p) q = skip_blanks(q + 1, end_);  // closes a row in quotes
    return q;
  }

  const char* begin_;
  const char* end_;
  const TableStyle& style_;
  TableRow& row_;
  double value_ = kNaN;
  std::string_view word_;
  bool is_number_ = false;
  bool any_number_ = false;
  bool any_word_ = false;
};

}  // namespace

std::string_view overflow_in(std::string_view text) {
  constexpr std::string_view kBetween = " \t\r\",;", kNumber = "0123456789+-.eEdD*";
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(kBetween), text.size()));
    if (text.empty()) return {};
    const std::string_view word = text.substr(0, text.find_first_of(kBetween));
    if (word.find("**") != std::string_view::npos && word.find_first_not_of(kNumber) == std::string_view::npos)
      return word;
    text.remove_prefix(word.size());
  }
}

RowKind parse_table_row(std::string_view line, const TableStyle& style, TableRow& row) {
  row.count = row.beyond = 0;
  const char* const end = line.data() + line.size();
  const char* const p = skip_blanks(line.data(), end);
  if (p == end) return RowKind::blank;
  if (is_comment(p, end)) return RowKind::comment;
  return Fields(line, style, row).split(line.data());
}

}  // namespace sparsha::pipeline
