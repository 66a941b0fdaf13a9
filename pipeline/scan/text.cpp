#include "pipeline/scan/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>

#include "base/text/utf8.h"
#include "pipeline/scan/look_alikes.h"

namespace sparsha::pipeline {
namespace {

constexpr std::array<double, 23> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                                 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr std::uint64_t kExactMantissa = std::uint64_t{1} << 53;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Matches `word` (lower case) at p in any case.
const char* match(const char* p, const char* end, std::string_view word) {
  if (static_cast<std::size_t>(end - p) < word.size()) return nullptr;
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (lower(p[i]) != word[i]) return nullptr;
  }
  return p + word.size();
}

const char* parse_special(const char* p, const char* end, double& value) {
  for (const std::string_view word : {"infinity", "inf", "1.#inf"}) {
    if (const char* q = match(p, end, word)) {
      value = std::numeric_limits<double>::infinity();
      return q;
    }
  }
  for (const std::string_view word : {"nan", "1.#qnan", "1.#snan", "1.#ind"}) {
    if (const char* q = match(p, end, word)) {
      value = std::numeric_limits<double>::quiet_NaN();
      if (q < end && *q == '(') {
        const void* close = std::memchr(q, ')', static_cast<std::size_t>(end - q));
        if (close != nullptr) q = static_cast<const char*>(close) + 1;
      }
      return q;
    }
  }
  return nullptr;
}

/// Tells which way an unsigned number is out of a double's range: by the place of its first digit that is not zero.
bool is_tiny(const char* p, const char* end) {
  const char* const letter = std::find_if(p, end, [](char c) { return lower(c) == 'e'; });
  const char* const point = std::find(p, letter, '.');
  const char* const digit = std::find_if(p, letter, [](char c) { return c >= '1' && c <= '9'; });
  const std::ptrdiff_t place = digit < point ? point - digit : point - digit + 1;  // tenths are 0
  const bool down = letter + 1 < end && letter[1] == '-';
  std::ptrdiff_t power = 0;
  for (const char* q = letter + 1; q < end; ++q) {
    if (is_digit(*q) && power < (std::ptrdiff_t{1} << 40)) power = power * 10 + (*q - '0');
  }
  return place + (down ? -power : power) < 0;
}

/// Correctly rounded value of the unsigned number in [p, end), for those the quick way cannot do.
double slow_value(const char* p, const char* end) {
  double value = 0.0;
  std::string copy;
  for (const char* q = p; q < end; ++q) {
    if (lower(*q) == 'd') {  // Fortran's exponent letter
      copy.assign(p, end);
      copy[static_cast<std::size_t>(q - p)] = 'e';
      p = copy.data();
      end = p + copy.size();
      break;
    }
  }
  // from_chars knows no '+' in front of the digits, but takes one in the exponent.
  const auto [stop, error] = std::from_chars(p, end, value);
  if (error == std::errc::result_out_of_range) {
    return is_tiny(p, end) ? 0.0 : std::numeric_limits<double>::infinity();
  }
  return value;
}

/// Letters are shown. What looks like a blank, a sign or nothing at all has to be named.
bool is_letter(std::uint32_t code) {
  const bool european = code >= 0xC0 && code < 0x530 && code != 0xD7 && code != 0xF7;
  return european || (code >= 0x3040 && code < 0xD7A4);
}

std::string code_of(std::uint32_t code) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "<U+%04X>", static_cast<unsigned>(code));
  return text.data();
}

}  // namespace

const char* parse_number(const char* p, const char* end, double& value) {
  bool negative = false;
  if (p < end && (*p == '-' || *p == '+')) negative = *p++ == '-';
  const char* const first = p;
  std::uint64_t mantissa = 0;
  int exponent = 0;
  bool exact = true;
  int digits = 0;
  for (; p < end && is_digit(*p); ++p, ++digits) {
    exact = exact && mantissa < kExactMantissa;
    mantissa = mantissa * 10 + static_cast<std::uint64_t>(*p - '0');
  }
  if (p < end && *p == '.') {
    const char* const point = p++;
    for (; p < end && is_digit(*p); ++p, ++digits) {
      exact = exact && mantissa < kExactMantissa;
      mantissa = mantissa * 10 + static_cast<std::uint64_t>(*p - '0');
      --exponent;
    }
    if (p < end && *p == '#') digits = 0;
    if (digits == 0) p = point;
  }
  if (digits == 0) {
    const char* const stop = parse_special(first, end, value);
    if (stop != nullptr && negative) value = -value;
    return stop;
  }
  if (p < end && (lower(*p) == 'e' || lower(*p) == 'd')) {
    const char* q = p + 1;
    bool down = false;
    if (q < end && (*q == '-' || *q == '+')) down = *q++ == '-';
    if (q < end && is_digit(*q)) {
      int power = 0;
      for (; q < end && is_digit(*q); ++q) power = power < 100000 ? power * 10 + (*q - '0') : power;
      exponent += down ? -power : power;
      p = q;
    }
  }
  if (exact && mantissa <= kExactMantissa && exponent >= -22 && exponent <= 22) {
    // Both factors are exact doubles, so one correctly rounded operation gives the correctly rounded number.
    const double m = static_cast<double>(mantissa);
    value = exponent < 0 ? m / kPowersOfTen[static_cast<std::size_t>(-exponent)]
                         : m * kPowersOfTen[static_cast<std::size_t>(exponent)];
  } else {
    value = slow_value(first, p);
  }
  if (negative) value = -value;
  return p;
}

