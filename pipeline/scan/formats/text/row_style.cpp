#include "pipeline/scan/formats/text/row_style.h"

#include <algorithm>

#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Counts commas between digits and others of one word between blanks.
struct WordCommas {
  int within = 0;  ///< between two digits
  int others = 0;  ///< elsewhere, one at the end left out
  bool point = false;
};

WordCommas commas_of_word(std::string_view word) {
  WordCommas commas;
  if (!word.empty() && word.back() == ',') word.remove_suffix(1);
  for (std::size_t i = 0; i < word.size(); ++i) {
    commas.point = commas.point || word[i] == '.';
    if (word[i] != ',') continue;
    const bool within = i > 0 && i + 1 < word.size() && is_digit(word[i - 1]) && is_digit(word[i + 1]);
    ++(within ? commas.within : commas.others);
  }
  return commas;
}

/// "4,501,066.72": groups of three digits, and more than one comma or a point to tell them from decimals.
bool has_thousands(std::string_view word) {
  if (!word.empty() && (word.front() == '-' || word.front() == '+')) word.remove_prefix(1);
  const std::string_view whole = word.substr(0, word.find('.'));
  std::size_t commas = 0;
  std::size_t digits = 0;
  for (const char c : whole) {
    if (c == ',') {
      if (digits == 0 || digits > 3 || (commas > 0 && digits != 3)) return false;
      digits = 0;
      ++commas;
    } else if (is_digit(c)) {
      ++digits;
    } else {
      return false;
    }
  }
  return commas > 0 && digits == 3 && (commas > 1 || whole.size() < word.size());
}

/// Three words or more between blanks, each with a number alone, two of them in groups of thousands.
bool are_thousands(std::string_view line) {
  int words = 0;
  int grouped = 0;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line), ++words) {
    if (has_thousands(word)) {
      ++grouped;
    } else if (word.find(',') != std::string_view::npos) {
      return false;
    }
  }
  return words >= 3 && grouped >= 2;
}

/// A number in quotes with a comma between its digits.
bool has_quoted_comma(std::string_view line) {
  for (std::size_t open = line.find('"'); open != std::string_view::npos; open = line.find('"', open + 1)) {
    const std::size_t close = line.find('"', open + 1);
    if (close == std::string_view::npos) return false;
    const std::string_view word = line.substr(open + 1, close - open - 1);
    if (word.find_first_not_of("0123456789+-,") == std::string_view::npos && commas_of_word(word).within == 1)
      return true;
    open = close;
  }
  return false;
}

/// A number in quotes with groups of thousands and a point, or several groups, "1,234.5", in a row that has no three
/// plain numbers beside it: an area may be written so.
bool has_quoted_thousands(std::string_view line) {
  int grouped = 0, plain = 0;
  for (std::size_t begin = 0; begin <= line.size();) {
    const bool quoted = begin < line.size() && line[begin] == '"';
    const std::size_t close = quoted ? std::min(line.find('"', begin + 1), line.size()) : begin;
    const std::size_t end = std::min(line.find_first_of(",;\t", close), line.size());
    const std::string_view word = quoted ? line.substr(begin + 1, close - begin - 1) : line.substr(begin, end - begin);
    double value = 0.0;
    if (quoted && has_thousands(word))
      ++grouped;
    else if (!word.empty() && parse_number(word.data(), word.data() + word.size(), value) == word.data() + word.size())
      ++plain;
    begin = end + 1;
  }
  return grouped > 0 && plain < 3;
}

/// Separators outside quotes.
std::size_t count_separators(std::string_view row, char separator) {
  std::size_t count = 0;
  bool quoted = false;
  for (const char c : row) {
    if (c == '"') quoted = !quoted;
    if (c == separator && !quoted) ++count;
  }
  return count;
}

/// How the values of a column of digits are written.
struct WrittenDigits {
  bool padded = false;  ///< "0200", "00"
  bool sign = false;
};

/// Adds a row's whole numbers before its first word to what is known of the columns; false when a point tells what
/// commas are.
bool add_digits(std::string_view row, std::vector<WrittenDigits>& columns) {
  std::size_t column = 0;
  for (std::size_t begin = 0; begin <= row.size(); ++column) {
    const std::size_t end = std::min(row.find(',', begin), row.size());
    std::string_view field = row.substr(begin, end - begin);
    begin = end + 1;
    while (!field.empty() && is_blank(field.front())) field.remove_prefix(1);
    while (!field.empty() && is_blank(field.back())) field.remove_suffix(1);
    if (column >= columns.size()) columns.emplace_back();
    WrittenDigits& digits = columns[column];
    if (!field.empty() && (field.front() == '-' || field.front() == '+')) {
      digits.sign = true;
      field.remove_prefix(1);
    }
    if (field.find('.') != std::string_view::npos) return false;
    if (field.empty() || !std::all_of(field.begin(), field.end(), is_digit)) return true;
    digits.padded = digits.padded || (field.size() > 1 && field.front() == '0');
  }
  return true;
}

/// A decimal comma that is no separator stands between quotes.
bool has_bare_comma(std::string_view row) {
  return row.find('"') == std::string_view::npos && row.find(',') != std::string_view::npos;
}

