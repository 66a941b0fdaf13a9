#include "pipeline/scan/formats/remark_unit.h"

#include <algorithm>
#include <optional>

#include "base/text/lower_case.h"
#include "pipeline/scan/formats/text/header.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kLongest = 4096;

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || static_cast<unsigned char>(c) >= 0x80; }

std::string_view without_signs(std::string_view word) {
  constexpr std::string_view kSigns = " \t\r\"'()[]{}<>.,;#*/%!";
  const std::size_t begin = word.find_first_not_of(kSigns);
  if (begin == std::string_view::npos) return {};
  return word.substr(begin, word.find_last_not_of(kSigns) + 1 - begin);
}

/// Whether the words before "unit" may speak of the coordinates: "# File units", "// all units". An accuracy, a pixel
/// or a sensor has units of its own.
bool speak_of_coordinates(std::string_view before) {
  constexpr std::string_view kWords =
      " file length linear coordinate coordinates all map model xyz the global scene mesh point points data comment "
      "obj_info ";
  for (std::string_view word = take_word(before); !word.empty(); word = take_word(before)) {
    const std::string_view letters = without_signs(word);
    if (!letters.empty() && !is_one_of(letters, kWords)) return false;
  }
  return true;
}

}  // namespace

std::string unit_in_remark(std::string_view remark) {
  const std::string lower = lower_case(remark.substr(0, kLongest));
  const std::string_view text = lower;
  const std::size_t at = text.find("unit");
  if (at == std::string_view::npos || (at > 0 && is_letter(text[at - 1]))) return {};
  if (!speak_of_coordinates(text.substr(0, at))) return {};
  std::size_t behind = at + 4;
  if (behind < text.size() && text[behind] == 's') ++behind;
  std::string_view rest = text.substr(behind);
  if (rest.empty() || std::string_view(" \t=:").find(rest.front()) == std::string_view::npos) return {};
  const std::size_t sign = rest.find_first_not_of(" \t");
  if (sign == std::string_view::npos) return {};
  const bool told = rest[sign] == '=' || rest[sign] == ':';
  rest.remove_prefix(told ? sign + 1 : sign);
  if (const std::string_view whole = without_signs(rest);
      whole.find(' ') != std::string_view::npos && unit_named(whole) != NamedUnit::none)
    return std::string(whole);  // of several words: "US survey feet"
  std::string_view word = without_signs(take_word(rest));
  while (is_one_of(word, " are is in ") && !without_signs(rest).empty()) word = without_signs(take_word(rest));
  // Behind a sign a remark may go on; without one the unit is its last word. "units in" says nothing.
  if (word.empty() || word == "in" || (!told && !without_signs(rest).empty())) return {};
  return std::string(word);
}

bool gives_unit(std::string_view remark) {
  const NamedUnit unit = unit_named(unit_in_remark(remark));
  return unit != NamedUnit::none && unit != NamedUnit::degree;
}

bool take_unit_of_remark(std::string_view remark, int line, RawScan& scan) {
  if (!gives_unit(remark)) return false;
  const std::string word = unit_in_remark(remark);
  if (scan.unit) {
    if (length_of(unit_named(word)) == scan.unit) return true;
    scan.unit.reset();
    scan.several_units = true;
    scan.warnings.push_back("a remark on line " + std::to_string(line) + " gives the coordinates in " +
                            in_quotes(word) + ", after another unit; neither is taken");
    return true;
  }
  scan.unit = length_of(unit_named(word));
  if (scan.unit) {
    scan.notes.push_back("the unit is that of a remark on line " + std::to_string(line));
  } else {
    scan.warnings.push_back("a remark on line " + std::to_string(line) + " gives the coordinates in " +
                            in_quotes(word) + ", which no 'units' can be; they are not converted");
  }
  return true;
}

}  // namespace sparsha::pipeline
