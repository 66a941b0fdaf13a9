// The side panel: what is seen, where the window is, what the hand feels.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <imgui.h>

#include "base/text/text.h"
#include "haptics/state/stone_gives.h"
#include "scene/scene.h"
#include "viewer/gui/gui.h"
#include "viewer/gui/parts.h"
#include "viewer/picture/picture.h"

namespace sparsha::viewer {
namespace {

/// What the hand is doing, in a few words, and whether it is good news.
struct Doing {
  std::string words;
  ImU32 colour;
};

Doing doing(const Brush& brush, const Frame& frame) {
  const haptics::State& state = frame.state;
  const auto flag = [&](std::uint64_t bit) { return (state.flags & bit) != 0; };
  if (state.tick == 0) return {"No hand yet", brush.theme.dim};
  if (flag(haptics::kFlagFault)) return {"Stopped: zero force", brush.theme.fault};
  if (flag(haptics::kFlagStale)) return {"No signal from the hand", brush.theme.warning};
  if (state.contact == 0) return {"In the air", brush.theme.text};
  if (!haptics::stone_gives(state)) return {"No force: lift the hand", brush.theme.warning};
  if (flag(haptics::kFlagOutside)) return {"Touching outside the scan", brush.theme.warning};
  if (flag(haptics::kFlagUnknownArea)) return {"Touching an area never scanned", brush.theme.warning};
  if (flag(haptics::kFlagFilledArea)) return {"Touching a filled gap", brush.theme.warning};
  if (flag(haptics::kFlagSticking)) return {"Touching: friction holds", brush.theme.accent};
  return {"Touching", brush.theme.accent};
}

void meter(const Brush& brush, float x, float y, float width, double share, ImU32 colour) {
  const float height = brush.px(5.0F);
  brush.card(x, y, width, height, brush.theme.key, 0.5F * height);
  const float filled = width * static_cast<float>(std::clamp(share, 0.0, 1.0));
  if (filled > height) brush.card(x, y, filled, height, colour, 0.5F * height);
}

float draw_legend(const Brush& brush, const Legend& legend, float x, float y, float width) {
  if (legend.title.empty()) return 0.0F;
  const float line = brush.fonts.small->FontSize;
  if (!legend.swatches.empty()) {
    float at = x;
    for (const Legend::Swatch& swatch : legend.swatches) {
      const auto& c = swatch.colour;
      brush.list->AddRectFilled(ImVec2(at, y), ImVec2(at + line, y + line), IM_COL32(c[0], c[1], c[2], 255));
      at += line + brush.px(6.0F);
      at += brush.text(brush.fonts.small, at, y, brush.theme.text,
                       brush.elided(brush.fonts.small, swatch.name, x + width - at)) +
            brush.px(14.0F);
    }
    return line + brush.px(8.0F);
  }
  const float title_w = brush.text(brush.fonts.small, x, y, brush.theme.text, legend.title);
  if (!legend.scale) return line + brush.px(8.0F);
  const auto number = [&](double value) {
    constexpr int kDigits = 3;
    return value_text(value, kDigits, TextStyle::screen) + " " + legend.unit;
  };
  brush.text_right(
      brush.fonts.small, x + width, y, brush.theme.dim,
      brush.elided(brush.fonts.small, fmt::format("{} \xE2\x80\x93 {}", number(legend.low), number(legend.high)),
                   width - title_w - brush.px(8.0F)));
  constexpr int kSteps = 64;
  const float top = y + line + brush.px(4.0F), height = brush.px(8.0F);
  for (int k = 0; k < kSteps; ++k) {
    const auto colour = colour_of(legend.map, (k + 0.5) / kSteps);
    const float left = x + width * static_cast<float>(k) / kSteps;
    brush.list->AddRectFilled(ImVec2(left, top), ImVec2(left + width / kSteps + 0.5F, top + height),
                              IM_COL32(colour[0], colour[1], colour[2], 255));
  }
  return line + height + brush.px(14.0F);
}

}  // namespace

void draw_scale_bar(const Brush& brush, const Frame& frame, const Layout& layout, const Picture& picture) {
  const View& view = picture.detail_view();
  const double pixels_per_m = view.pixels_per_unit(frame.camera.target) / picture.stage().unit_m;
  const double length_m = round_number(0.22 * layout.detail.width / pixels_per_m);
  const auto length = static_cast<float>(length_m * pixels_per_m);
  const float x = static_cast<float>(layout.detail.x) + brush.px(22.0F);
  const float y = static_cast<float>(layout.detail.y) + brush.px(40.0F);
  const ImU32 dark = IM_COL32(0, 0, 0, 150), light = IM_COL32(255, 250, 240, 255);
  const float tick = brush.px(5.0F), wide = brush.px(2.0F);
  for (const auto& [colour, width] : {std::pair{dark, wide + brush.px(2.5F)}, std::pair{light, wide}}) {
    brush.list->AddLine(ImVec2(x, y), ImVec2(x + length, y), colour, width);
    brush.list->AddLine(ImVec2(x, y - tick), ImVec2(x, y + tick), colour, width);
    brush.list->AddLine(ImVec2(x + length, y - tick), ImVec2(x + length, y + tick), colour, width);
  }
  const std::string words = length_text(length_m, TextStyle::screen);
  const float top = y - tick - brush.fonts.text->FontSize - brush.px(2.0F);
  brush.text_centred(brush.fonts.text, x + 0.5F * length + 1.0F, top + 1.0F, dark, words);
  brush.text_centred(brush.fonts.text, x + 0.5F * length, top, light, words);
  if (frame.settings.contour_m <= 0.0) return;
  const std::string lines = "Lines every " + length_text(frame.settings.contour_m, TextStyle::screen);
  brush.text(brush.fonts.small, x + 1.0F, y + tick + brush.px(3.0F), dark, lines);
  brush.text(brush.fonts.small, x, y + tick + brush.px(2.0F), light, lines);
}

void draw_overview_marks(const Brush& brush, const Frame& frame, const Layout& layout, const scene::Scene& scene) {
  const Rect& rect = layout.overview;
  const Stage stage = stage_of(scene.description(), frame.state);
  const View view = make_view(overview_camera(scene.description(), stage, rect), rect.width, rect.height);
  const auto place = [&](const Eigen::Vector3d& grid_m) {
    Eigen::Vector2d p = view.to_pixel(stage.to_world(grid_m)).value_or(Eigen::Vector2d::Zero());
    // ImGui looks into a table by what it is given: never a NaN, never far off the picture.
    constexpr double kFar_px = 1e5;
    for (double& pixel : p) pixel = std::isfinite(pixel) ? std::clamp(pixel, -kFar_px, kFar_px) : 0.0;
    return ImVec2(static_cast<float>(rect.x + p.x()), static_cast<float>(rect.y + p.y()));
  };
  const ImVec2 low(static_cast<float>(rect.x), static_cast<float>(rect.y));
  const ImVec2 high(static_cast<float>(rect.x + rect.width), static_cast<float>(rect.y + rect.height));
  const bool plain = frame.settings.high_contrast;
  const ImU32 amber = plain ? IM_COL32(255, 255, 0, 255) : IM_COL32(255, 178, 66, 255), dark = IM_COL32(0, 0, 0, 140);
  if (frame.settings.kiosk) brush.list->AddRect(low, high, brush.theme.line, 0.0F, 0, brush.px(2.0F));
  brush.list->PushClipRect(low, high, true);
  const Window window = window_of(frame.state, scene.description());
  if (window.meant) {
    const Eigen::Vector3d half =
        stage.turn.transpose() * Eigen::Vector3d(0.5 * window.width_m, 0.5 * window.width_m, 0.0);
    const ImVec2 a = place(window.centre_m - half), b = place(window.centre_m + half);
    const ImVec2 p(std::min(a.x, b.x), std::min(a.y, b.y)), q(std::max(a.x, b.x), std::max(a.y, b.y));
    brush.list->AddRect(p, q, dark, 0.0F, 0, brush.px(4.5F));
    brush.list->AddRect(p, q, amber, 0.0F, 0, brush.px(2.2F));
  }
  const haptics::State& state = frame.state;
  const Eigen::Vector3d proxy(state.proxy_m[0], state.proxy_m[1], state.proxy_m[2]);
  if (state.tick != 0 && proxy.allFinite()) {
    const ImVec2 at = place(proxy);
    brush.list->AddCircleFilled(at, brush.px(6.5F), IM_COL32(0, 0, 0, 255));
    brush.list->AddCircleFilled(at, brush.px(5.0F), IM_COL32(255, 255, 255, 255));
    brush.list->AddCircleFilled(at, brush.px(3.0F),
                                state.contact != 0 ? IM_COL32(20, 120, 230, 255) : IM_COL32(30, 60, 110, 255));
  }
  brush.list->PopClipRect();
}

namespace {

/// Where figures stand: left edge, width of both columns, top, and the line they must not cross.
struct FigureBox {
  float x, width, y, end;
};

void draw_figures(const Brush& brush, const Frame& frame, const scene::SceneDescription& description,
                  const Window& window, const FigureBox& box) {
  const Fonts& fonts = brush.fonts;
  const Theme& theme = brush.theme;
  const haptics::State& state = frame.state;
  const float x = box.x, width = box.width, end = box.end;
  float y = box.y;
  const auto length_of = [](const std::array<double, 3>& v) {
    return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  };
  const double force_n = length_of(state.commanded_force_n);
  const double depth_m = state.contact != 0 ? state.penetration_m : 0.0;
  const float half = 0.5F * (width - brush.px(20.0F)), second = x + half + brush.px(20.0F);
  const auto figure = [&](float at, const char* name, const std::string& value, double share, ImU32 colour) {
    brush.text(fonts.small, at, y, theme.dim, brush.elided(fonts.small, name, half));
    brush.text(brush.fitting(fonts.large, value, half), at, y + fonts.small->FontSize + brush.px(1.0F), theme.text,
               value);
    meter(brush, at, y + fonts.small->FontSize + fonts.large->FontSize + brush.px(6.0F), half, share, colour);
  };
  const bool limited = (state.flags & haptics::kFlagSaturated) != 0;
  figure(x, limited ? "Force, limited" : "Force", fmt::format("{:.2f} N", force_n), force_n / 5.0,
         limited ? theme.warning : theme.accent);
  figure(second, "Depth at the hand", fmt::format("{:.2f} mm", 1e3 * depth_m), depth_m / 0.01, theme.accent);
  y += fonts.small->FontSize + fonts.large->FontSize + brush.px(22.0F);

  const auto row = [&](const char* name, const std::string& value, const char* other, const std::string& second_value) {
    if (y + fonts.small->FontSize > end) return;  // no room in a low window
    const auto pair = [&](float at, const char* what, const std::string& figure_text) {
      const float value_w = brush.size(fonts.small, figure_text).x;
      brush.text(fonts.small, at, y, theme.dim, brush.elided(fonts.small, what, half - value_w - brush.px(4.0F)));
      brush.text_right(fonts.small, at + half, y, theme.text, figure_text);
    };
    pair(x, name, value);
    pair(second, other, second_value);
    y += fonts.small->FontSize + brush.px(7.0F);
  };
  const auto on = [&](std::uint64_t bit) { return (state.flags & bit) != 0; };
  row("Level", fmt::format("{} of {}", state.level + 1, description.levels.size()), "Window",
      length_text(window.width_m, TextStyle::screen));
  row("Texture",
      !frame.has_texture          ? "none"
      : on(haptics::kFlagTexture) ? "on"
                                  : "off",
      "Friction",
      !frame.has_friction           ? std::string("none")
      : !on(haptics::kFlagFriction) ? std::string("off")
      : state.contact != 0          ? fmt::format("\xC2\xB5 {:.2f}", state.friction_coefficient)
                                    : std::string("on"));
  if (on(haptics::kFlagImpact) || on(haptics::kFlagGrain))
    row("Strike", on(haptics::kFlagImpact) ? "invented" : "as measured", "Grain",
        on(haptics::kFlagGrain) ? std::string("invented") : std::string("as measured"));
  row("Magnified", fmt::format("{:.3g} \xC3\x97", state.scale), "Ticks in time",
      fmt::format("{:.1f} %", 100.0 * std::clamp(state.share_in_time, 0.0, 1.0)));
}

}  // namespace

namespace {

const char* doing_with_the_mouse(const Frame& frame) {
  switch (frame.marks.tool) {
    case Tool::distance:
      return "Measure: distance";
    case Tool::angle:
      return "Measure: angle";
    case Tool::profile:
      return "Measure: profile";
    default:
      return frame.looks ? "Look" : "Touch";
  }
}

}  // namespace

void draw_panel(const Brush& brush, const Frame& frame, const Layout& layout, const Picture& picture) {
  const Fonts& fonts = brush.fonts;
  const Theme& theme = brush.theme;
  const haptics::State& state = frame.state;
  const auto& description = picture.scene()->description();
  const Rect& panel = layout.panel;
  const auto left = static_cast<float>(panel.x), top = static_cast<float>(panel.y);
  const auto right = left + static_cast<float>(panel.width), bottom = top + static_cast<float>(panel.height);
  const auto image_top = static_cast<float>(layout.overview.y);
  const auto image_bottom = image_top + static_cast<float>(layout.overview.height);
  const float margin = static_cast<float>(layout.overview.x) - left;
  const float x = left + margin, width = right - left - 2.0F * margin;
  brush.list->AddRect(ImVec2(x - 0.5F, image_top - 0.5F), ImVec2(x + width + 0.5F, image_bottom + 0.5F), theme.line);
  const float edge = panel.x > layout.detail.x ? left : right - 1.0F;
  brush.list->AddLine(ImVec2(edge, top), ImVec2(edge, bottom), theme.line);

  const double extent_m =
      std::max(description.levels.front().nx, description.levels.front().ny) * description.levels.front().spacing_m;
  const std::string extent = length_text(extent_m, TextStyle::screen);
  const float title_w = width - brush.size(fonts.small, extent).x - brush.px(12.0F);
  const std::string title = frame.title.empty() ? "Sparsha" : frame.title;
  const ImFont* title_font = brush.fitting(fonts.large, title, title_w);
  brush.text(title_font, x, brush.px(15.0F) + 0.5F * (fonts.large->FontSize - title_font->FontSize), theme.text,
             brush.elided(title_font, title, title_w));
  brush.text_right(fonts.small, x + width, brush.px(26.0F), theme.dim, extent);

  const float end = static_cast<float>(layout.strip.height > 0 ? layout.strip.y : layout.footer.y);
  float y = image_bottom + brush.px(10.0F);
  y += draw_legend(brush, picture.legend(), x, y, width);

  const Doing now = doing(brush, frame);
  const float dot = brush.px(5.0F);
  y += brush.px(2.0F);
  brush.list->AddCircleFilled(ImVec2(x + dot, y + 0.5F * fonts.strong->FontSize + 1.0F), dot, now.colour);
  const float words_x = x + 2.0F * dot + brush.px(8.0F);
  const float words_w =
      brush.text(fonts.strong, words_x, y, now.colour, brush.elided(fonts.strong, now.words, x + width - words_x));
  const float part_w = x + width - words_x - words_w - brush.px(12.0F);
  if (!frame.part.empty() && part_w > brush.px(30.0F))
    brush.text_right(fonts.text, x + width, y, theme.text, brush.elided(fonts.text, frame.part, part_w));
  y += fonts.strong->FontSize + brush.px(12.0F);

  if (state.tick != 0) draw_figures(brush, frame, description, window_of(state, description), {x, width, y, end});
  const std::string hint = "all keys";
  const float cap = brush.key_cap_width("F1");
  const float line_y = bottom - fonts.small->FontSize - brush.px(18.0F);
  brush.key_cap(x + width - cap - brush.size(fonts.small, hint).x - brush.px(8.0F), line_y, "F1");
  brush.text_right(fonts.small, x + width, line_y + brush.px(3.0F), theme.dim, hint);
  brush.text(fonts.small, x, line_y + brush.px(3.0F), theme.dim, doing_with_the_mouse(frame));
}

}  // namespace sparsha::viewer
