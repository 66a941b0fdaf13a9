// Measures, pins and parts over the picture, the profile's curve, and the words that are being written.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <imgui.h>

#include "base/text/text.h"
#include "viewer/gui/parts.h"
#include "viewer/picture/picture.h"

namespace sparsha::viewer {
namespace {

constexpr ImU32 kDark = IM_COL32(0, 0, 0, 170);

/// Places of the grid frame as points of the window.
class Plotter {
 public:
  Plotter(const Brush& brush, const Layout& layout, const Picture& picture, int eye)
      : brush_(brush),
        picture_(picture),
        left_(layout.detail.x + eye * picture.detail_view().width),
        top_(layout.detail.y) {}

  [[nodiscard]] bool place(const Eigen::Vector3d& grid_m, ImVec2& at) const {
    const auto pixel = picture_.detail_view().to_pixel(picture_.stage().to_world(grid_m));
    constexpr double kFar_px = 1e5;
    if (!pixel || !pixel->allFinite() || pixel->cwiseAbs().maxCoeff() > kFar_px) return false;
    at = {static_cast<float>(left_ + pixel->x()), static_cast<float>(top_ + pixel->y())};
    return true;
  }
  [[nodiscard]] Eigen::Vector3d on_stone(double x_m, double y_m) const {
    return {x_m, y_m, picture_.height_at(x_m, y_m)};
  }
  /// Parts of the line that cannot be seen are left out.
  void line(const std::vector<Eigen::Vector3d>& places, ImU32 colour, float width) const {
    std::vector<ImVec2> points;
    const auto flush = [&] {
      if (points.size() > 1) {
        brush_.list->AddPolyline(points.data(), static_cast<int>(points.size()), kDark, 0, width + brush_.px(2.2F));
        brush_.list->AddPolyline(points.data(), static_cast<int>(points.size()), colour, 0, width);
      }
      points.clear();
    };
    ImVec2 at;
    for (const Eigen::Vector3d& p : places) {
      if (!p.allFinite() || !place(p, at)) {
        flush();
      } else if (points.empty() || std::hypot(at.x - points.back().x, at.y - points.back().y) >= 0.7F) {
        points.push_back(at);
      }
    }
    flush();
  }
  void dot(const Eigen::Vector3d& grid_m, ImU32 colour, float radius) const {
    ImVec2 at;
    if (!place(grid_m, at)) return;
    brush_.list->AddCircleFilled(at, radius + brush_.px(1.5F), kDark);
    brush_.list->AddCircleFilled(at, radius, colour);
  }
  /// Words on a card beside a place.
  void words(const Eigen::Vector3d& grid_m, const std::string& text, ImU32 colour) const {
    ImVec2 at;
    if (text.empty() || !place(grid_m, at)) return;
    const float pad = brush_.px(6.0F), room = brush_.px(300.0F);
    const std::string shown = brush_.elided(brush_.fonts.small, text, room);
    const ImVec2 size = brush_.size(brush_.fonts.small, shown);
    const float x = at.x + brush_.px(12.0F), y = at.y - 0.5F * size.y;
    brush_.card(x - pad, y - 0.6F * pad, size.x + 2.0F * pad, size.y + 1.2F * pad, brush_.theme.card, brush_.px(6.0F));
    brush_.text(brush_.fonts.small, x, y, colour, shown);
  }

