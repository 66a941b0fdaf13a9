// Buttons, announcements and the one question.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <imgui.h>

#include "viewer/gui/parts.h"
#include "viewer/picture/picture.h"

namespace sparsha::viewer {
namespace {

/// A toggle's state, or nothing for plain buttons.
bool is_on(const Frame& frame, Action action) {
  switch (action) {
    case Action::texture:
      return frame.state.tick != 0 && frame.has_texture && (frame.state.flags & haptics::kFlagTexture) != 0;
    case Action::friction:
      return frame.state.tick != 0 && frame.has_friction && (frame.state.flags & haptics::kFlagFriction) != 0;
    case Action::stereo:
      return frame.settings.stereo.on();
    case Action::mode:
      return frame.looks;
    case Action::help:
      return frame.settings.help;
    default:
      return false;
  }
}

/// What the scene does not have: its button is grey, and a press says why.
bool is_absent(const Frame& frame, Action action) {
  return (action == Action::orient && !frame.why_not_orient.empty()) ||
         (action == Action::texture && !frame.has_texture) || (action == Action::friction && !frame.has_friction);
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

std::string cap_of(const ActionInfo& info) { return info.action == Action::help ? "F1" : info.keys; }

void draw_button(const Brush& brush, const Frame& frame, const Rect& rect, const ActionInfo& info, bool with_cap,
                 bool focused) {
  const bool kiosk = frame.settings.kiosk;
  const ImFont* font = kiosk ? brush.fonts.strong : brush.fonts.small;
  const auto x = static_cast<float>(rect.x), y = static_cast<float>(rect.y);
  const auto width = static_cast<float>(rect.width), height = static_cast<float>(rect.height);
  const bool on = is_on(frame, info.action);
  const bool hovered = rect.contains(frame.mouse.x(), frame.mouse.y());
  const float radius = brush.px(kiosk ? 14.0F : 9.0F);
  brush.card(x, y, width, height, on ? brush.theme.accent : brush.theme.card, radius);
  if (hovered) brush.card(x, y, width, height, IM_COL32(255, 255, 255, 28), radius);
  brush.list->AddRect(ImVec2(x, y), ImVec2(x + width, y + height), brush.theme.line, radius);
  if (focused)
    brush.list->AddRect(ImVec2(x - brush.px(2.0F), y - brush.px(2.0F)),
                        ImVec2(x + width + brush.px(2.0F), y + height + brush.px(2.0F)), IM_COL32(255, 255, 255, 255),
                        radius, 0, brush.px(3.0F));
  const bool grey = is_absent(frame, info.action);
  const ImU32 ink = on ? brush.theme.accent_text : grey ? brush.theme.dim : brush.theme.text;
  const float middle = y + 0.5F * (height - font->FontSize);
  if (!with_cap) {
    brush.text_centred(font, x + 0.5F * width, middle, ink, brush.elided(font, info.label, width - brush.px(4.0F)));
    return;
  }
  const float cap_y = y + 0.5F * (height - font->FontSize - brush.px(6.0F));
  Brush cap = brush;
  if (on) {
    cap.theme.key = IM_COL32(0, 0, 0, 40);
    cap.theme.text = brush.theme.accent_text;
  }
  const float inside = x + brush.px(7.0F) + cap.key_cap(x + brush.px(7.0F), cap_y, cap_of(info)) + brush.px(6.0F);
  brush.text(font, inside, middle, ink, brush.elided(font, info.label, x + width - inside));
}

}  // namespace

std::vector<Clickable> draw_buttons(const Brush& brush, const Frame& frame, const Layout& layout,
                                    const std::vector<Action>& buttons) {
  std::vector<Clickable> boxes;
  if (buttons.empty()) return boxes;
  const bool kiosk = frame.settings.kiosk;
  const ImFont* font = kiosk ? brush.fonts.strong : brush.fonts.small;
  const float room = static_cast<float>(layout.bar.width) - brush.px(16.0F);
  float gap = brush.px(kiosk ? 12.0F : 5.0F), pad = brush.px(kiosk ? 36.0F : 14.0F);
  // Without the keys' names where it is narrow, then in two rows, and at last with shorter labels.
  bool caps = !kiosk;
  std::vector<float> widths;
  float total = 0.0F;
  const auto measure = [&] {
    widths.clear();
    total = -gap;
    for (const Action action : buttons) {
      const ActionInfo& info = info_of(action);
      widths.push_back(brush.size(font, info.label).x + pad +
                       (caps ? brush.key_cap_width(cap_of(info)) + brush.px(6.0F) : 0.0F));
      if (kiosk) widths.back() = std::max(widths.back(), brush.px(104.0F));
      total += widths.back() + gap;
    }
  };
  measure();
  if (total > room && caps) {
    caps = false;
    measure();
  }
  if (total > room) {
    gap = brush.px(3.0F);
    pad = brush.px(6.0F);
    measure();
  }
  // Two low rows rather than labels cut short.
  const float bar_height = static_cast<float>(layout.bar.height), between = brush.px(3.0F);
  const bool two = total > room && !kiosk && buttons.size() > 1 &&
                   0.5F * (bar_height - 3.0F * between) >= font->FontSize + brush.px(4.0F);
  const std::size_t a_row = two ? (buttons.size() + 1) / 2 : buttons.size();
  const float height = two ? 0.5F * (bar_height - 3.0F * between) : std::min(button_height(brush, kiosk), bar_height);
  float y = static_cast<float>(layout.bar.y) + (two ? between : 0.5F * (bar_height - height));
  for (std::size_t first = 0; first < buttons.size(); first += a_row) {
    const std::size_t end = std::min(first + a_row, buttons.size());
    float wide = -gap;
    for (std::size_t k = first; k < end; ++k) wide += widths[k] + gap;
    const float shrink = std::min(1.0F, room / std::max(wide, 1.0F));
    float x = static_cast<float>(layout.bar.x) + 0.5F * (static_cast<float>(layout.bar.width) - shrink * wide);
    for (std::size_t k = first; k < end; ++k) {
      const float width = shrink * widths[k];
      const Rect rect{static_cast<int>(x), static_cast<int>(y), static_cast<int>(width), static_cast<int>(height)};
      boxes.push_back({rect, Clickable::Does::action, buttons[k]});
      draw_button(brush, frame, rect, info_of(buttons[k]), caps, frame.focused == static_cast<int>(k));
      x += width + shrink * gap;
    }
    y += height + between;
  }
  return boxes;
}

void draw_toasts(const Brush& brush, const Frame& frame, const Layout& layout, const Picture* picture) {
  const Rect& detail = layout.detail;
  // Beside the overview and below the scale's line.
  const float right = static_cast<float>(frame.settings.kiosk ? layout.overview.x : detail.x + detail.width);
  const float room = right - static_cast<float>(detail.x) - brush.px(60.0F);
  const float middle = 0.5F * (right + static_cast<float>(detail.x));
  const auto bar_top = static_cast<float>(layout.bar.y);
  bool above = false;
  if (picture != nullptr && picture->hand())
    if (const auto hand = picture->detail_view().to_pixel(picture->hand()->ball()))
      above = hand->y() > 0.5 * detail.height;
  const float head = static_cast<float>(detail.y) + brush.px(frame.settings.figures ? 170.0F : 64.0F);
  float edge = above ? head : bar_top - brush.px(10.0F);
  for (auto toast = frame.toasts.rbegin(); toast != frame.toasts.rend(); ++toast) {
    const auto priority = toast->announcement.priority;
    const bool bad = priority == haptics::Announcement::Priority::fault;
    const bool warn = priority == haptics::Announcement::Priority::warning;
    const std::string& words = toast->announcement.text;
    const ImFont* font = brush.fitting(brush.fonts.large, words, room);
    if (font != brush.fonts.large && font != brush.fonts.medium) font = brush.fonts.strong;
    const std::vector<std::string> lines = wrap(font, words, room);
    float width = 0.0F;
    for (const std::string& line : lines) width = std::max(width, brush.size(font, line).x);
    const float line_height = font->FontSize * 1.2F, pad = brush.px(14.0F);
    const float height = line_height * static_cast<float>(lines.size()) + 1.2F * pad;
    const float left = middle - 0.5F * width - 1.5F * pad;
    const float top = above ? edge : edge - height;
    if (above ? top + height > bar_top : top < head) break;
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
    edge = above ? top + height + brush.px(10.0F) : top - brush.px(10.0F);
  }
}

std::vector<Clickable> draw_question(const Brush& brush, const Frame& frame, const Layout& layout) {
  const auto room = static_cast<float>(layout.detail.width);
  const float width = std::min(brush.px(560.0F), room - brush.px(16.0F)), height = brush.px(150.0F);
  const float x = static_cast<float>(layout.detail.x) + 0.5F * (room - width);
  const float y =
      static_cast<float>(layout.detail.y) + std::min(0.4F * static_cast<float>(layout.detail.height),
                                                     std::max(static_cast<float>(layout.detail.height) - height, 0.0F));
  brush.card(x, y, width, height, (brush.theme.card & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 248), brush.px(14.0F));
  brush.list->AddRect(ImVec2(x, y), ImVec2(x + width, y + height), brush.theme.accent, brush.px(14.0F), 0,
                      brush.px(2.0F));
  const std::string words = "Scan again from this side?";
  const ImFont* font = brush.fitting(brush.fonts.large, words, width - brush.px(24.0F));
  brush.text_centred(font, x + 0.5F * width, y + brush.px(22.0F), brush.theme.text,
                     brush.elided(font, words, width - brush.px(24.0F)));
  std::vector<Clickable> boxes{
      {{static_cast<int>(x), static_cast<int>(y), static_cast<int>(width), static_cast<int>(height)}}};
  const float button = std::min(brush.px(180.0F), 0.5F * width - brush.px(22.0F)), tall = brush.px(48.0F);
  const auto add = [&](float left, Clickable::Does does, const char* name, const char* cap, bool strong) {
    const float top = y + height - tall - brush.px(18.0F);
    const Rect rect{static_cast<int>(left), static_cast<int>(top), static_cast<int>(button), static_cast<int>(tall)};
    const bool hovered = rect.contains(frame.mouse.x(), frame.mouse.y());
    brush.card(left, top, button, tall, strong ? brush.theme.accent : brush.theme.key, brush.px(10.0F));
    if (hovered) brush.card(left, top, button, tall, IM_COL32(255, 255, 255, 28), brush.px(10.0F));
    brush.list->AddRect(ImVec2(left, top), ImVec2(left + button, top + tall), brush.theme.line, brush.px(10.0F));
    Brush inside = brush;
    if (strong) {
      inside.theme.key = IM_COL32(0, 0, 0, 40);
      inside.theme.text = brush.theme.accent_text;
    }
    const float total = inside.size(brush.fonts.strong, name).x + brush.px(10.0F) + inside.key_cap_width(cap);
    float at = left + 0.5F * (button - total);
    at += inside.text(brush.fonts.strong, at, top + 0.5F * (tall - brush.fonts.strong->FontSize), inside.theme.text,
                      name) +
          brush.px(10.0F);
    inside.key_cap(at, top + 0.5F * (tall - brush.fonts.small->FontSize - brush.px(6.0F)), cap);
    boxes.push_back({rect, does});
  };
  add(x + 0.5F * width - button - brush.px(8.0F), Clickable::Does::yes, "Yes", "Enter", true);
  add(x + 0.5F * width + brush.px(8.0F), Clickable::Does::no, "No", "Esc", false);
  return boxes;
}

}  // namespace sparsha::viewer
