// The panel's fields and buttons (Dear ImGui, also by keyboard), and the marks over the cloud.
#include "viewer/cloud/panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>

#include <Eigen/Geometry>

#include "base/text/text.h"

namespace sparsha::viewer {
namespace {

using scene::LengthUnit;

constexpr std::array kUnits{LengthUnit::m, LengthUnit::cm, LengthUnit::mm, LengthUnit::ft, LengthUnit::us_ft};

std::string length(double metres) { return length_text(metres, TextStyle::screen); }

ImVec2 at(const Layout& layout, const Eigen::Vector2d& pixel) {
  return {static_cast<float>(layout.detail.x + pixel.x()), static_cast<float>(layout.detail.y + pixel.y())};
}

/// ImGui's own widgets in the interface's colours and type, while it exists.
class WidgetStyle {
 public:
  explicit WidgetStyle(const Brush& brush) {
    const auto colour = [&](ImGuiCol slot, ImU32 value) {
      ImGui::PushStyleColor(slot, value);
      ++colours_;
    };
    colour(ImGuiCol_Text, brush.theme.text);
    colour(ImGuiCol_TextDisabled, brush.theme.dim);
    colour(ImGuiCol_WindowBg, brush.theme.panel);
    colour(ImGuiCol_PopupBg, brush.theme.panel);
    colour(ImGuiCol_FrameBg, brush.theme.key);
    colour(ImGuiCol_Button, brush.theme.key);
    colour(ImGuiCol_ButtonHovered, IM_COL32(246, 166, 58, 110));
    colour(ImGuiCol_ButtonActive, IM_COL32(246, 166, 58, 190));
    colour(ImGuiCol_HeaderHovered, IM_COL32(246, 166, 58, 110));
    colour(ImGuiCol_PlotHistogram, brush.theme.accent);
    colour(ImGuiCol_CheckMark, brush.theme.accent);
    colour(ImGuiCol_NavHighlight, IM_COL32(255, 255, 255, 255));
    colour(ImGuiCol_Border, brush.theme.line);
    const auto variable = [&](ImGuiStyleVar slot, const ImVec2& value) {
      ImGui::PushStyleVar(slot, value);
      ++variables_;
    };
    variable(ImGuiStyleVar_WindowPadding, {brush.px(16.0F), brush.px(12.0F)});
    variable(ImGuiStyleVar_FramePadding, {brush.px(6.0F), brush.px(4.0F)});
    variable(ImGuiStyleVar_ItemSpacing, {brush.px(6.0F), brush.px(5.0F)});
    const auto number = [&](ImGuiStyleVar slot, float value) {
      ImGui::PushStyleVar(slot, value);
      ++variables_;
    };
    number(ImGuiStyleVar_FrameRounding, brush.px(6.0F));
    number(ImGuiStyleVar_WindowBorderSize, 0.0F);
    number(ImGuiStyleVar_ScrollbarSize, brush.px(10.0F));
    ImGui::PushFont(brush.fonts.small);
  }
  ~WidgetStyle() {
    ImGui::PopFont();
    ImGui::PopStyleVar(variables_);
    ImGui::PopStyleColor(colours_);
  }
  WidgetStyle(const WidgetStyle&) = delete;
  WidgetStyle& operator=(const WidgetStyle&) = delete;