 private:
  const Brush& brush_;
  const Picture& picture_;
  int left_, top_;
};

void draw_measure(const Brush& brush, const Plotter& plotter, const Measure& measure,
                  const std::vector<ProfileSample>* profile, ImU32 colour) {
  std::vector<Eigen::Vector3d> places = measure.points_m;
  if (profile != nullptr && !profile->empty()) {
    places.clear();
    for (const ProfileSample& sample : *profile) places.push_back(sample.at_m);
  } else if (measure.kind == Measure::Kind::profile) {
    constexpr int kPieces = 128;
    places.clear();
    for (int k = 0; k <= kPieces; ++k) {
      const Eigen::Vector3d p = measure.points_m[0] + (measure.points_m[1] - measure.points_m[0]) * k / kPieces;
      places.push_back(plotter.on_stone(p.x(), p.y()));
    }
  }
  plotter.line(places, colour, brush.px(2.0F));
  for (const Eigen::Vector3d& point : measure.points_m) plotter.dot(point, colour, brush.px(4.0F));
  const Eigen::Vector3d middle = measure.kind == Measure::Kind::angle
                                     ? measure.points_m[1]
                                     : Eigen::Vector3d(0.5 * (measure.points_m[0] + measure.points_m[1]));
  plotter.words(middle, value_text(measure), brush.theme.text);
}

void draw_outline(const Brush& brush, const Plotter& plotter, const PartBox& part) {
  // As long as those of a box, that lines lie on the stone; corners of a fine outline are closer.
  constexpr double kPieces = 24.0;
  const double piece_m = std::max(part.box_m[2] - part.box_m[0], part.box_m[3] - part.box_m[1]) / kPieces;
  std::optional<Eigen::Vector2d> upper_left;
  for (const auto& border : part.borders_m) {
    std::vector<Eigen::Vector3d> places;
    for (std::size_t c = 0; c + 1 < border.size(); ++c) {
      const Eigen::Vector2d way = border[c + 1] - border[c];
      const int pieces = std::clamp(static_cast<int>(std::ceil(way.norm() / piece_m)), 1, 64);
      for (int k = 0; k < pieces; ++k) {
        const Eigen::Vector2d p = border[c] + way * k / pieces;
        places.push_back(plotter.on_stone(p.x(), p.y()));
      }
      if (!upper_left || border[c].y() - border[c].x() > upper_left->y() - upper_left->x()) upper_left = border[c];
    }
    places.push_back(plotter.on_stone(border.back().x(), border.back().y()));
    plotter.line(places, brush.theme.accent, brush.px(1.8F));
  }
  if (upper_left) plotter.words(plotter.on_stone(upper_left->x(), upper_left->y()), part.name, brush.theme.text);
}

void draw_part(const Brush& brush, const Plotter& plotter, const PartBox& part, bool handles) {
  if (!part.is_box) return draw_outline(brush, plotter, part);
  const auto corners = corners_of(part.box_m);
  constexpr int kPieces = 24;
  std::vector<Eigen::Vector3d> border;
  for (std::size_t c = 0; c < corners.size(); ++c)
    for (int k = 0; k <= kPieces; ++k) {
      const Eigen::Vector3d p = corners[c] + (corners[(c + 1) % 4] - corners[c]) * k / kPieces;
      border.push_back(plotter.on_stone(p.x(), p.y()));
    }
  const ImU32 colour = brush.theme.accent;
  plotter.line(border, colour, brush.px(1.8F));
  if (handles) {
    for (const Eigen::Vector3d& corner : corners)
      plotter.dot(plotter.on_stone(corner.x(), corner.y()), colour, brush.px(5.0F));
    const Eigen::Vector3d middle = 0.5 * (corners[0] + corners[2]);
    plotter.dot(plotter.on_stone(middle.x(), middle.y()), colour, brush.px(4.0F));
  }
  plotter.words(plotter.on_stone(corners[3].x(), corners[3].y()), part.name, brush.theme.text);
}

/// Heights along the newest profile over the lower left of the view.
void draw_profile(const Brush& brush, const Layout& layout, const std::vector<ProfileSample>& profile) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const ProfileSample& sample : profile) {
    if (!std::isfinite(sample.at_m.z())) continue;
    low = std::min(low, sample.at_m.z());
    high = std::max(high, sample.at_m.z());
  }
  if (!(high >= low)) return;
  const float room_w = static_cast<float>(layout.detail.width) - brush.px(32.0F);
  const float width = std::min(brush.px(460.0F), room_w), height = brush.px(168.0F);
  if (height > 0.6F * static_cast<float>(layout.detail.height)) return;
  const float left = static_cast<float>(layout.detail.x) + brush.px(16.0F);
  const float top = static_cast<float>(layout.detail.y + layout.detail.height) - height - brush.px(14.0F);
  brush.card(left, top, width, height, (brush.theme.card & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 238), brush.px(10.0F));
  brush.list->AddRect(ImVec2(left, top), ImVec2(left + width, top + height), brush.theme.line, brush.px(10.0F));
  const float pad = brush.px(12.0F);
  const std::string depth = length_text(high - low, TextStyle::screen) + " deep";
  const float depth_w = brush.size(brush.fonts.small, depth).x;
  brush.text(
      brush.fonts.small, left + pad, top + brush.px(8.0F), brush.theme.text,
      brush.elided(brush.fonts.small, "Profile, " + length_text(profile.back().along_m, TextStyle::screen) + " long",
                   width - 3.0F * pad - depth_w));
  brush.text_right(brush.fonts.small, left + width - pad, top + brush.px(8.0F), brush.theme.text, depth);
  const float x = left + pad, y = top + brush.px(34.0F), w = width - 2.0F * pad, h = height - brush.px(48.0F);
  const ImU32 grid = brush.theme.line;
  const double span = std::max(high - low, 1e-12), length_m = std::max(profile.back().along_m, 1e-12);
  const double step_m = round_number(0.5 * span);
  for (double level_m = 0.0; step_m > 0.0 && level_m <= span * (1.0 + 1e-9); level_m += step_m) {
    const float at = y + h * static_cast<float>(1.0 - level_m / span);
    brush.list->AddLine(ImVec2(x, at), ImVec2(x + w, at), grid);
  }
  const auto flush = [&](std::vector<ImVec2>& points, bool filled) {
    if (points.size() > 1)
      brush.list->AddPolyline(points.data(), static_cast<int>(points.size()),
                              filled ? IM_COL32(110, 190, 255, 255) : brush.theme.accent, 0, brush.px(2.0F));
    points.clear();
  };
  std::vector<ImVec2> points;
  bool filled = false;
  const std::size_t stride = std::max<std::size_t>(1, profile.size() / 1024);
  for (std::size_t k = 0; k < profile.size(); k += stride) {
    const ProfileSample& sample = profile[k];
    const bool is_filled = sample.state == scene::NodeState::filled;
    if (!std::isfinite(sample.at_m.z())) {
      flush(points, filled);
      continue;
    }
    const ImVec2 point(x + w * static_cast<float>(sample.along_m / length_m),
                       y + h * static_cast<float>(1.0 - (sample.at_m.z() - low) / span));
    if (is_filled != filled && !points.empty()) {
      points.push_back(point);
      flush(points, filled);
    }
    filled = is_filled;
    points.push_back(point);
  }
  flush(points, filled);
}

