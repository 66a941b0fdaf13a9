// The interface of one frame: panel, bar of buttons, announcements, help.
#include "viewer/gui/gui.h"

#include <algorithm>
#include <cmath>

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "base/error.h"
#include "viewer/gui/brush.h"
#include "viewer/gui/parts.h"
#include "viewer/kiosk/kiosk_help.h"
#include "viewer/picture.h"

namespace sparsha::viewer {

struct Gui::Implementation {
  ImGuiContext* context = nullptr;
  Fonts fonts;
  double scale = 0.0;
  bool started = false;
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
  Brush over;
  over.list = ImGui::GetBackgroundDrawList();
  over.fonts = self.fonts;
  over.theme = theme_of(settings.high_contrast);
  over.scale = static_cast<float>(layout.scale);
  Brush above = over;
  above.list = ImGui::GetForegroundDrawList();
  pieces(over, above);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

std::vector<Action> Gui::draw(const Frame& frame, const std::vector<Action>& buttons, const Picture& picture, int width,
                              int height, double seconds) {
  std::vector<Action> clicked;
  draw_pieces(frame.settings, width, height, seconds, [&](const Brush& over, const Brush& above) {
    const Layout layout = layout_of(width, height, frame.settings);
    if (picture.scene()) {
      draw_scale_bar(over, frame, layout, picture);
      draw_overview_marks(over, frame, layout, *picture.scene());
      if (!frame.settings.kiosk) draw_panel(over, frame, layout, picture);
    }
    clicked = draw_buttons(over, frame, layout, buttons);
    draw_toasts(above, frame, layout);
    if (frame.settings.help) (frame.settings.kiosk ? draw_kiosk_help : draw_help)(above, frame, width, height);
    if (frame.asks_rescan) draw_question(above, layout);
  });
  return clicked;
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
