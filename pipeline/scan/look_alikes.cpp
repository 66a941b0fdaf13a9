#include "pipeline/scan/look_alikes.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>

#include "base/text/utf8.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kLongest = 256;  // bytes: no row of numbers in a word is longer

struct Range {
  std::uint32_t first, last;
  char looks_like;  ///< of each of them; digits of `first` on where '0'; 0: nothing at all
};
constexpr Range kDigits[] = {{0x0660, 0x0669, '0'},   {0x06F0, 0x06F9, '0'},  {0x0966, 0x096F, '0'},
                             {0x09E6, 0x09EF, '0'},   {0x0E50, 0x0E59, '0'},  {0xFF10, 0xFF19, '0'},
                             {0x1D7CE, 0x1D7FF, '0'}, {0x1FBF0, 0x1FBF9, '0'}};
constexpr Range kOthers[] = {
    {0x00A0, 0x00A0, ' '}, {0x00AD, 0x00AD, '-'}, {0x00B7, 0x00B7, '.'}, {0x0096, 0x0097, '-'}, {0x0130, 0x0131, '1'},
    {0x02D7, 0x02D7, '-'}, {0x037E, 0x037E, ';'}, {0x0387, 0x0387, '.'}, {0x0395, 0x0395, 'e'}, {0x0399, 0x0399, '1'},
    {0x039F, 0x039F, '0'}, {0x03B5, 0x03B5, 'e'}, {0x03BF, 0x03BF, '0'}, {0x0406, 0x0406, '1'}, {0x0415, 0x0415, 'e'},
    {0x0417, 0x0417, '3'}, {0x041E, 0x041E, '0'}, {0x0431, 0x0431, '6'}, {0x0435, 0x0435, 'e'}, {0x0437, 0x0437, '3'},
    {0x043E, 0x043E, '0'}, {0x0456, 0x0456, '1'}, {0x04C0, 0x04C0, '1'}, {0x0555, 0x0555, '0'}, {0x0585, 0x0585, '0'},
    {0x060C, 0x060C, ','}, {0x061B, 0x061B, ';'}, {0x066B, 0x066B, '.'}, {0x066C, 0x066C, ','}, {0x06D4, 0x06D4, '.'},
    {0x1680, 0x1680, ' '}, {0x180E, 0x180E, ' '}, {0x2000, 0x200A, ' '}, {0x200B, 0x200F, 0},   {0x2010, 0x2015, '-'},
    {0x201A, 0x201A, ','}, {0x2024, 0x2024, '.'}, {0x202A, 0x202E, 0},   {0x202F, 0x202F, ' '}, {0x2043, 0x2043, '-'},
    {0x205F, 0x205F, ' '}, {0x2060, 0x2064, 0},   {0x2066, 0x2069, 0},   {0x2212, 0x2212, '-'}, {0x22C5, 0x22C5, '.'},
    {0x3000, 0x3000, ' '}, {0x3001, 0x3001, ','}, {0x3002, 0x3002, '.'}, {0xFE50, 0xFE50, ','}, {0xFE52, 0xFE52, '.'},
    {0xFE54, 0xFE54, ';'}, {0xFE63, 0xFE63, '-'}, {0xFEFF, 0xFEFF, 0},   {0xFF0B, 0xFF0B, '+'}, {0xFF0C, 0xFF0C, ','},
    {0xFF0D, 0xFF0D, '-'}, {0xFF0E, 0xFF0E, '.'}, {0xFF1B, 0xFF1B, ';'}, {0xFF25, 0xFF25, 'e'}, {0xFF45, 0xFF45, 'e'}};

const Range* find(const Range* begin, const Range* end, std::uint32_t code) {
  const Range* const found =
      std::find_if(begin, end, [&](const Range& range) { return code >= range.first && code <= range.last; });
  return found == end ? nullptr : found;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_between(char c) { return is_blank(c) || c == ',' || c == ';'; }

/// `text` as it looks; empty when a character looks like none of a number's, or no digit of any script is there.
std::string as_it_looks(std::string_view text) {
  std::string looks;
  bool any_digit = false;
  while (!text.empty()) {
    Utf8Character c = first_utf8(text);
    if (c.bytes == 0) c = {static_cast<std::uint32_t>(static_cast<unsigned char>(text.front())), 1};
    if (c.code < 0x80) {
      looks += text.front();
      any_digit = any_digit || is_digit(text.front());
    } else if (const Range* digits = find(std::begin(kDigits), std::end(kDigits), c.code)) {
      looks += static_cast<char>('0' + (c.code - digits->first) % 10);
      any_digit = true;
    } else if (const Range* other = find(std::begin(kOthers), std::end(kOthers), c.code)) {
      if (other->looks_like != 0) looks += other->looks_like;
    } else {
      return {};
    }
    text.remove_prefix(c.bytes);
  }
  return any_digit ? looks : std::string();
}

}  // namespace

bool are_numbers_but_for_look_alikes(std::string_view text) {
  const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 0x80; };
  if (text.size() > kLongest || std::all_of(text.begin(), text.end(), is_ascii)) return false;
  const std::string looks = as_it_looks(text);
  const char* p = looks.data();
  const char* const end = p + looks.size();
  while (p < end) {
    while (p < end && is_between(*p)) ++p;
    if (p == end) break;
    double value = 0.0;
    const char* const stop = parse_number(p, end, value);
    if (stop == nullptr || (stop < end && !is_between(*stop))) return false;
    p = stop;
  }
  return !looks.empty();
}

}  // namespace sparsha::pipeline
