// The five lines of help, which fit any window.
#include "viewer/kiosk/help.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <imgui.h>

namespace sparsha::viewer {

void draw_kiosk_help(const Brush& brush, const Frame& frame, int width, int height) {
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  const std::array<std::pair<std::string, std::string>, 5> lines{
      {{"Touch", frame.has_pointer ? "move the mouse over the stone and press" : "move the ball slowly to the stone"},
       {"Nearer", "Zoom in and Zoom out, also + and -"},
       {"Elsewhere", "the four arrows move what you touch"},
       {"Where am I?", "says what is under your hand"},
       {frame.other_scenes ? "Next object" : "Help", frame.other_scenes ? "another stone" : "closes this page"}}};
  brush.list->AddRectFilled({0.0F, 0.0F}, {w, h}, IM_COL32(0, 0, 0, 170));
  const float card_w = 0.86F * w, card_h = 0.74F * h, left = 0.5F * (w - card_w), top = 0.08F * h;
  brush.card(left, top, card_w, card_h, (brush.theme.panel & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 250),
             brush.px(18.0F));
  const float row = card_h / static_cast<float>(lines.size());
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const float y = top + row * (static_cast<float>(k) + 0.5F) - 0.5F * brush.fonts.large->FontSize;
    brush.text(brush.fonts.large, left + brush.px(36.0F), y, brush.theme.accent, lines[k].first);
    const float room = 0.64F * card_w;
    const ImFont* font =
        brush.size(brush.fonts.large, lines[k].second).x <= room ? brush.fonts.large : brush.fonts.medium;
    brush.text(font, left + 0.34F * card_w, y, brush.theme.text, lines[k].second);
  }
}

}  // namespace sparsha::viewer
