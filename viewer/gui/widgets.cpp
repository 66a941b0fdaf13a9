// Buttons, announcements, the help page and the one question.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <imgui.h>

#include "viewer/gui/parts.h"
#include "viewer/picture.h"

namespace sparsha::viewer {
namespace {

/// A toggle's state, or nothing for plain buttons.
bool is_on(const Frame& frame, Action action) {
  switch (action) {
    case Action::texture:
      return frame.state.tick != 0 && (frame.state.flags & haptics::kFlagTexture) != 0;
    case Action::friction:
      return frame.state.tick != 0 && (frame.state.flags & haptics::kFlagFriction) != 0;
    case Action::stereo:
      return frame.settings.anaglyph;
    case Action::help:
      return frame.settings.help;
    default:
      return false;
  }
}

/// Lines no wider than `width`, broken at blanks.
std::vector<std::string> wrap(const ImFont* font, const std::string& words, float width) {
  std::vector<std::string> lines;
  const char* at = words.c_str();
  const char* end = at + words.size();
  while (at < end) {
    const char* stop = font->CalcWordWrapPositionA(1.0F, at, end, width);
    if (stop == at) stop = std::min(at + 1, end);
    lines.emplace_back(at, stop);
    at = stop;
    while (at < end && (*at == ' ' || *at == '\n')) ++at;
  }
  return lines;
}

float button_height(const Brush& brush, bool kiosk) { return brush.px(kiosk ? 84.0F : 34.0F); }

}  // namespace

std::vector<Action> draw_buttons(const Brush& brush, const Frame& frame, const Layout& layout,
                                 const std::vector<Action>& buttons) {
  std::vector<Action> clicked;
  if (buttons.empty()) return clicked;
  const bool kiosk = frame.settings.kiosk;
  const ImFont* font = kiosk ? brush.fonts.strong : brush.fonts.small;
  const float gap = brush.px(kiosk ? 12.0F : 5.0F);
  const float room = static_cast<float>(layout.detail.width) - brush.px(24.0F);
  std::vector<float> widths;
  for (const Action action : buttons) {
    const ActionInfo& info = info_of(action);
    const float cap = kiosk ? 0.0F : brush.key_cap_width(action == Action::help ? "F1" : info.keys) + brush.px(6.0F);
    float width = brush.size(font, info.label).x + cap + brush.px(kiosk ? 36.0F : 14.0F);
    if (kiosk) width = std::max(width, brush.px(104.0F));
    widths.push_back(std::min(width, room));
  }
  // As many rows as it takes.
  std::vector<std::size_t> row_starts{0};
  float row_width = 0.0F;
  for (std::size_t k = 0; k < buttons.size(); ++k) {
    if (k > row_starts.back() && row_width + widths[k] > room) {
      row_starts.push_back(k);
      row_width = 0.0F;
    }
    row_width += widths[k] + gap;
  }
  const float height = button_height(brush, kiosk);
  const float bar_height = static_cast<float>(row_starts.size()) * (height + gap) - gap;
  const float top =
      static_cast<float>(layout.detail.y + layout.detail.height) - bar_height - brush.px(kiosk ? 24.0F : 14.0F);
  row_starts.push_back(buttons.size());

  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0.0F, 0.0F));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0.0F);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1.0F, 1.0F));
  ImGui::SetNextWindowPos(ImVec2(static_cast<float>(layout.detail.x), top));
  ImGui::SetNextWindowSize(ImVec2(static_cast<float>(layout.detail.width), bar_height));
  ImGui::Begin("bar", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBackground |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav);
  Brush bar = brush;
  bar.list = ImGui::GetWindowDrawList();
  float x = 0.0F, y = top - height - gap;
  for (std::size_t k = 0, row = 0; k < buttons.size(); ++k) {
    if (k == row_starts[row]) {
      ++row;
      float row_total = -gap;
      for (std::size_t r = k; r < row_starts[row]; ++r) row_total += widths[r] + gap;
      x = static_cast<float>(layout.detail.x) + 0.5F * (static_cast<float>(layout.detail.width) - row_total);
      y += height + gap;
    }
    const ActionInfo& info = info_of(buttons[k]);
    const float width = widths[k];
    ImGui::SetCursorScreenPos(ImVec2(x, y));
    ImGui::PushID(static_cast<int>(k));
    if (ImGui::InvisibleButton(info.label, ImVec2(width, height))) clicked.push_back(buttons[k]);
    const bool hovered = ImGui::IsItemHovered(), held = ImGui::IsItemActive();
    ImGui::PopID();
    const bool on = is_on(frame, buttons[k]);
    const float radius = bar.px(kiosk ? 14.0F : 9.0F);
    bar.card(x, y, width, height, on ? bar.theme.accent : bar.theme.card, radius);
    if (hovered) bar.card(x, y, width, height, IM_COL32(255, 255, 255, held ? 60 : 28), radius);
    bar.list->AddRect(ImVec2(x, y), ImVec2(x + width, y + height), bar.theme.line, radius);
    if (frame.focused == static_cast<int>(k))
      bar.list->AddRect(ImVec2(x - bar.px(2.0F), y - bar.px(2.0F)),
                        ImVec2(x + width + bar.px(2.0F), y + height + bar.px(2.0F)), IM_COL32(255, 255, 255, 255),
                        radius, 0, bar.px(3.0F));
    const bool grey = buttons[k] == Action::orient && !frame.why_not_orient.empty();
    if (grey && hovered) ImGui::SetTooltip("%s", frame.why_not_orient.c_str());
    const ImU32 ink = on ? bar.theme.accent_text : grey ? bar.theme.dim : bar.theme.text;
    const float middle = y + 0.5F * (height - font->FontSize);
    if (kiosk) {
      bar.text_centred(font, x + 0.5F * width, middle, ink, info.label);
    } else {
      const std::string cap_name = buttons[k] == Action::help ? "F1" : info.keys;
      const float cap_y = y + 0.5F * (height - font->FontSize - bar.px(6.0F));
      float inside = x + bar.px(7.0F);
      Brush cap = bar;
      if (on) {
        cap.theme.key = IM_COL32(0, 0, 0, 40);
        cap.theme.text = bar.theme.accent_text;
      }
      inside += cap.key_cap(inside, cap_y, cap_name) + bar.px(6.0F);
      bar.text(font, inside, middle, ink, info.label);
    }
    x += width + gap;
  }
  ImGui::End();
  ImGui::PopStyleVar(3);
  return clicked;
}

