// Files dropped into a window of the X server as a file manager does it (XDND, version 5).
#pragma once

#include <string>

namespace sparsha::viewer::test {

/// Drops `uri_list` (file:// lines, CR LF each) into the middle of the window; false when its program does not take it
/// within some seconds. DISPLAY names the server.
bool drop_files(unsigned long window, const std::string& uri_list);

}  // namespace sparsha::viewer::test