 private:
  int colours_ = 0, variables_ = 0;
};

/// Tells tests of the layout what the last item says, which ImGui cuts off where it has no room: from `before` its left
/// edge on to `after` before its right one.
void record(const Brush& brush, const std::string& words, float before = 0.0F, float after = 0.0F) {
  if (brush.drawn == nullptr || !ImGui::IsItemVisible()) return;
  const ImVec2 window = ImGui::GetWindowPos(), low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const float left = low.x + before;
  const float right = std::min(high.x - after, window.x + ImGui::GetWindowContentRegionMax().x);
  const float top = std::max(low.y, window.y), bottom = std::min(high.y, window.y + ImGui::GetWindowHeight());
  brush.drawn->push_back({words, left, top, ImGui::CalcTextSize(words.c_str()).x, bottom - top, brush.layer,
                          std::max(1.0F, right - left)});
}

bool button(const Brush& brush, const std::string& label, float width = -1.0F) {
  const bool pressed = ImGui::Button(label.c_str(), {width, 0.0F});
  record(brush, label, ImGui::GetStyle().FramePadding.x, ImGui::GetStyle().FramePadding.x);
  return pressed;
}

void line(const Brush& brush, const char* words) {
  ImGui::TextUnformatted(words);
  record(brush, words);
}

bool check(const Brush& brush, const char* label, bool& on) {
  const bool changed = ImGui::Checkbox(label, &on);
  record(brush, label, ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x);
  return changed;
}

void heading(const Brush& brush, const char* words) {
  ImGui::Dummy({1.0F, brush.px(2.0F)});
  ImGui::PushFont(brush.fonts.strong);
  ImGui::PushStyleColor(ImGuiCol_Text, brush.theme.accent);
  line(brush, words);
  ImGui::PopStyleColor();
  ImGui::PopFont();
}

/// A row of buttons of one width.
void buttons(const Brush& brush, CloudController& controller, std::initializer_list<CloudAction> actions,
             bool enabled = true) {
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float width = (ImGui::GetContentRegionAvail().x - gap * static_cast<float>(actions.size() - 1)) /
                      static_cast<float>(actions.size());
  ImGui::BeginDisabled(!enabled);
  bool first = true;
  for (const CloudAction action : actions) {
    if (!std::exchange(first, false)) ImGui::SameLine();
    if (button(brush, info_of(action).label, width)) controller.act(action);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s (%s)", info_of(action).what, info_of(action).keys);
  }
  ImGui::EndDisabled();
}

void orientation_part(const Brush& brush, CloudController& controller) {
  using enum CloudAction;
  const CloudFrame& frame = controller.frame();
  heading(brush, "Front");
  const bool ready = frame.status.points != nullptr;
  buttons(brush, controller, {front, rear, left}, ready);
  buttons(brush, controller, {right, top, bottom}, ready);
  buttons(brush, controller, {flat_face, broad_side}, ready && !frame.status.busy);
  buttons(brush, controller, {as_scanned, upright, undo}, ready);
  line(brush, "Up axis");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(0.35F * ImGui::GetContentRegionAvail().x);
  ImGui::BeginDisabled(!ready);
  const UpAxis up = frame.up.value_or(UpAxis(ready && frame.status.points->z_up));
  if (ImGui::BeginCombo("##up", up.name())) {
    for (const UpAxis& choice : all_up_axes())
      if (ImGui::Selectable(choice.name(), choice == up)) controller.set_up(choice);
    ImGui::EndCombo();
  }
  ImGui::EndDisabled();
  const Eigen::Vector3d angles = euler_deg(frame.setup.scan_to_grid);
  std::array<double, 3> edited{angles.x(), angles.y(), angles.z()};
  line(brush, "Angles about x, y, z (euler_deg)");
  ImGui::SetNextItemWidth(-1.0F);
  if (ImGui::InputScalarN("##angles", ImGuiDataType_Double, edited.data(), 3, nullptr, nullptr, "%.2f",
                          ImGuiInputTextFlags_EnterReturnsTrue))
    controller.set_euler({edited[0], edited[1], edited[2]});
  bool ball = frame.free_ball;
  if (check(brush, "Free ball (off: turntable)", ball)) controller.act(free_ball);
}

// ImGui's OpenGL backend takes a texture's name as a pointer.
ImTextureID id_of(unsigned texture) {
  // NOLINTNEXTLINE(performance-no-int-to-ptr)
  return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture));
}

// Three pictures a row, each a button.
void sides_part(const Brush& brush, CloudController& controller, unsigned texture) {
  const std::shared_ptr<const SidePictures> pictures = controller.frame().status.sides;
  if (!pictures || texture == 0) return;
  heading(brush, "Which side is its front?");
  constexpr int kColumns = 3;
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float width = (ImGui::GetContentRegionAvail().x - gap * (kColumns - 1)) / kColumns;
  const auto count = static_cast<float>(pictures->sides.size());
  for (std::size_t n = 0; n < pictures->sides.size(); ++n) {
    const SidePictures::Side& side = pictures->sides[n];
    if (n % kColumns != 0) ImGui::SameLine();
    ImGui::PushID(static_cast<int>(n));
    ImGui::BeginGroup();
    const auto k = static_cast<float>(n);
    if (ImGui::ImageButton(id_of(texture), {width - 2.0F, width - 2.0F}, {k / count, 1.0F}, {(k + 1.0F) / count, 0.0F},
                           1))
      controller.choose_side(n);
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 0.5F * (width - ImGui::CalcTextSize(side.name.c_str()).x));
    line(brush, side.name.c_str());
    ImGui::EndGroup();
    ImGui::PopID();
  }
}

