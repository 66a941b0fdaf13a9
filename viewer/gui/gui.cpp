// The interface of one frame: panel, bar of buttons, announcements, help.
#include "viewer/gui/gui.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "base/error.h"
#include "viewer/gui/brush.h"
#include "viewer/gui/parts.h"
#include "viewer/kiosk/help.h"
#include "viewer/picture/picture.h"

namespace sparsha::viewer {

struct Gui::Implementation {
  ImGuiContext* context = nullptr;
  Fonts fonts;
  double scale = 0.0;
  bool started = false;
  std::vector<Clickable> boxes;
  int help_pages = 1;
  std::vector<DrawnText> texts;
};

Gui::Gui() : implementation_(std::make_unique<Implementation>()) {
  IMGUI_CHECKVERSION();
  implementation_->context = ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui::GetIO().LogFilename = nullptr;
  if (!ImGui_ImplOpenGL3_Init("#version 330"))
    throw Error(ErrorKind::failure, {}, "the interface could not be set up on this graphics driver");
  implementation_->started = true;
  // Creates a texture for the font, which load_fonts() replaces at the first frame.
  ImGui_ImplOpenGL3_CreateDeviceObjects();
}

Gui::~Gui() {
  ImGui::SetCurrentContext(implementation_->context);
  if (implementation_->started) ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext(implementation_->context);
}

bool Gui::wants_mouse() const { return ImGui::GetIO().WantCaptureMouse; }
const std::vector<Clickable>& Gui::boxes() const { return implementation_->boxes; }
int Gui::help_pages() const { return implementation_->help_pages; }
const std::vector<DrawnText>& Gui::texts() const { return implementation_->texts; }

void Gui::draw_pieces(const ViewSettings& settings, int width, int height, double seconds,
                      const std::function<void(const Brush& over, const Brush& above)>& pieces) {
  Implementation& self = *implementation_;
  ImGui::SetCurrentContext(self.context);
  const Layout layout = layout_of(width, height, settings);
  if (self.scale != layout.scale) {
    self.scale = layout.scale;
    self.fonts = load_fonts(layout.scale);
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
  }
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
  io.DeltaTime = static_cast<float>(std::clamp(seconds, 1e-4, 1.0));
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  self.texts.clear();
  Brush over;
  over.list = ImGui::GetBackgroundDrawList();
  over.fonts = self.fonts;
  over.theme = theme_of(settings.high_contrast);
  over.scale = static_cast<float>(layout.scale);
  over.drawn = &self.texts;
  Brush above = over;
  above.list = ImGui::GetForegroundDrawList();
  above.layer = 2;
  pieces(over, above);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Gui::draw(const Frame& frame, const std::vector<Action>& buttons, const Picture& picture, int width, int height,
               double seconds) {
  Implementation& self = *implementation_;
  draw_pieces(frame.settings, width, height, seconds, [&](const Brush& over, const Brush& above) {
    const Layout layout = layout_of(width, height, frame.settings);
    if (picture.scene()) {
      draw_scale_bar(over, frame, layout, picture);
      Brush marks = over;
      marks.layer = 3;
      draw_marks(marks, frame, layout, picture);
      draw_overview_marks(over, frame, layout, *picture.scene());
      if (!frame.settings.kiosk) {
        draw_panel(over, frame, layout, picture);
        draw_strip(over, frame, layout);
      }
      if (frame.settings.figures) draw_figures(over, frame, layout);
    }
    self.boxes = draw_buttons(over, frame, layout, buttons);
    Brush words = over;
    words.layer = 1;
    draw_toasts(words, frame, layout, &picture);
    const auto cover = [&](std::vector<Clickable> boxes) { self.boxes = std::move(boxes); };
    if (frame.settings.help && frame.settings.kiosk) {
      draw_kiosk_help(above, frame, width, height);
      cover({{Rect{0, 0, width, height}, Clickable::Does::action, Action::help}});
    } else if (frame.settings.help) {
      cover(draw_help(above, frame, width, height, self.help_pages));
    }
    if (frame.asks_rescan) cover(draw_question(above, frame, layout));
  });
}

bool Gui::wants_keyboard() const {
  const ImGuiIO& io = ImGui::GetIO();
  return io.WantTextInput || io.NavVisible;
}

void Gui::use_keyboard(bool on) {
  ImGui::SetCurrentContext(implementation_->context);
  ImGuiIO& io = ImGui::GetIO();
  if (on)
    io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  else
    io.ConfigFlags &= ~ImGuiConfigFlags_NavEnableKeyboard;
}

}  // namespace sparsha::viewer
