#include "base/text/csv.h"

#include <charconv>
#include <system_error>

namespace sparsha::csv {
namespace {

template <typename Integer>
void append_integer(std::string& row, Integer value) {
  std::array<char, 24> digits;
  row.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
  row.push_back(',');
}

}  // namespace

std::string_view take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::string_view take_field(std::string_view& line) {
  const std::size_t end = line.find(',');
  const std::string_view field = line.substr(0, end);
  line.remove_prefix(end == std::string_view::npos ? line.size() : end + 1);
  return field;
}

std::string_view trimmed(std::string_view field) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = field.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return field.substr(first, field.find_last_not_of(kBlanks) - first + 1);
}

bool to_number(std::string_view field, double& value) {
  field = trimmed(field);
  if (field.size() > 1 && field.front() == '+' && field[1] != '-') field.remove_prefix(1);
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  return error == std::errc() && end == field.data() + field.size();
}

std::string in_quotes(std::string_view field) {
  constexpr std::size_t kLongest = 40;
  return "`" + std::string(field.substr(0, kLongest)) + "`";
}

void append(std::string& row, double value) {
  std::array<char, 40> digits;
  const auto end =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 17).ptr;
  row.append(digits.data(), end);
  row.push_back(',');
}

void append(std::string& row, std::uint64_t value) { append_integer(row, value); }

void append(std::string& row, std::int64_t value) { append_integer(row, value); }

void append(std::string& row, const std::array<double, 3>& values) {
  for (const double value : values) append(row, value);
}

void end_row(std::string& row) { row.back() = '\n'; }

}  // namespace sparsha::csv
