// The help page of an exhibit: few actions, large letters.
#pragma once

#include "viewer/frame.h"
#include "viewer/gui/brush.h"

namespace sparsha::viewer {

void draw_kiosk_help(const Brush& brush, const Frame& frame, int width, int height);

}  // namespace sparsha::viewer
