// A display that goes away under an open window: Xlib would end the program, which must go on without it.
#pragma once

namespace sparsha::viewer {

/// After GLFW's start, before windows: from now on a lost connection to the display is remembered and Xlib's calls come
/// back. Does nothing where there is no X.
void survive_display_loss();
/// True when the connection made since then was lost.
[[nodiscard]] bool display_lost();

}  // namespace sparsha::viewer
