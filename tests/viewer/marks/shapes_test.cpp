// Parts of any shape as they are drawn on the stone.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/support/part_scenes.h"
#include "tests/support/test_folder.h"
#include "tests/viewer/relief_scene.h"
#include "tests/viewer/studio.h"

namespace sparsha::viewer::test {
namespace {

TEST(PartOutlines, AreDrawnAlongPolygonsAndLabelsAndNotAroundTheirBoxes) {
  const sparsha::test::TestFolder folder;
  const auto scene = sparsha::test::els(folder / "labels.png");
  std::vector<Image> images;
  std::vector<std::array<Eigen::Vector2d, 2>> drawn, not_drawn;  // from, to, pixels of the window
  for (const bool parts : {false, true}) {
    ViewSettings settings;
    settings.parts = parts;
    Studio studio(scene, settings);
    studio.settle();
    studio.shoot();
    images.push_back(studio.shoot());
    EXPECT_TRUE(studio.gl_errors().empty());
    if (!parts) continue;
    const Layout layout = layout_of(1280, 720, studio.controller().settings());
    const auto pixel = [&](double x_m, double y_m) {
      const auto at = studio.picture().detail_view().to_pixel(studio.picture().stage().to_world({x_m, y_m, 0.0}));
      EXPECT_TRUE(at);
      return Eigen::Vector2d(layout.detail.x + at->x(), layout.detail.y + at->y());
    };
    for (const double left : {0.06, 0.01}) {
      const auto corners = sparsha::test::el_m(0.03, {left, 0.01});
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const auto& a = corners[k];
        const auto& b = corners[(k + 1) % corners.size()];
        drawn.push_back({pixel(a[0], a[1]), pixel(b[0], b[1])});
      }
      // The right side of the box, above the foot.
      not_drawn.push_back({pixel(left + 0.03, 0.027), pixel(left + 0.03, 0.033)});
    }
  }
  const auto changed_near = [&](const Eigen::Vector2d& at) {
    constexpr int kNear = 4;
    for (int y = -kNear; y <= kNear; ++y)
      for (int x = -kNear; x <= kNear; ++x) {
        const int px = static_cast<int>(std::lround(at.x())) + x, py = static_cast<int>(std::lround(at.y())) + y;
        const Pixel a = images[0].at(px, py), b = images[1].at(px, py);
        if (std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b) > 60) return true;
      }
    return false;
  };
  constexpr int kPlaces = 20;
  for (int k = 0; k <= kPlaces; ++k) {
    for (const auto& [from, to] : drawn) EXPECT_TRUE(changed_near(from + (to - from) * k / kPlaces)) << k;
    for (const auto& [from, to] : not_drawn) EXPECT_FALSE(changed_near(from + (to - from) * k / kPlaces)) << k;
  }
}

}  // namespace
}  // namespace sparsha::viewer::test
