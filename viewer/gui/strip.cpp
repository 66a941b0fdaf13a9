// Curves of the last ten seconds, and figures for the staff.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <imgui.h>

#include "viewer/gui/parts.h"

namespace sparsha::viewer {

void draw_strip(const Brush& brush, const Frame& frame, const Layout& layout) {
  const Rect& rect = layout.strip;
  if (rect.height <= 0) return;
  struct Curve {
    const char* name;
    const char* unit;
    double factor;
    double least;  // of the full scale, in the unit
    double Strip::Sample::*value;
    ImU32 colour;
  };
  const std::array<Curve, 3> curves{
      Curve{"Force", "N", 1.0, 1.0, &Strip::Sample::force_n, brush.theme.accent},
      Curve{"Depth", "mm", 1e3, 1.0, &Strip::Sample::depth_m, IM_COL32(110, 190, 255, 255)},
      Curve{"Speed", "mm/s", 1e3, 20.0, &Strip::Sample::speed_m_per_s, IM_COL32(150, 214, 140, 255)}};
  const auto x = static_cast<float>(rect.x), y = static_cast<float>(rect.y), width = static_cast<float>(rect.width);
  const float line = brush.fonts.small->FontSize, top = y + line + brush.px(6.0F);
  const float height = static_cast<float>(rect.height) - line - brush.px(6.0F);
  brush.list->AddRect(ImVec2(x, top), ImVec2(x + width, top + height), brush.theme.line);
  const auto& samples = frame.strip.samples();
  const float third = width / 3.0F;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const Curve& curve = curves[c];
    double most = curve.least;
    for (const Strip::Sample& sample : samples) most = std::max(most, curve.factor * (sample.*curve.value));
    // Full scale in steps, so that the curve is not rescaled at every sample.
    const double full = std::exp2(std::ceil(std::log2(most / curve.least))) * curve.least;
    brush.text(brush.fonts.small, x + static_cast<float>(c) * third, y, curve.colour,
               brush.elided(brush.fonts.small, fmt::format("{} {}", curve.name, full_scale_text(full, curve.unit)),
                            third - brush.px(4.0F)));
    std::vector<ImVec2> points;
    const double end_s = samples.empty() ? 0.0 : samples.back().time_s;
    float last_x = -1e9F;
    for (const Strip::Sample& sample : samples) {
      const float px = x + width * static_cast<float>(1.0 - (end_s - sample.time_s) / Strip::kLength_s);
      const float share = static_cast<float>(std::min(curve.factor * (sample.*curve.value) / full, 1.0));
      const ImVec2 point(std::max(px, x), top + (height - brush.px(2.0F)) * (1.0F - share) + brush.px(1.0F));
      // No more points than pixels: the highest counts.
      if (px - last_x < 1.0F && !points.empty()) {
        points.back().y = std::min(points.back().y, point.y);
        continue;
      }
      last_x = px;
      points.push_back(point);
    }
    if (points.size() > 1)
      brush.list->AddPolyline(points.data(), static_cast<int>(points.size()), curve.colour, 0, brush.px(1.5F));
  }
}

void draw_figures(const Brush& brush, const Frame& frame, const Layout& layout) {
  const haptics::State& state = frame.state;
  const std::array<std::string, 4> lines{
      fmt::format("{:.0f} pictures/s, {:.1f} ms each", frame.pictures_per_s, frame.picture_ms),
      fmt::format("tick {:.1f} us, {:.1f} us late", 1e-3 * state.tick_ns, 1e-3 * state.late_ns),
      fmt::format("{:.2f} % of ticks in time, {} missed", 100.0 * std::clamp(state.share_in_time, 0.0, 1.0),
                  state.missed_ticks),
      fmt::format("{}{}", (state.flags & haptics::kFlagRealTime) != 0 ? "real time" : "no real time",
                  (state.flags & haptics::kFlagFault) != 0 ? ", forces off" : "")};
  float width = 0.0F;
  for (const std::string& words : lines) width = std::max(width, brush.size(brush.fonts.small, words).x);
  const float row = brush.fonts.small->FontSize + brush.px(4.0F), pad = brush.px(8.0F);
  const float x = static_cast<float>(layout.detail.x) + brush.px(14.0F),
              y = static_cast<float>(layout.detail.y) + brush.px(72.0F);
  brush.card(x, y, width + 2.0F * pad, row * static_cast<float>(lines.size()) + 2.0F * pad, brush.theme.card,
             brush.px(8.0F));
  for (std::size_t k = 0; k < lines.size(); ++k)
    brush.text(brush.fonts.small, x + pad, y + pad + row * static_cast<float>(k), brush.theme.text, lines[k]);
}

}  // namespace sparsha::viewer
