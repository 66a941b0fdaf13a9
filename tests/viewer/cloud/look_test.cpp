// What the picture shows is told whenever it changes, and only then.
#include <gtest/gtest.h>

#include <vector>

#include "tests/viewer/cloud/points.h"
#include "viewer/cloud/controller.h"

namespace sparsha::viewer::test {
namespace {

TEST(CloudLook, IsToldWithEachNewViewAndCropBox) {
  Workshop workshop{square(60, 1.0)};
  std::vector<SplatView> views;
  std::vector<bool> crops;
  Orienting orienting = workshop.orienting();
  orienting.look = [&](const SplatView& view, const ScanSetup& setup) {
    views.push_back(view);
    crops.push_back(setup.crop.has_value());
  };
  CloudController controller{orienting};
  double time_s = 0.0;
  const auto update = [&] { controller.update(time_s += 0.5, 600, 400, false); };
  for (int k = 0; k < 4; ++k) update();
  ASSERT_FALSE(views.empty());
  const std::size_t at_rest = views.size();
  EXPECT_TRUE(views.back() == controller.frame().view);
  update();
  EXPECT_EQ(views.size(), at_rest) << "nothing changed";
  controller.mouse_wheel(3.0);
  update();
  ASSERT_EQ(views.size(), at_rest + 1);
  EXPECT_GT(views.back().pixels_per_m, views.front().pixels_per_m);
  controller.set_crop(scene::CropConfig{{0, 0, 0}, {1, 1, 1}});
  update();
  EXPECT_EQ(views.size(), at_rest + 2);
  EXPECT_TRUE(crops.back());
  workshop.status.refining = true;
  EXPECT_FALSE(controller.rests()) << "more is to come";
}

}  // namespace
}  // namespace sparsha::viewer::test
