// A human face in a picture, upright or upside down: brow, eyes, nose, mouth and chin of a made one.
#pragma once

#include <array>

#include "pipeline/orient/side_picture.h"

namespace sparsha::pipeline {

/// How much the relief about the upright line x = `axis` (pixels) is like a face, of the place and size where it is
/// most: the normalised correlation with the relief of a made face, -1 to 1. First of upright faces, then of those
/// upside down. Of heads, masks and busts 0.64 to 0.75, of what has no face 0.6 at most: chance correlates, too.
[[nodiscard]] std::array<double, 2> face_likeness(const SidePicture& picture, double axis);

}  // namespace sparsha::pipeline
