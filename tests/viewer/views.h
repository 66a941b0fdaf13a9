// Every view and mode of one scene of known shape, for reference pictures.
#pragma once

#include <string>
#include <vector>

#include "tests/viewer/studio.h"

namespace sparsha::viewer::test {

struct NamedView {
  std::string name;
  std::vector<Action> actions;
};

/// Each differs from the first by what its name says.
[[nodiscard]] std::vector<NamedView> all_views();
/// A carved plate with colour, texture, friction, a cross-check, a hole that was filled and one that was not.
[[nodiscard]] scene::ScenePointer exhibit();
/// Stone and hand of a view, 160 x 90 pixels, each the mean of 4 x 4: small differences of drivers vanish.
[[nodiscard]] Image draw_small(const scene::ScenePointer& scene, const NamedView& view);

/// Views of a sheet from left to right, row after row.
inline constexpr int kSheetColumns = 6, kSmallWidth = 160, kSmallHeight = 90;
/// The sheet of all views as it is kept in tests/viewer/reference.
[[nodiscard]] Image draw_sheet();
/// One view of a sheet.
[[nodiscard]] Image of_sheet(const Image& sheet, std::size_t view);

}  // namespace sparsha::viewer::test