void draw_toasts(const Brush& brush, const Frame& frame, const Layout& layout) {
  const float room = 0.82F * static_cast<float>(layout.detail.width);
  float bottom =
      static_cast<float>(layout.detail.y + layout.detail.height) - brush.px(frame.settings.kiosk        ? 128.0F
                                                                            : frame.settings.large_type ? 100.0F
                                                                                                        : 64.0F);
  for (auto toast = frame.toasts.rbegin(); toast != frame.toasts.rend(); ++toast) {
    const auto priority = toast->announcement.priority;
    const bool bad = priority == haptics::Announcement::Priority::fault;
    const bool warn = priority == haptics::Announcement::Priority::warning;
    const std::string& words = toast->announcement.text;
    const ImFont* font = brush.size(brush.fonts.large, words).x <= room ? brush.fonts.large : brush.fonts.medium;
    const std::vector<std::string> lines = wrap(font, words, room);
    float width = 0.0F;
    for (const std::string& line : lines) width = std::max(width, brush.size(font, line).x);
    const float line_height = font->FontSize * 1.2F, pad = brush.px(14.0F);
    const float height = line_height * static_cast<float>(lines.size()) + 1.2F * pad;
    const float left =
        static_cast<float>(layout.detail.x) + 0.5F * (static_cast<float>(layout.detail.width) - width) - 1.5F * pad;
    const float top = bottom - height;
    const float alpha = static_cast<float>(std::min(1.0, toast->left * 6.0));
    const auto fade = [&](ImU32 colour) {
      const auto a = static_cast<ImU32>(static_cast<float>(colour >> IM_COL32_A_SHIFT) * alpha);
      return (colour & ~IM_COL32_A_MASK) | (a << IM_COL32_A_SHIFT);
    };
    const ImU32 ink = bad ? brush.theme.fault : warn ? brush.theme.warning : brush.theme.text;
    brush.card(left, top, width + 3.0F * pad, height, fade(brush.theme.card), brush.px(12.0F));
    brush.list->AddRect(ImVec2(left, top), ImVec2(left + width + 3.0F * pad, top + height),
                        fade(warn || bad ? ink : brush.theme.line), brush.px(12.0F), 0,
                        brush.px(bad || warn ? 2.0F : 1.0F));
    float y = top + 0.5F * pad;
    for (const std::string& line : lines) {
      brush.text_centred(font, left + 0.5F * (width + 3.0F * pad), y, fade(ink), line);
      y += line_height;
    }
    bottom = top - brush.px(10.0F);
  }
}

