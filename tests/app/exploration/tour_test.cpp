#include "app/exploration/tour.h"

#include <gtest/gtest.h>

#include "tests/support/scenes.h"

namespace sparsha::app {
namespace {

using Kind = haptics::TourStop::Kind;

scene::AudioRegionConfig note(const std::array<double, 4>& box_m) {
  scene::AudioRegionConfig region;
  region.box_m = box_m;
  region.sound = scene::ModalConfig{};
  return region;
}

/// 0.2 m wide, its corner at (2, -3); level 0 is the overview of a workspace of 0.1 m, so the scale is one half.
scene::ScenePointer scene(const test::EditDescription& edit) {
  return test::scene_of([](double, double) { return 0.0; }, {101, 101, 0.002, 1, {2.0, -3.0, 0.0}},
                        [&](scene::SceneDescription& description) {
                          description.config.levels.window = 101;
                          edit(description);
                        });
}

TEST(Tour, StrikesAClipAndThreeNotesAndStrokesTheLargestPartWithOneZoom) {
  const auto tour = tour_of(scene([](scene::SceneDescription& d) {
                              d.config.audio.emplace();
                              for (int k = 0; k < 5; ++k)
                                d.config.audio->regions.push_back(note({2.0 + 0.02 * k, -3.0, 2.02 + 0.02 * k, -2.98}));
                              scene::AudioRegionConfig bell = note({2.09, -2.91, 2.11, -2.89});
                              bell.sound = std::filesystem::path("bell.wav");
                              d.config.audio->regions.push_back(bell);
                              d.config.parts.push_back({"small", "", {2.0, -3.0, 2.01, -2.99}});
                              d.config.parts.push_back({"large", "", {2.05, -2.95, 2.15, -2.85}});
                            })->description());
  ASSERT_EQ(tour.size(), 5U);
  EXPECT_LT(tour[0].at_m.norm(), 1e-12) << "the bell hangs in the middle";
  for (std::size_t k = 1; k < 4; ++k) {
    EXPECT_EQ(tour[k].kind, Kind::strike);
    EXPECT_NEAR(tour[k].at_m.x(), 0.5 * (-0.09 + 0.02 * static_cast<double>(k - 1)), 1e-12);
    EXPECT_NEAR(tour[k].at_m.y(), -0.045, 1e-12);
    EXPECT_EQ(tour[k].buttons, 0U);
  }
  EXPECT_EQ(tour[4].kind, Kind::stroke);
  EXPECT_NEAR(tour[4].at_m.x(), -0.02, 1e-12);
  EXPECT_NEAR(tour[4].to_m.x(), 0.02, 1e-12);
  EXPECT_EQ(tour[4].buttons, 1U);
}

TEST(Tour, StrokesAPolygonWhereItIsInside) {
  const auto tour = tour_of(scene([](scene::SceneDescription& d) {
                              // Its box's middle lies in its notch; the box of the other part is smaller.
                              scene::PartConfig notched;
                              notched.polygon_m = {{2.02, -2.98}, {2.18, -2.98}, {2.18, -2.82}, {2.14, -2.82},
                                                   {2.14, -2.96}, {2.06, -2.96}, {2.06, -2.82}, {2.02, -2.82}};
                              d.config.parts = {{"small", "", {2.0, -3.0, 2.01, -2.99}}, notched};
                            })->description());
  ASSERT_EQ(tour.size(), 1U);
  EXPECT_EQ(tour[0].kind, Kind::stroke);
  EXPECT_LT(tour[0].at_m.x(), tour[0].to_m.x());
  EXPECT_EQ(tour[0].at_m.y(), tour[0].to_m.y());
  for (int k = 0; k <= 10; ++k) {
    // Back to the scene: half its size, about its middle.
    const Eigen::Vector2d at = tour[0].at_m + (tour[0].to_m - tour[0].at_m) * k / 10.0;
    const double x_m = 2.1 + 2.0 * at.x(), y_m = -2.9 + 2.0 * at.y();
    const bool left = x_m > 2.02 && x_m<2.06, right = x_m> 2.14 && x_m < 2.18;
    EXPECT_TRUE((y_m > -2.98 && y_m < -2.96) || left || right) << x_m << ' ' << y_m;
  }
}

TEST(Tour, StaysInTheWorkspaceWhateverIsWrittenAndIsEmptyWhereNothingIs) {
  EXPECT_TRUE(tour_of(scene([](scene::SceneDescription&) {})->description()).empty());
  const auto tour = tour_of(scene([](scene::SceneDescription& d) {
                              d.config.audio.emplace();
                              d.config.audio->regions.push_back(note({1e6, 1e6, 2e6, 2e6}));
                              d.config.parts.push_back({"elsewhere", "", {-1e9, -1e9, 1e9, 1e9}});
                            })->description());
  ASSERT_EQ(tour.size(), 2U);
  for (const auto& stop : tour) {
    EXPECT_LE(stop.at_m.cwiseAbs().maxCoeff(), 0.05);
    EXPECT_LE(stop.to_m.cwiseAbs().maxCoeff(), 0.05);
  }
}

}  // namespace
}  // namespace sparsha::app