/// "1 234", "-12 345 678.9", between quotes too: groups of three digits behind one blank each.
bool is_spaced_number(std::string_view value) {
  const auto is_around = [](char c) { return is_blank(c) || c == '"'; };
  while (!value.empty() && is_around(value.front())) value.remove_prefix(1);
  while (!value.empty() && is_around(value.back())) value.remove_suffix(1);
  if (!value.empty() && (value.front() == '-' || value.front() == '+')) value.remove_prefix(1);
  std::size_t groups = 0;
  for (;;) {
    const std::size_t digits =
        static_cast<std::size_t>(std::find_if_not(value.begin(), value.end(), is_digit) - value.begin());
    if (groups == 0 ? digits < 1 || digits > 3 : digits != 3) return false;
    ++groups;
    value.remove_prefix(digits);
    if (value.empty() || value.front() != ' ') break;
    value.remove_prefix(1);
  }
  const bool ends = value.empty() || value.front() == '.' || value.front() == ',';
  return groups > 1 && ends && std::all_of(value.begin() + (value.empty() ? 0 : 1), value.end(), is_digit);
}

}  // namespace

bool are_thousands_spaced(const std::vector<std::string_view>& rows, bool decimal_comma) {
  constexpr int kCoordinates = 3;
  for (const char separator : {'\t', ';', ','}) {
    if (separator == ',' && decimal_comma && std::any_of(rows.begin(), rows.end(), has_bare_comma)) continue;
    std::size_t spaced = 0;
    for (std::string_view rest : rows) {
      if (count_separators(rest, separator) < 2) {
        spaced = 0;
        break;
      }
      bool any = false;
      std::size_t end = 0;
      for (int field = 0; field < kCoordinates && end != std::string_view::npos && !any; ++field) {
        end = rest.find(separator);
        any = is_spaced_number(rest.substr(0, end));
        if (end != std::string_view::npos) rest.remove_prefix(end + 1);
      }
      spaced += any ? 1 : 0;
    }
    if (2 * spaced > rows.size()) return true;
  }
  return false;
}

Commas commas_of_row(std::string_view line) {
  if (line.find(',') == std::string_view::npos) return Commas::none_or_separators;
  if (has_quoted_thousands(line)) return Commas::thousands;
  if (has_quoted_comma(line)) return Commas::decimal;
  if (line.find(';') != std::string_view::npos) {
    for (std::size_t i = 1; i + 1 < line.size(); ++i) {
      if (line[i] == ',' && is_digit(line[i - 1]) && is_digit(line[i + 1])) return Commas::decimal;
    }
    return Commas::none_or_separators;
  }
  if (are_thousands(line)) return Commas::thousands;
  // Blanks part the values when every word holds one comma at most, and that between digits.
  int words = 0;
  int within = 0;
  bool point = false;
  bool both = false;
  std::string_view rest = line;
  for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
    const WordCommas commas = commas_of_word(word);
    if (commas.within > 1 || commas.others > 0) return Commas::none_or_separators;
    ++words;
    within += commas.within;
    point = point || commas.point;
    both = both || (commas.within == 1 && commas.point);
  }
  if (words < 3 || within == 0) return Commas::none_or_separators;
  if (both) return Commas::thousands;
  return point ? Commas::none_or_separators : Commas::decimal;
}

bool are_commas_ambiguous(const std::vector<std::string_view>& rows, std::size_t names) {
  std::vector<WrittenDigits> columns;
  bool vary = false;
  const std::ptrdiff_t commas = rows.empty() ? 0 : std::count(rows.front().begin(), rows.front().end(), ',');
  for (const std::string_view row : rows) {
    if (row.find(',') == std::string_view::npos || !add_digits(row, columns)) return false;
    vary = vary || std::count(row.begin(), row.end(), ',') != commas;
  }
  if (columns.size() < 4 || columns.size() > kMostColumns) return false;
  // Decimals stand behind a column of whole parts, which have signs but no leading zeros. Whole values without decimals
  // move the others to the left.
  std::size_t decimals = 0;
  for (std::size_t k = 1; k < columns.size(); ++k) {
    const bool behind_whole = !columns[vary ? 0 : k - 1].padded;
    decimals += columns[k].padded && !columns[k].sign && behind_whole ? 1 : 0;
  }
  return decimals >= 2 || (decimals == 1 && columns.size() == 2 * names);
}

std::vector<char> possible_separators(const std::vector<std::string_view>& rows, bool decimal_comma, bool titles) {
  std::vector<char> found;
  const auto is_text = [](std::string_view row) {
    const char* const begin = skip_blanks(row.data(), row.data() + row.size());
    double value = 0.0;
    return parse_number(begin, row.data() + row.size(), value) == nullptr;
  };
  for (const char separator : {'\t', ';', ','}) {
    const auto parts = [&](std::string_view row) { return count_separators(row, separator) >= 2; };
    auto first = rows.begin();
    while (titles && first != rows.end() && !parts(*first) && is_text(*first)) ++first;
    if (first == rows.end() || !std::all_of(first, rows.end(), parts)) continue;
    if (separator == ',' && decimal_comma && std::any_of(rows.begin(), rows.end(), has_bare_comma)) continue;
    found.push_back(separator);
  }
  found.push_back(0);
  return found;
}

bool hold_rows_in_values(const std::vector<TableRow>& rows) {
  std::array<bool, kMostColumns> several{};
  std::array<bool, kMostColumns> other{};
  for (const TableRow& row : rows) {
    for (std::size_t k = 0; k < row.count; ++k) {
      std::string_view rest = row.words[k];
      int numbers = 0;
      bool only_numbers = true;
      for (std::string_view word = take_word(rest); !word.empty() && only_numbers; word = take_word(rest)) {
        double value = 0.0;
        only_numbers = parse_number(word.data(), word.data() + word.size(), value) == word.data() + word.size();
        ++numbers;
      }
      several[k] = several[k] || (only_numbers && numbers > 1);
      other[k] = other[k] || !std::isnan(row.values[k]) || (!row.words[k].empty() && !only_numbers);
    }
  }
  for (std::size_t k = 0; k < kMostColumns; ++k) {
    if (several[k] && !other[k]) return true;
  }
  return false;
}

}  // namespace sparsha::pipeline
