// The interface of one frame: panel, bar of buttons, announcements, help.
#include "viewer/gui/gui.h"

#include <algorithm>
#include <cmath>

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "base/error.h"
#include "viewer/gui/brush.h"
#include "viewer/gui/parts.h"
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

std::vector<Action> Gui::draw(const Frame& frame, const std::vector<Action>& buttons, const Picture& picture, int width,
                              int height, double seconds) {
  Implementation& self = *implementation_;
  ImGui::SetCurrentContext(self.context);
  const Layout layout = layout_of(width, height, frame.settings);
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
  Brush brush;
  brush.list = ImGui::GetBackgroundDrawList();
  brush.fonts = self.fonts;
  brush.theme = theme_of(frame.settings.high_contrast);
  brush.scale = static_cast<float>(layout.scale);

  if (picture.scene()) {
    draw_scale_bar(brush, frame, layout, picture);
    draw_overview_marks(brush, frame, layout, *picture.scene());
    if (!frame.settings.kiosk) draw_panel(brush, frame, layout, picture);
  }
  std::vector<Action> clicked = draw_buttons(brush, frame, layout, buttons);
  brush.list = ImGui::GetForegroundDrawList();
  draw_toasts(brush, frame, layout);
  if (frame.settings.help) draw_help(brush, frame, width, height);
  if (frame.asks_rescan) draw_question(brush, layout);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  return clicked;
}

}  // namespace sparsha::viewer
