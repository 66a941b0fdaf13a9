// The pieces of the interface; each draws itself from a frame. Seen by gui/ only.
#pragma once

#include <vector>

#include "viewer/actions.h"
#include "viewer/frame.h"
#include "viewer/gui/brush.h"

namespace sparsha::viewer {

class Picture;

/// A length across the middle of the detail view, in real units.
void draw_scale_bar(const Brush& brush, const Frame& frame, const Layout& layout, const Picture& picture);
/// The window's frame and the hand on the overview.
void draw_overview_marks(const Brush& brush, const Frame& frame, const Layout& layout, const pipeline::Scene& scene);
/// Name, legend and what the hand feels.
void draw_panel(const Brush& brush, const Frame& frame, const Layout& layout, const Picture& picture);
/// The bar; returns what was clicked.
std::vector<Action> draw_buttons(const Brush& brush, const Frame& frame, const Layout& layout,
                                 const std::vector<Action>& buttons);
void draw_toasts(const Brush& brush, const Frame& frame, const Layout& layout);
void draw_help(const Brush& brush, const Frame& frame, int width, int height);
void draw_question(const Brush& brush, const Layout& layout);

}  // namespace sparsha::viewer
