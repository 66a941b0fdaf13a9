// PNG bytes of a picture with a palette, through libpng.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/check/report_colour.h"

namespace sparsha::pipeline {

/// One byte a pixel, top row first. `pixel_m` (metres a pixel, 0 = unknown) goes into the file as its physical size.
/// The same pixels give the same bytes. Throws Error{failure}.
[[nodiscard]] std::string encode_png(const std::vector<std::uint8_t>& pixels, int width, int height,
                                     const Palette& palette, double pixel_m);

/// Appends `bytes` in base 64 (RFC 4648).
void append_base64(std::string& text, const std::string& bytes);

}  // namespace sparsha::pipeline
