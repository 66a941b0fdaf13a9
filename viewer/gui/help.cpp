// The page of keys: as many columns as fit, and as many pages as that takes.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <imgui.h>

#include "viewer/gui/parts.h"

namespace sparsha::viewer {
namespace {

/// A heading, a key or an empty line.
struct Line {
  const ActionInfo* info = nullptr;
  const char* heading = nullptr;
};

// In columns of `rows`: none begins with an empty line or ends with a heading.
std::vector<Line> all_lines(std::size_t rows) {
  constexpr std::array kOrder{Group::touch, Group::hand, Group::picture, Group::marks, Group::camera, Group::program};
  std::vector<Line> lines;
  for (const Group group : kOrder) {
    if (lines.size() % rows != 0) lines.push_back({});
    if (lines.size() % rows == rows - 1) lines.push_back({});
    lines.push_back({nullptr, name_of(group)});
    for (const ActionInfo& info : all_actions())
      if (info.group == group) lines.push_back({&info, nullptr});
  }
  return lines;
}

const char* mouse_text(const Frame& frame) {
  if ((frame.state.flags & haptics::kFlagAround) != 0)
    return !frame.has_pointer || frame.looks
               ? "Mouse: drag turns the picture, Ctrl drag the object in the hand, middle drag shifts, wheel zooms"
               : "Mouse: the hand; left button presses, Ctrl drag turns the object, right drag the picture, wheel "
                 "zooms";
  if (!frame.has_pointer || frame.looks)
    return "Mouse: drag turns, middle drag shifts, wheel zooms, double click centres, Ctrl Shift drag moves the light";
  return "Mouse: the hand; left button presses, wheel then deeper; right drag turns, middle drag shifts, wheel zooms";
}

}  // namespace

std::vector<Clickable> draw_help(const Brush& brush, const Frame& frame, int width, int height, int& pages) {
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  brush.list->AddRectFilled(ImVec2(0.0F, 0.0F), ImVec2(w, h), IM_COL32(0, 0, 0, 150));
  const float margin = brush.px(24.0F);
  const float card_w = std::min(w - brush.px(16.0F), brush.px(1240.0F));
  const float card_h = std::min(h - brush.px(16.0F), brush.px(690.0F));
  const float left = 0.5F * (w - card_w), top = 0.5F * (h - card_h);
  brush.card(left, top, card_w, card_h, (brush.theme.panel & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 246),
             brush.px(16.0F));
  brush.list->AddRect(ImVec2(left, top), ImVec2(left + card_w, top + card_h), brush.theme.line, brush.px(16.0F));
  const float row = brush.fonts.small->FontSize + brush.px(7.0F);
  const int columns = std::clamp(static_cast<int>((card_w - margin) / brush.px(390.0F)), 1, 3);
  const float column_w = (card_w - 2.0F * margin) / static_cast<float>(columns);
  const float first = top + brush.px(66.0F);
  const int rows = std::max(static_cast<int>((top + card_h - brush.px(14.0F) - first) / row), 4);
  const std::vector<Line> lines = all_lines(static_cast<std::size_t>(rows));
  const int room = rows * columns;
  pages = (static_cast<int>(lines.size()) + room - 1) / room;
  const int page = std::clamp(frame.help_page, 0, pages - 1);
  const std::string title = pages > 1 ? fmt::format("Keys {} of {}", page + 1, pages) : "Keys";
  const float title_w = brush.text(brush.fonts.large, left + margin, top + brush.px(16.0F), brush.theme.text, title);
  const float mouse_x = left + margin + title_w + brush.px(20.0F);
  brush.text(brush.fonts.small, mouse_x, top + brush.px(28.0F), brush.theme.dim,
             brush.elided(brush.fonts.small, mouse_text(frame), left + card_w - margin - mouse_x));
  const float cap_w = brush.px(92.0F);
  for (int k = 0; k < room; ++k) {
    const auto at = static_cast<std::size_t>(page * room + k);
    if (at >= lines.size()) break;
    const float x = left + margin + column_w * static_cast<float>(k / rows);
    const float y = first + row * static_cast<float>(k % rows);
    const Line& line = lines[at];
    if (line.heading != nullptr) brush.text(brush.fonts.small, x, y, brush.theme.accent, line.heading);
    if (line.info == nullptr) continue;
    brush.key_cap(x, y - brush.px(3.0F), line.info->keys);
    brush.text(brush.fonts.small, x + cap_w, y, brush.theme.text,
               brush.elided(brush.fonts.small, line.info->what, column_w - cap_w - brush.px(10.0F)));
  }
  // A click anywhere goes on or closes.
  return {{{0, 0, width, height}, Clickable::Does::action, Action::help}};
}

}  // namespace sparsha::viewer
