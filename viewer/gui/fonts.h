// Type for the interface: a plain and a bold face in several sizes.
#pragma once

#include <string_view>

struct ImFont;

namespace sparsha::viewer {

struct Fonts {
  ImFont* small = nullptr;   ///< 13 px at scale 1
  ImFont* text = nullptr;    ///< 16 px
  ImFont* strong = nullptr;  ///< 16 px, bold
  ImFont* medium = nullptr;  ///< 20 px, bold: long announcements
  ImFont* large = nullptr;   ///< 27 px, bold: announcements and figures
};

/// Fills ImGui's atlas for one scale. Without any outline font on the machine ImGui's own bitmap face is used.
[[nodiscard]] Fonts load_fonts(double scale);

/// False where most letters of `text` (UTF-8) are of a script that these fonts do not write: question marks would stand
/// there.
[[nodiscard]] bool can_show(std::string_view text);

}  // namespace sparsha::viewer
