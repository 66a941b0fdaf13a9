// The pieces of the interface; each draws itself from a frame. Seen by gui/ only.
#pragma once

#include <vector>

#include "viewer/actions/actions.h"
#include "viewer/frame.h"
#include "viewer/gui/brush.h"

namespace sparsha::viewer {

class Picture;

/// A length across the middle of the detail view, in real units.
void draw_scale_bar(const Brush& brush, const Frame& frame, const Layout& layout, const Picture& picture);
/// Measures, pins and the parts' boxes over the detail view.
void draw_marks(const Brush& brush, const Frame& frame, const Layout& layout, const Picture& picture);
/// The window's frame and the hand on the overview.
void draw_overview_marks(const Brush& brush, const Frame& frame, const Layout& layout, const scene::Scene& scene);
/// Name, legend and what the hand feels.
void draw_panel(const Brush& brush, const Frame& frame, const Layout& layout, const Picture& picture);
/// Force, depth and speed of the last seconds.
void draw_strip(const Brush& brush, const Frame& frame, const Layout& layout);
/// What pictures and ticks cost, for the staff.
void draw_figures(const Brush& brush, const Frame& frame, const Layout& layout);
/// The bar; returns where its buttons are.
std::vector<Clickable> draw_buttons(const Brush& brush, const Frame& frame, const Layout& layout,
                                    const std::vector<Action>& buttons);
/// Announcements, in the half of the view where the hand is not; `picture` tells where that is, null: there is none.
void draw_toasts(const Brush& brush, const Frame& frame, const Layout& layout, const Picture* picture);
/// One page of the keys; returns what can be clicked, and how many pages there are.
std::vector<Clickable> draw_help(const Brush& brush, const Frame& frame, int width, int height, int& pages);
/// The question with its two buttons.
std::vector<Clickable> draw_question(const Brush& brush, const Frame& frame, const Layout& layout);

}  // namespace sparsha::viewer