const char* parse_integer(const char* p, const char* end, std::int64_t& value) {
  if (p < end && *p == '+') ++p;
  const auto [stop, error] = std::from_chars(p, end, value);
  return error == std::errc() ? stop : nullptr;
}

std::string_view take_word(std::string_view& text) {
  const char* const end = text.data() + text.size();
  const char* const begin = skip_blanks(text.data(), end);
  const char* stop = begin;
  while (stop < end && !is_blank(*stop)) ++stop;
  text = {stop, static_cast<std::size_t>(end - stop)};
  return {begin, static_cast<std::size_t>(stop - begin)};
}

std::string in_quotes(std::string_view word) {
  constexpr std::size_t kLongest = 32;
  const bool number = are_numbers_but_for_look_alikes(word);
  std::string result = "'";
  std::size_t shown = 0;
  for (; shown < kLongest && !word.empty(); ++shown) {
    const Utf8Character c = first_utf8(word);
    if (c.code >= ' ' && c.code < 127 && c.bytes == 1) {
      result += word.front();
    } else if (c.bytes > 1) {
      result += is_letter(c.code) && !number ? std::string(word.substr(0, c.bytes)) : code_of(c.code);
    } else {
      result += '?';
    }
    word.remove_prefix(std::max<std::size_t>(1, c.bytes));
  }
  if (!word.empty()) result += "...";
  return result + "'";
}

bool has_translated_line_ends(std::string_view bytes) {
  constexpr std::size_t kEnough = 16;
  constexpr std::size_t kLook = std::size_t{1} << 24U;  // one byte in 256 of numbers is a line feed
  bytes = bytes.substr(0, kLook);
  std::size_t found = 0;
  for (std::size_t at = bytes.find('\n'); at != std::string_view::npos; at = bytes.find('\n', at + 1)) {
    if (at == 0 || bytes[at - 1] != '\r') return false;
    ++found;
  }
  return found >= kEnough;
}

bool looks_binary(std::string_view bytes) {
  std::size_t strange = 0;
  const std::string_view head = bytes.substr(0, 4096);
  for (const char c : head) {
    if (c == 0) return true;
    if (static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\r' && c != '\t' && c != '\f' && c != '\v') ++strange;
  }
  return strange * 50 > head.size();
}

namespace {

/// Whether CR alone ends lines as well as LF: parts of several systems' files were joined. By the beginning, as far as
/// it is text.
bool has_both_ends(std::string_view body) {
  constexpr std::size_t kLooked = 1 << 16;
  constexpr std::size_t kShare = 10;  // a few CR within lines are damage
  const std::string_view head = body.substr(0, kLooked);
  std::size_t alone = 0, feeds = 0;
  for (std::size_t i = 0; i < head.size(); ++i) {
    const char c = head[i];
    if (static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\r' && c != '\t' && c != '\f' && c != '\v') break;
    const auto is_end = [&](std::size_t k) { return k < head.size() && (head[k] == '\n' || head[k] == '\r'); };
    if (c == '\n') ++feeds;
    if (c == '\r' && !is_end(i + 1) && (i == 0 || !is_end(i - 1))) ++alone;
  }
  return alone > 0 && kShare * alone >= feeds;
}

}  // namespace

LineReader::LineReader(std::string_view text, std::size_t offset, int lines_before)
    : text_(text), offset_(offset), number_(lines_before), end_('\n') {
  const std::string_view body = text.substr(offset);
  if (body.find('\n') == std::string_view::npos) {
    if (body.find('\r') != std::string_view::npos) end_ = '\r';
  } else if (has_both_ends(body)) {
    end_ = kBoth;
  }
}

std::size_t LineReader::length_of_line(std::string_view rest) const {
  if (end_ != kBoth) return std::min(rest.find(end_), rest.size());
  const auto end = std::find_if(rest.begin(), rest.end(), [](char c) { return c == '\n' || c == '\r'; });
  return static_cast<std::size_t>(end - rest.begin());
}

bool LineReader::next(std::string_view& line) {
  if (offset_ >= text_.size()) return false;
  const std::string_view rest = text_.substr(offset_);
  const std::size_t length = length_of_line(rest);
  line = rest.substr(0, length);
  offset_ += std::min(length + 1, rest.size());
  if (end_ == kBoth && rest.substr(length).starts_with("\r\n")) ++offset_;
  if (end_ == '\n') {  // "\r\n", and what conversions of conversions leave: "\r\r\n", "\n\r"
    while (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    while (!line.empty() && line.front() == '\r') line.remove_prefix(1);
  }
  if (number_ < std::numeric_limits<int>::max()) ++number_;
  return true;
}

std::string printable(std::string_view text) {
  constexpr std::size_t kLongest = 64;
  std::string result(text.substr(0, kLongest));
  std::replace_if(
      result.begin(), result.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; }, '?');
  return text.size() > kLongest ? result + "..." : result;
}

}  // namespace sparsha::pipeline
