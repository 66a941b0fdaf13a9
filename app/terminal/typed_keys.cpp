// Sequences after ECMA-48 (CSI), and SS3 of application modes: xterm, the Linux console, rxvt, screen, tmux, PuTTY.
#include "app/terminal/typed_keys.h"

#include <array>
#include <cstddef>
#include <cstdlib>
#include <optional>

namespace sparsha::app {
namespace {

using Kind = TypedKey::Kind;

constexpr double kPiece_s = 0.25;     // a sequence that is not complete by then was the Escape key
constexpr std::size_t kLongest = 32;  // no sequence of a key is so long

std::optional<TypedKey> key_of(Kind kind) { return TypedKey{kind, 0}; }

// CSI n ~
std::optional<TypedKey> numbered(int number) {
  switch (number) {
    case 1:
    case 7:
      return key_of(Kind::home);
    case 2:
      return key_of(Kind::insert);
    case 4:
    case 8:
      return key_of(Kind::end);
    case 5:
      return key_of(Kind::page_up);
    case 6:
      return key_of(Kind::page_down);
    default:
      return std::nullopt;
  }
}

// The number pad in application mode sends SS3 p to y for 0 to 9, and j k m o M for * + - / Enter.
std::optional<TypedKey> of_pad(char last) {
  if (last >= 'p' && last <= 'y') return TypedKey{Kind::letter, static_cast<char>('0' + (last - 'p'))};
  constexpr std::array<std::array<char, 2>, 5> kSigns{{{'j', '*'}, {'k', '+'}, {'m', '-'}, {'o', '/'}, {'M', '\r'}}};
  for (const auto& [sent, sign] : kSigns)
    if (sent == last) return TypedKey{Kind::letter, sign};
  return std::nullopt;
}

std::optional<TypedKey> of_sequence(char introducer, std::string_view parameters, char last) {
  switch (last) {
    case 'A':
      return key_of(Kind::up);
    case 'B':
      return key_of(Kind::down);
    case 'C':
      return key_of(Kind::right);
    case 'D':
      return key_of(Kind::left);
    case 'E':
      return key_of(Kind::middle);
    case 'F':
      return key_of(Kind::end);
    case 'H':
      return key_of(Kind::home);
    case '~':
      return numbered(std::atoi(std::string(parameters).c_str()));
    default:
      return introducer == 'O' ? of_pad(last) : std::nullopt;
  }
}

}  // namespace

std::vector<TypedKey> TypedKeys::take(std::string_view typed, double time_s) {
  std::vector<TypedKey> keys;
  if (!begun_.empty() && time_s - begun_s_ > kPiece_s) begun_.clear();
  const std::string all = begun_ + std::string(typed);
  begun_.clear();
  for (std::size_t at = 0; at < all.size(); ++at) {
    const char key = all[at];
    if (key != '\x1b') {
      if (static_cast<unsigned char>(key) < 0x80) keys.push_back({Kind::letter, key});
      continue;
    }
    const std::size_t begin = at;
    std::size_t last = at + 2;
    while (last < all.size() && (all[last] < '@' || all[last] > '~')) ++last;
    const bool introduced = at + 1 >= all.size() || all[at + 1] == '[' || all[at + 1] == 'O';
    if (!introduced) continue;  // the Escape key alone, or Alt with a key
    if (last >= all.size()) {
      if (all.size() - begin > kLongest) break;
      begun_ = all.substr(begin);
      begun_s_ = time_s;
      break;
    }
    if (const auto known = of_sequence(all[at + 1], std::string_view(all).substr(at + 2, last - at - 2), all[last]))
      keys.push_back(*known);
    at = last;
  }
  return keys;
}

}  // namespace sparsha::app
