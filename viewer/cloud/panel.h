// The panel beside the raw cloud, and what is marked on the cloud: outline of the grid, crop box, axes.
#pragma once

#include "viewer/cloud/controller.h"
#include "viewer/frame.h"
#include "viewer/gui/brush.h"

namespace sparsha::viewer {

/// Size of the depth scan in words: "212 x 148 mm, 31 mm deep".
[[nodiscard]] std::string size_text(const DepthPreview& preview);

/// Names of textures, 0 where there is none.
struct CloudTextures {
  unsigned preview = 0;
  unsigned sides = 0;  ///< pictures of the sides, one beside the other
};
/// Inside an ImGui frame.
void draw_cloud_panel(const Brush& brush, CloudController& controller, const Layout& layout,
                      const CloudTextures& textures);
void draw_cloud_marks(const Brush& brush, const CloudController& controller, const Layout& layout);
void draw_cloud_help(const Brush& brush, int width, int height);

}  // namespace sparsha::viewer