void scans_part(const Brush& brush, CloudController& controller) {
  const CloudFrame& frame = controller.frame();
  const PointView* points = frame.status.points.get();
  if (points == nullptr) return;
  heading(brush, "Scans");
  std::string size = length(static_cast<double>((points->high - points->low).x()));
  for (int axis = 1; axis < 3; ++axis) size += " x " + length(static_cast<double>((points->high - points->low)[axis]));
  ImGui::TextWrapped("%s point%s, %s", count_text(points->total, TextStyle::plain).c_str(),
                     points->total == 1 ? "" : "s", size.c_str());
  const std::uint64_t shown = points->points.size() + (frame.status.detail ? frame.status.detail->points : 0);
  if (points->total > shown) {
    ImGui::TextWrapped("%s of them are shown%s", count_text(shown, TextStyle::plain).c_str(),
                       frame.status.refining ? "; more are being read" : "");
  }
  if (frame.status.scattered > 0)
    ImGui::TextWrapped("about %s of them are scattered in space: a depth scan leaves them out",
                       count_text(frame.status.scattered, TextStyle::plain).c_str());
  line(brush, "Unit");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(0.35F * ImGui::GetContentRegionAvail().x);
  ImGui::BeginDisabled(frame.status.busy || !(points->metres_per_unit > 0.0));
  const std::string unit = points->metres_per_unit > 0.0 ? scene::to_string(points->unit) : "several";
  if (ImGui::BeginCombo("##unit", unit == "unknown" ? "m" : unit.c_str())) {
    for (const LengthUnit choice : kUnits)
      if (ImGui::Selectable(scene::to_string(choice).c_str(), choice == points->unit)) controller.set_unit(choice);
    ImGui::EndCombo();
  }
  ImGui::EndDisabled();
  ImGui::SameLine();
  if (button(brush, fmt::format("Colour: {}", name_of(frame.colour)))) controller.act(CloudAction::colour);

  bool crops = frame.setup.crop.has_value();
  if (check(brush, "Crop box", crops)) {
    if (crops)
      controller.act(CloudAction::crop);
    else
      controller.set_crop(std::nullopt);
  }
  if (!frame.setup.crop) return;
  ImGui::SameLine();
  bool handles = frame.edits_crop;
  if (check(brush, "handles", handles)) controller.act(CloudAction::crop);
  scene::CropConfig crop = *frame.setup.crop;
  bool edited = false;
  for (const auto& [label, corner] : {std::pair{"from, m", &crop.min_m}, std::pair{"to, m", &crop.max_m}}) {
    ImGui::SetNextItemWidth(0.82F * ImGui::GetContentRegionAvail().x);
    edited = ImGui::InputScalarN(label, ImGuiDataType_Double, corner->data(), 3, nullptr, nullptr, "%.3f",
                                 ImGuiInputTextFlags_EnterReturnsTrue) ||
             edited;
  }
  if (edited) controller.set_crop(crop);
}

void preview_part(const Brush& brush, const CloudFrame& frame, unsigned texture) {
  heading(brush, "What the depth scan will see");
  const DepthPreview& preview = frame.preview;
  if (!preview.any || texture == 0) {
    line(brush, frame.status.points ? "no point is left" : "nothing yet");
    return;
  }
  const float room = ImGui::GetContentRegionAvail().x;
  const float most = std::max(brush.px(150.0F), 1.0F);
  const float scale = std::min(room / static_cast<float>(preview.nx), most / static_cast<float>(preview.ny));
  const ImVec2 size{scale * static_cast<float>(preview.nx), scale * static_cast<float>(preview.ny)};
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 0.5F * (room - size.x));
  ImGui::Image(id_of(texture), size);

  ImGui::TextWrapped("%s", size_text(preview).c_str());
  ImGui::TextWrapped("%.0f %% of it covered (violet: no points)", 100.0 * preview.coverage);
  const double spacing_m = frame.status.spacing_m;
  if (spacing_m > 0.0)
    ImGui::TextWrapped("%.0f x %.0f nodes, one every %s", std::floor(preview.size_m().x() / spacing_m) + 1.0,
                       std::floor(preview.size_m().y() / spacing_m) + 1.0, length(spacing_m).c_str());
}

