// The colour of a vertex from the picture that lies on its mesh.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "base/files/files.h"
#include "pipeline/scan/file.h"
#include "pipeline/scan/formats/texture/picture.h"

namespace sparsha::pipeline {

/// sRGB to linear light and back (IEC 61966-2-1), 0 to 1.
[[nodiscard]] double linear_of_srgb(double value);
[[nodiscard]] double srgb_of_linear(double value);

/// Red, green, blue (linear light) and alpha, 0 to 1.
using Light = std::array<double, 4>;

/// What is beyond the picture's border.
enum class Wrap : std::uint8_t { repeat, mirror, clamp };

/// Bilinear between the centres of pixels, in linear light. u goes right and v down from the top left corner, in widths
/// and heights of the picture; the picture is not empty. Coordinates that are not finite count as 0.
[[nodiscard]] Light sample(const ColourPicture& picture, double u, double v, Wrap along_u = Wrap::repeat,
                           Wrap along_v = Wrap::repeat);
/// 0xAABBGGRR.
[[nodiscard]] std::uint32_t colour_of(const Light& light);

/// A file that a scan names: it must lie in the scan's folder or below, and `name` may have slashes of either kind. A
/// path from another machine ("C:/models/a.jpg", "../a.jpg") is looked for by its last part, beside the scan. Throws
/// Error{input} when there is none.
[[nodiscard]] std::unique_ptr<MappedFile> open_beside(const ScanFile& scan, std::string_view name);

}  // namespace sparsha::pipeline