void draw_typing(const Brush& brush, const Layout& layout, const std::string& words) {
  const float room = static_cast<float>(layout.detail.width);
  const float width = std::min(brush.px(520.0F), room - brush.px(16.0F)), height = brush.px(86.0F);
  const float x = static_cast<float>(layout.detail.x) + 0.5F * (room - width);
  const float y = static_cast<float>(layout.detail.y) + 0.36F * static_cast<float>(layout.detail.height);
  brush.card(x, y, width, height, (brush.theme.card & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 248), brush.px(12.0F));
  brush.list->AddRect(ImVec2(x, y), ImVec2(x + width, y + height), brush.theme.accent, brush.px(12.0F), 0,
                      brush.px(2.0F));
  const float inside = width - brush.px(32.0F);
  // The end is what is being written.
  std::string shown = words + "_";
  while (shown.size() > 1 && brush.size(brush.fonts.strong, shown).x > inside) {
    shown.erase(0, 1);
    while (!shown.empty() && (static_cast<unsigned char>(shown.front()) & 0xC0U) == 0x80U) shown.erase(0, 1);
  }
  brush.text(brush.fonts.strong, x + brush.px(16.0F), y + brush.px(16.0F), brush.theme.text, shown);
  brush.text(brush.fonts.small, x + brush.px(16.0F), y + brush.px(54.0F), brush.theme.dim,
             brush.elided(brush.fonts.small, "Enter keeps the words, Esc drops them", inside));
}

}  // namespace

void draw_marks(const Brush& brush, const Frame& frame, const Layout& layout, const Picture& picture) {
  const Marks& marks = frame.marks;
  const Rect& detail = layout.detail;
  brush.list->PushClipRect(
      ImVec2(static_cast<float>(detail.x), static_cast<float>(detail.y)),
      ImVec2(static_cast<float>(detail.x + detail.width), static_cast<float>(detail.y + detail.height)), true);
  const bool kiosk = frame.settings.kiosk;
  const ImU32 colour = frame.settings.high_contrast ? brush.theme.accent : IM_COL32(150, 226, 255, 255);
  const int eyes = frame.settings.stereo.mode == StereoMode::side_by_side ? 2 : 1;
  for (int eye = 0; eye < eyes; ++eye) {
    const Plotter plotter(brush, layout, picture, eye);
    if (frame.settings.parts)
      for (const PartBox& part : marks.parts) draw_part(brush, plotter, part, !marks.parts_fixed);
    if (!kiosk) {
      const auto& measures = marks.notes.measures;
      for (const Measure& measure : measures)
        draw_measure(brush, plotter, measure, &measure == &measures.back() ? &marks.profile : nullptr, colour);
      plotter.line(marks.pending_m, colour, brush.px(2.0F));
      for (const Eigen::Vector3d& point : marks.pending_m) plotter.dot(point, colour, brush.px(4.0F));
    }
    for (std::size_t k = 0; k < marks.notes.pins.size(); ++k) {
      const Pin& pin = marks.notes.pins[k];
      if (k < marks.pin_normals.size() &&
          looks_away(picture.detail_view(), picture.stage(), pin.at_m, marks.pin_normals[k]))
        continue;
      plotter.dot(pin.at_m, brush.theme.accent, brush.px(6.0F));
      plotter.words(pin.at_m, pin.text, brush.theme.text);
    }
  }
  if (!kiosk && !marks.profile.empty()) draw_profile(brush, layout, marks.profile);
  if (marks.typing) draw_typing(brush, layout, *marks.typing);
  brush.list->PopClipRect();
}

}  // namespace sparsha::viewer
