#include "app/words/progress_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace sparsha::app {
namespace {

bool begins_character(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; }

int characters(std::string_view utf8) { return static_cast<int>(std::ranges::count_if(utf8, begins_character)); }

/// The first `most` characters.
std::string shortened(std::string_view utf8, int most) {
  std::size_t end = 0;
  for (int seen = 0; end < utf8.size(); ++end)
    if (begins_character(utf8[end]) && ++seen > most) break;
  return std::string(utf8.substr(0, end));
}

/// In the last column a terminal may begin another line.
int room_of(int columns) { return std::max(columns - 1, 0); }

std::string of_text(char character, int count) { return std::string(static_cast<std::size_t>(count), character); }

}  // namespace

std::string progress_line(const std::string& stage, double fraction, double left_s, int columns) {
  constexpr int kLongestBar = 30, kShortestBar = 5, kStage = 12, kAroundBar = 3;
  const int room = room_of(columns);
  const std::string share = fmt::format(" {:3.0f} %", 100.0 * fraction);
  std::string time = left_s >= 1.0 ? fmt::format(", {:.0f} s left", left_s) : "";
  const std::string name = stage + of_text(' ', std::max(kStage - characters(stage), 0));
  const auto left = [&] { return room - characters(name) - characters(share) - characters(time) - kAroundBar; };
  if (left() < kShortestBar) time.clear();
  const int bar = std::min(left(), kLongestBar);
  if (bar < kShortestBar) return shortened(shortened(stage, std::max(room - characters(share), 0)) + share, room);
  const int done = std::clamp(static_cast<int>(fraction * bar), 0, bar);
  return name + " [" + of_text('#', done) + of_text('.', bar - done) + "]" + share + time;
}

std::string stage_line(const std::string& stage, int columns) {
  constexpr std::string_view kGoesOn = " ...";
  const int room = room_of(columns);
  return shortened(shortened(stage, std::max(room - characters(kGoesOn), 0)) + std::string(kGoesOn), room);
}

}  // namespace sparsha::app