void draw_help(const Brush& brush, const Frame& frame, int width, int height) {
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  brush.list->AddRectFilled(ImVec2(0.0F, 0.0F), ImVec2(w, h), IM_COL32(0, 0, 0, 150));
  const float margin = brush.px(28.0F);
  const float card_w = std::min(w - 2.0F * brush.px(16.0F), brush.px(1120.0F));
  const float card_h = std::min(h - 2.0F * brush.px(16.0F), brush.px(640.0F));
  const float left = 0.5F * (w - card_w), top = 0.5F * (h - card_h);
  // The longer column has 22 rows and three headings.
  const float row = std::min(brush.fonts.small->FontSize + brush.px(11.0F), (card_h - brush.px(84.0F)) / 23.5F);
  brush.card(left, top, card_w, card_h, (brush.theme.panel & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 246),
             brush.px(16.0F));
  brush.list->AddRect(ImVec2(left, top), ImVec2(left + card_w, top + card_h), brush.theme.line, brush.px(16.0F));
  brush.text(brush.fonts.large, left + margin, top + brush.px(20.0F), brush.theme.text, "Keys");
  const std::string mouse = frame.has_pointer ? "Mouse: move = hand, left button = press, wheel = depth, right drag = "
                                                "turn, middle drag = shift, Ctrl wheel = closer"
                                              : "Mouse: drag = turn, middle drag = shift, wheel = closer";
  brush.text(brush.fonts.small, left + margin + brush.px(100.0F), top + brush.px(32.0F), brush.theme.dim, mouse);
  constexpr std::array kOrder{Group::touch, Group::hand, Group::picture, Group::camera, Group::program};
  const float first = top + brush.px(74.0F), column_w = (card_w - 2.0F * margin) / 2.0F;
  float x = left + margin, y = first;
  for (const Group group : kOrder) {
    const auto rows = std::ranges::count_if(all_actions(), [&](const ActionInfo& info) { return info.group == group; });
    if (group == Group::picture || y + row * static_cast<float>(rows + 1) > top + card_h) {
      x = left + margin + column_w;
      if (group == Group::picture) y = first;
    }
    brush.text(brush.fonts.strong, x, y, brush.theme.accent, name_of(group));
    y += row;
    for (const ActionInfo& info : all_actions()) {
      if (info.group != group) continue;
      brush.key_cap(x, y - brush.px(2.0F), info.keys);
      brush.text(brush.fonts.small, x + brush.px(100.0F), y + brush.px(1.0F), brush.theme.text, info.what);
      y += 0.86F * row;
    }
    y += 0.5F * row;
  }
}

void draw_question(const Brush& brush, const Layout& layout) {
  const float width = brush.px(560.0F), height = brush.px(120.0F);
  const float x = static_cast<float>(layout.detail.x) + 0.5F * (static_cast<float>(layout.detail.width) - width);
  const float y = static_cast<float>(layout.detail.y) + 0.4F * static_cast<float>(layout.detail.height);
  brush.card(x, y, width, height, (brush.theme.card & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 248), brush.px(14.0F));
  brush.list->AddRect(ImVec2(x, y), ImVec2(x + width, y + height), brush.theme.accent, brush.px(14.0F), 0,
                      brush.px(2.0F));
  brush.text_centred(brush.fonts.large, x + 0.5F * width, y + brush.px(20.0F), brush.theme.text,
                     "Scan again from this side?");
  float at = x + 0.5F * width - brush.px(90.0F);
  at += brush.key_cap(at, y + brush.px(72.0F), "Enter") + brush.px(8.0F);
  at += brush.text(brush.fonts.text, at, y + brush.px(72.0F), brush.theme.text, "yes") + brush.px(28.0F);
  at += brush.key_cap(at, y + brush.px(72.0F), "Esc") + brush.px(8.0F);
  brush.text(brush.fonts.text, at, y + brush.px(72.0F), brush.theme.text, "no");
}

}  // namespace sparsha::viewer