void work_part(const Brush& brush, CloudController& controller) {
  const CloudFrame& frame = controller.frame();
  const OrientingStatus& status = frame.status;
  if (status.busy) {
    ImGui::ProgressBar(static_cast<float>(status.fraction), {-1.0F, 0.0F}, status.stage.c_str());
    if (button(brush, "Stop (Esc)")) controller.cancel();
    return;
  }
  const bool ready = status.points && frame.preview.any;
  ImGui::BeginDisabled(!ready);
  ImGui::PushFont(brush.fonts.medium);
  ImGui::PushStyleColor(ImGuiCol_Button, brush.theme.accent);
  ImGui::PushStyleColor(ImGuiCol_Text, brush.theme.accent_text);
  if (button(brush, "Scan (Enter)")) controller.act(CloudAction::scan);
  ImGui::PopStyleColor(2);
  ImGui::PopFont();
  ImGui::EndDisabled();
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  ImGui::BeginDisabled(!ready);
  if (button(brush, status.can_save_scene ? "Save" : "Save (Ctrl S)", half)) controller.act(CloudAction::save);
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::BeginDisabled(!status.can_save_scene);
  if (button(brush, status.can_save_scene ? "Scene (Ctrl S)" : "Save scene", half))
    controller.act(CloudAction::save_scene);
  ImGui::EndDisabled();
  const char* leave = frame.can_go_back ? "Back (Esc)" : "Leave (Esc)";
  if (button(brush, leave)) controller.act(CloudAction::back);
}

}  // namespace

std::string size_text(const DepthPreview& preview) {
  const Eigen::Vector3d size = preview.size_m();
  return fmt::format("{} x {}, {} deep", length(size.x()), length(size.y()), length(size.z()));
}

void draw_cloud_panel(const Brush& brush, CloudController& controller, const Layout& layout,
                      const CloudTextures& textures) {
  const WidgetStyle style(brush);
  const CloudFrame& frame = controller.frame();
  ImGui::SetNextWindowPos({static_cast<float>(layout.panel.x), static_cast<float>(layout.panel.y)});
  ImGui::SetNextWindowSize({static_cast<float>(layout.panel.width), static_cast<float>(layout.panel.height)});
  ImGui::Begin("cloud", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PushFont(brush.fonts.medium);
  ImGui::TextWrapped("%s", frame.status.points                          ? frame.status.points->title.c_str()
                           : frame.status.busy || !frame.status.problem ? "Reading the scans"
                                                                        : "The scans cannot be read");
  ImGui::PopFont();
  const float foot = frame.status.busy ? brush.px(64.0F) : brush.px(76.0F);
  ImGui::BeginChild("parts", {0.0F, -foot}, false, ImGuiWindowFlags_NavFlattened);
  sides_part(brush, controller, textures.sides);
  orientation_part(brush, controller);
  scans_part(brush, controller);
  preview_part(brush, frame, textures.preview);
  ImGui::EndChild();
  work_part(brush, controller);
  ImGui::End();
}

void draw_cloud_marks(const Brush& brush, const CloudController& controller, const Layout& layout) {
  const CloudFrame& frame = controller.frame();
  const PointView* points = frame.status.points.get();
  if (points == nullptr) return;
  const SplatView& view = frame.view;
  ImDrawList& list = *brush.list;
  list.PushClipRect(at(layout, {0.0, 0.0}), at(layout, {1.0 * layout.detail.width, 1.0 * layout.detail.height}));
  if (frame.preview.any) {
    // The grid's outline lies in the picture's plane.
    const Eigen::Vector3d origin = (frame.setup.scan_to_grid * points->origin_m.homogeneous()).head<3>();
    const Eigen::Vector3d target = view.scan_to_view * view.target_m;
    const auto pixel = [&](const Eigen::Vector3d& grid_m) {
      const Eigen::Vector3d from = view.pixels_per_m * (grid_m - origin - target);
      return Eigen::Vector2d(0.5 * view.width + from.x(), 0.5 * view.height - from.y());
    };
    const Eigen::Vector2d low = pixel(frame.preview.low_m), high = pixel(frame.preview.high_m);
    const Eigen::Vector2d top_left(low.x(), high.y()), bottom_right(high.x(), low.y());
    list.AddRect(at(layout, top_left), at(layout, bottom_right), brush.theme.accent, 0.0F, 0, brush.px(1.5F));
    const Eigen::Vector3d size = frame.preview.size_m();
    const float line = brush.fonts.strong->FontSize;
    const ImVec2 middle = at(layout, {0.5 * (low.x() + high.x()), std::min(low.y(), view.height - 3.0 * line)});
    brush.text_centred(brush.fonts.strong, middle.x, middle.y + brush.px(5.0F), brush.theme.text, length(size.x()));
    const ImVec2 beside = at(layout, {std::min(high.x(), view.width - 5.0 * line), 0.5 * (low.y() + high.y())});
    brush.text(brush.fonts.strong, beside.x + brush.px(8.0F), beside.y - 0.5F * line, brush.theme.text,
               length(size.y()));
  }
  if (frame.setup.crop) {
    const auto corner = [&](int k) {
      const scene::CropConfig& crop = *frame.setup.crop;
      const Eigen::Vector3d place((k & 1) != 0 ? crop.max_m.x() : crop.min_m.x(),
                                  (k & 2) != 0 ? crop.max_m.y() : crop.min_m.y(),
                                  (k & 4) != 0 ? crop.max_m.z() : crop.min_m.z());
      return at(layout, view.to_pixel(place - points->origin_m).head<2>());
    };
    for (int k = 0; k < 8; ++k)
      for (const int bit : {1, 2, 4})
        if ((k & bit) == 0) list.AddLine(corner(k), corner(k | bit), IM_COL32(120, 200, 255, 200), brush.px(1.2F));
    for (int handle = 0; frame.edits_crop && handle < 6; ++handle) {
      const auto middle = controller.crop_handle(handle);
      if (!middle) continue;
      list.AddCircleFilled(at(layout, *middle), brush.px(7.0F),
                           frame.held == handle ? brush.theme.accent : IM_COL32(120, 200, 255, 255));
      list.AddCircle(at(layout, *middle), brush.px(7.0F), IM_COL32(0, 0, 0, 255), 0, brush.px(1.5F));
    }
  }
  // The scan frame's axes.
  const float reach = brush.px(30.0F);
  const ImVec2 foot =
      at(layout, {46.0 * static_cast<double>(brush.scale), view.height - 46.0 * static_cast<double>(brush.scale)});
  constexpr std::array<ImU32, 3> kInk{IM_COL32(255, 120, 100, 255), IM_COL32(130, 220, 120, 255),
                                      IM_COL32(120, 170, 255, 255)};
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3f way = view.scan_to_view.col(axis).normalized().cast<float>();
    const ImVec2 tip{foot.x + reach * way.x(), foot.y - reach * way.y()};
    list.AddLine(foot, tip, kInk[static_cast<std::size_t>(axis)], brush.px(2.5F));
    brush.text_centred(brush.fonts.small, foot.x + 1.32F * reach * way.x(),
                       foot.y - 1.32F * reach * way.y() - 0.5F * brush.fonts.small->FontSize,
                       kInk[static_cast<std::size_t>(axis)], std::string(1, static_cast<char>('x' + axis)));
  }
  list.PopClipRect();
}

