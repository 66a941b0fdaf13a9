// What a desktop does with a window of the X server: files dropped into it (XDND, version 5), and its end.
#pragma once

#include <string>

namespace sparsha::viewer::test {

/// Drops `uri_list` (file:// lines, CR LF each) into the middle of the window; false when its program does not take it
/// within some seconds. DISPLAY names the server.
bool drop_files(unsigned long window, const std::string& uri_list);

/// Asks the window to close as a window manager does on Alt+F4.
bool ask_to_close(unsigned long window);

}  // namespace sparsha::viewer::test
