#include "pipeline/replica/braille.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "base/system/library.h"

namespace sparsha::pipeline {
namespace {

constexpr char32_t kPatterns = 0x2800;  // U+2800 + dots
constexpr BrailleCell kNumberSign = 0b111100;
constexpr BrailleCell kCapitalSign = 0b100000;
constexpr BrailleCell kLetterSign = 0b110000;

/// a to z: dots by their numbers.
constexpr std::array<std::string_view, 26> kLetters = {
    "1",    "12",  "14",   "145",   "15",   "124", "1245", "125", "24",   "245",  "13",   "123",   "134",
    "1345", "135", "1234", "12345", "1235", "234", "2345", "136", "1236", "2456", "1346", "13456", "1356"};

constexpr BrailleCell cell_of(std::string_view dots) {
  unsigned cell = 0;
  for (const char dot : dots) cell |= 1U << static_cast<unsigned>(dot - '1');
  return static_cast<BrailleCell>(cell);
}

constexpr BrailleCell letter(char32_t c) { return cell_of(kLetters[static_cast<std::size_t>(c - U'a')]); }

std::optional<BrailleCell> sign(char32_t c) {
  switch (c) {
    case U' ':
      return BrailleCell{0};
    case U',':
      return cell_of("2");
    case U';':
      return cell_of("23");
    case U':':
      return cell_of("25");
    case U'.':
      return cell_of("256");
    case U'!':
      return cell_of("235");
    case U'?':
      return cell_of("236");
    case U'-':
      return cell_of("36");
    case U'\'':
      return cell_of("3");
    default:
      return std::nullopt;
  }
}

/// Code points; what is no UTF-8 becomes U+FFFD.
std::u32string code_points(const std::string& text) {
  std::u32string result;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const std::size_t length = byte < 0x80 ? 1 : byte >> 5U == 6 ? 2 : byte >> 4U == 14 ? 3 : byte >> 3U == 30 ? 4 : 0;
    char32_t c = length == 1 ? byte : byte & (0x7FU >> length);
    bool good = length > 0 && i + length <= text.size();
    for (std::size_t k = 1; good && k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      good = next >> 6U == 2;
      c = c << 6U | (next & 0x3FU);
    }
    result += good ? c : U'\uFFFD';
    i += good ? length : 1;
  }
  return result;
}

/// The small letter of a Latin capital; others as they are.
char32_t small(char32_t c) {
  if ((c >= U'A' && c <= U'Z') || (c >= 0xC0 && c <= 0xDE && c != 0xD7)) return c + 0x20;
  const bool pairs = (c >= 0x100 && c <= 0x137) || (c >= 0x14A && c <= 0x177) || (c >= 0x1E00 && c <= 0x1EFF);
  const bool odd_pairs = (c >= 0x139 && c <= 0x148) || (c >= 0x179 && c <= 0x17E);
  if ((pairs && c % 2 == 0) || (odd_pairs && c % 2 == 1)) return c + 1;
  return c;
}

/// Latin letters with marks as the bare ones.
char32_t plain(char32_t c) {
  constexpr std::u32string_view kMarked = U"àáâãäåāçćčèéêëēìíîïīñńòóôõöōùúûüūýÿśšžḍḥḷṃṇṅṛṣṭ";
  constexpr std::u32string_view kPlain = U"aaaaaaaccceeeeeiiiiinnoooooouuuuuyysszdhlmnnrst";
  static_assert(kMarked.size() == kPlain.size());
  const std::size_t at = kMarked.find(c);
  return at == std::u32string_view::npos ? c : kPlain[at];
}

Braille by_letters(const std::u32string& text) {
  Braille result;
  bool number = false;
  for (const char32_t given : text) {
    const bool capital = small(given) != given;
    const char32_t c = plain(small(given));
    if (c >= U'0' && c <= U'9') {
      if (!number) result.cells.push_back(kNumberSign);
      number = true;
      result.cells.push_back(letter(c == U'0' ? U'j' : U'a' + (c - U'1')));
      continue;
    }
    if (c >= U'a' && c <= U'z') {
      if (number && c <= U'j' && !capital) result.cells.push_back(kLetterSign);
      if (capital) result.cells.push_back(kCapitalSign);
      result.cells.push_back(letter(c));
    } else if (const auto cell = sign(c)) {
      result.cells.push_back(*cell);
      if (c == U'.' || c == U',') continue;  // numbers go on behind them
    } else {
      result.complete = false;
    }
    number = false;
  }
  return result;
}

/// liblouis, found when the program runs; its characters have two or four bytes.
std::optional<std::vector<BrailleCell>> by_library(const std::u32string& text) {
  static void* const kLibrary = system::load_library("liblouis.so.20");
  if (kLibrary == nullptr) return std::nullopt;
  using Translate = int (*)(const char*, const void*, int*, void*, int*, void*, char*, int);
  using Size = int (*)();
  const auto translate = reinterpret_cast<Translate>(system::symbol(kLibrary, "lou_translateString"));
  const auto size = reinterpret_cast<Size>(system::symbol(kLibrary, "lou_charSize"));
  if (translate == nullptr || size == nullptr) return std::nullopt;
  const bool devanagari = std::any_of(text.begin(), text.end(), [](char32_t c) { return c >= 0x0900 && c <= 0x097F; });
  const char* const table = devanagari ? "hi-in-g1.utb" : "en-ueb-g1.ctb";
  constexpr int kDots = 4, kUnicode = 64;  // dotsIO, ucBrl
  const auto run = [&]<typename Character>(Character) -> std::optional<std::vector<BrailleCell>> {
    const std::vector<Character> in(text.begin(), text.end());
    std::vector<Character> out(8 * in.size() + 16);
    int in_size = static_cast<int>(in.size());
    int out_size = static_cast<int>(out.size());
    if (translate(table, in.data(), &in_size, out.data(), &out_size, nullptr, nullptr, kDots | kUnicode) == 0 ||
        in_size != static_cast<int>(in.size()))
      return std::nullopt;
    std::vector<BrailleCell> cells;
    for (int i = 0; i < out_size; ++i) {
      const auto c = static_cast<char32_t>(out[static_cast<std::size_t>(i)]);
      if (c < kPatterns || c > kPatterns + 0x3F) return std::nullopt;
      cells.push_back(static_cast<BrailleCell>(c - kPatterns));
    }
    return cells;
  };
  if (size() == 4) return run(std::uint32_t{});
  if (size() == 2) return run(std::uint16_t{});
  return std::nullopt;
}

}  // namespace

Braille to_braille(const std::string& text, bool use_library) {
  const std::u32string characters = code_points(text);
  if (use_library) {
    if (auto cells = by_library(characters)) {
      Braille result;
      result.cells = std::move(*cells);
      result.by_library = true;
      return result;
    }
  }
  return by_letters(characters);
}

std::vector<std::vector<BrailleCell>> wrap_braille(const std::vector<BrailleCell>& cells, std::size_t most) {
  std::vector<std::vector<BrailleCell>> lines;
  for (std::size_t begin = 0; begin < cells.size() && most > 0;) {
    std::size_t end = std::min(begin + most, cells.size());
    if (end < cells.size()) {
      std::size_t blank = end;
      while (blank > begin && cells[blank] != 0) --blank;
      if (blank > begin) end = blank;
    }
    lines.emplace_back(cells.begin() + static_cast<std::ptrdiff_t>(begin),
                       cells.begin() + static_cast<std::ptrdiff_t>(end));
    begin = end;
    while (begin < cells.size() && cells[begin] == 0) ++begin;
  }
  return lines;
}

}  // namespace sparsha::pipeline