void draw_cloud_help(const Brush& brush, int width, int height) {
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  brush.list->AddRectFilled({0.0F, 0.0F}, {w, h}, IM_COL32(0, 0, 0, 150));
  const float card_w = std::min(w - brush.px(32.0F), brush.px(1120.0F));
  const float card_h = std::min(h - brush.px(32.0F), brush.px(560.0F));
  const float left = 0.5F * (w - card_w), top = 0.5F * (h - card_h), margin = brush.px(28.0F);
  brush.card(left, top, card_w, card_h, (brush.theme.panel & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 246),
             brush.px(16.0F));
  const float room = card_w - 2.0F * margin;
  const std::string title = "Turn the object until its front looks at you, then scan";
  const std::string mouse =
      "Mouse: left drag = turn, both buttons = roll, right drag = move, wheel = closer. Tab goes to the panel, Esc "
      "comes "
      "back.";
  const ImFont* font = brush.fitting(brush.fonts.large, title, room);
  brush.text(font, left + margin, top + brush.px(18.0F), brush.theme.text, brush.elided(font, title, room));
  brush.text(brush.fonts.small, left + margin, top + brush.px(56.0F), brush.theme.dim,
             brush.elided(brush.fonts.small, mouse, room));
  const auto rows = (all_cloud_actions().size() + 1) / 2;
  const float row = (card_h - brush.px(96.0F)) / static_cast<float>(rows);
  std::size_t n = 0;
  for (const CloudActionInfo& info : all_cloud_actions()) {
    const float x = left + margin + (n < rows ? 0.0F : 0.5F * room);
    const float y = top + brush.px(84.0F) + row * static_cast<float>(n % rows);
    brush.key_cap(x, y, info.keys);
    brush.text(brush.fonts.small, x + brush.px(84.0F), y + brush.px(2.0F), brush.theme.text,
               brush.elided(brush.fonts.small, info.what, 0.5F * room - brush.px(92.0F)));
    ++n;
  }
}

}  // namespace sparsha::viewer
