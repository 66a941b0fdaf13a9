// What is on the screen, as a file.
#pragma once

#include <filesystem>

namespace sparsha::viewer {

/// Writes the window's framebuffer as PNG, atomically. Throws Error{failure} when it cannot be written.
void write_framebuffer(int width, int height, const std::filesystem::path& file);

}  // namespace sparsha::viewer
