// Numbers and lines of scan files in text, fast and without a terminating zero.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace sparsha::pipeline {

/// Parses the number at `p`: sign, digits, point, exponent (e, E, d, D), inf and nan in any case and in Microsoft's
/// spellings (1.#INF, 1.#QNAN). Correctly rounded. Returns the first character behind it, or null when there is none.
[[nodiscard]] const char* parse_number(const char* p, const char* end, double& value);

/// Parses a decimal integer; null when there is none or it does not fit.
[[nodiscard]] const char* parse_integer(const char* p, const char* end, std::int64_t& value);

[[nodiscard]] inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
[[nodiscard]] inline const char* skip_blanks(const char* p, const char* end) {
  while (p < end && is_blank(*p)) ++p;
  return p;
}
/// The next word between blanks, taken off the front of `text`; empty at the end.
[[nodiscard]] std::string_view take_word(std::string_view& text);
/// A word as it may stand in a message: at most 32 characters, unprintable ones replaced, and those beyond letters that
/// are not ASCII by their code: a minus sign of typesetters is '<U+2212>'. In numbers letters are shown so, too.
[[nodiscard]] std::string in_quotes(std::string_view word);
/// A name for messages, at most 64 characters: what control characters would do to a terminal is nobody's business.
[[nodiscard]] std::string printable(std::string_view text);
/// Length of UTF-8's byte order marks at the beginning of a text; joined or converted twice, it has several.
[[nodiscard]] inline std::size_t byte_order_mark(std::string_view text) {
  std::size_t length = 0;
  while (text.substr(length, 3) == "\xEF\xBB\xBF") length += 3;
  return length;
}
/// True when the bytes cannot be text of a scan: zero bytes or too many control characters among the first 4096.
[[nodiscard]] bool looks_binary(std::string_view bytes);

/// True when every line feed among the bytes follows a carriage return, and there are enough of them to say that this
/// is no chance: binary data that was copied as text.
[[nodiscard]] bool has_translated_line_ends(std::string_view bytes);

/// Walks the lines of a text; ends are LF or CRLF, CR in files without any LF, and all of them where the first 65536
/// bytes have a tenth as many CR alone as LF.
class LineReader {
 public:
  explicit LineReader(std::string_view text, std::size_t offset = 0, int lines_before = 0);
  /// The next line without its end; false behind the last one.
  bool next(std::string_view& line);
  /// Number of the line last returned, from 1.
  [[nodiscard]] int number() const { return number_; }
  /// Where the next line begins in the whole text.
  [[nodiscard]] std::size_t offset() const { return offset_; }

 private:
  static constexpr char kBoth = 0;

  [[nodiscard]] std::size_t length_of_line(std::string_view rest) const;

  std::string_view text_;
  std::size_t offset_;
  int number_;
  char end_;  ///< '\n' also takes CRLF
};

}  // namespace sparsha::pipeline
