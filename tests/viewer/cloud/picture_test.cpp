// Pictures of the raw cloud without a display.
#include <gtest/gtest.h>
#include <imgui.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/png/png.h"
#include "tests/viewer/cloud/points.h"
#include "tests/viewer/relief_scene.h"
#include "tests/viewer/studio.h"
#include "viewer/cloud/mode.h"

namespace sparsha::viewer::test {
namespace {

/// A plate whose left half is red and whose right half is blue, as seen from its front (+z).
PointView two_halves(int per_side = 200) {
  PointView view = square(per_side, 1.0);
  for (const Eigen::Vector3f& p : view.points) view.rgba.push_back(p.x() < 0.0F ? 0xFF2020E0U : 0xFFE02020U);
  return view;
}

struct CloudStudio {
  std::vector<std::string> errors;
  gl::OffscreenContext context{true};
  Workshop workshop;
  ViewSettings settings;
  std::vector<std::string> spoken;
  std::unique_ptr<Gui> gui;
  std::unique_ptr<CloudMode> mode;
  double time_s = 0.0;

  explicit CloudStudio(PointView view) : workshop(std::move(view)) {
    gl::watch_errors(errors);
    gui = std::make_unique<Gui>();
    mode = std::make_unique<CloudMode>(workshop.orienting(),
                                       [this](const std::string& words) { spoken.push_back(words); });
  }
  ~CloudStudio() {
    mode.reset();
    gui.reset();
  }
  Image shoot(int width = 1280, int height = 720, bool finished = true) {
    const gl::Target target(width, height, false);
    mode->controller().frame().finished = finished;
    for (int k = 0; k < 2; ++k) mode->draw(*gui, settings, target.framebuffer(), width, height, time_s += 0.5, true);
    static_cast<void>(mode->take_wish(settings));
    return {width, height, target.read_pixels()};
  }
  [[nodiscard]] Rect detail(int width = 1280, int height = 720) const {
    return layout_of(width, height, settings).detail;
  }
};

// The outline of the grid is orange.
bool is_red(const Pixel& p) { return p.r > 100 && p.r > 3 * p.g; }
bool is_blue(const Pixel& p) { return p.b > 100 && p.b > 3 * p.r; }

TEST(CloudPicture, ColoursAreWhereThePointsAreAndChangeSidesFromBehind) {
  CloudStudio studio(two_halves());
  const Rect detail = studio.detail();
  const double middle = 0.5 * detail.width;
  Image image = studio.shoot();
  // The plate fills 82 % of the rectangle's height.
  const double half_area = 0.5 * (0.82 * detail.height) * (0.82 * detail.height);
  Image::Spot red = image.find(detail, is_red), blue = image.find(detail, is_blue);
  EXPECT_NEAR(red.count, half_area, 0.06 * half_area);
  EXPECT_NEAR(blue.count, half_area, 0.06 * half_area);
  EXPECT_LT(red.right, middle + 3.0);
  EXPECT_GT(blue.left, middle - 3.0);
  studio.mode->press({'2'});
  image = studio.shoot();
  red = image.find(detail, is_red);
  EXPECT_GT(red.left, middle - 3.0);
  EXPECT_NEAR(red.count, half_area, 0.06 * half_area);
  EXPECT_TRUE(studio.errors.empty()) << studio.errors.front();
}

TEST(CloudPicture, PartOfThePointsAtOnceBecomesAllOfThemAtRest) {
  PointView many;
  for (int k = 0; k < 30; ++k) {
    const PointView layer = square(200, 1.0);
    for (const Eigen::Vector3f& p : layer.points)
      many.points.push_back(p + Eigen::Vector3f(0, 0, 0.001F * static_cast<float>(k)));
  }
  CloudStudio studio(std::move(many));
  const Image whole = studio.shoot();
  EXPECT_TRUE(studio.mode->picture().complete());
  studio.mode->press({key::kLeft});
  studio.mode->press({key::kRight});
  for (int k = 0; k < 400 && (k < 2 || !studio.mode->picture().complete()); ++k) studio.shoot(1280, 720, false);
  EXPECT_TRUE(studio.mode->picture().complete());
  const Image again = studio.shoot(1280, 720, false);
  std::size_t different = 0;
  const Rect detail = studio.detail();
  for (int y = 0; y < detail.height - 40; ++y)
    for (int x = 0; x < detail.width; ++x) different += std::abs(whole.at(x, y).r - again.at(x, y).r) > 8 ? 1 : 0;
  // The orientation came back by two rotations, whose rounding may move a point across a pixel's border.
  EXPECT_LT(different, static_cast<std::size_t>(detail.width * detail.height / 200));
}

TEST(CloudPicture, DetailIsDrawnWithTheCloudAndThePictureStaysUntilTheNextIsWhole) {
  const PointView all = two_halves();
  PointView red, blue;
  for (std::size_t n = 0; n < all.points.size(); ++n) {
    PointView& half = all.points[n].x() < 0.0F || n % 7 == 0 ? red : blue;
    half.points.push_back(all.points[n]);
    half.rgba.push_back(all.rgba[n]);
  }
  int expected = 0;
  double spacing_m = 0.0;
  {
    CloudStudio whole(all);
    expected = whole.shoot().find(whole.detail(), is_blue).count;
    spacing_m = whole.workshop.points->spacing_m;
  }
  CloudStudio studio(std::move(red));
  const Rect rect = studio.detail();
  const int before = studio.shoot().find(rect, is_blue).count;
  auto part = std::make_shared<PointView>(std::move(blue));
  part->origin_m = studio.workshop.points->origin_m;
  arrange(*part);
  const auto detail = std::make_shared<PointDetail>();
  detail->parts.push_back(part);
  detail->points = part->points.size();
  detail->spacing_m = spacing_m;
  studio.workshop.status.detail = detail;
  EXPECT_FALSE(studio.mode->rests()) << "there is news";
  for (int k = 0; k < 400 && (k < 2 || !studio.mode->picture().complete()); ++k) {
    const int blue_now = studio.shoot(1280, 720, false).find(rect, is_blue).count;
    EXPECT_GE(blue_now, before) << "nothing vanishes meanwhile";
  }
  EXPECT_TRUE(studio.mode->picture().complete());
  const int after = studio.shoot(1280, 720, false).find(rect, is_blue).count;
  EXPECT_NEAR(after, expected, 0.02 * expected);
  EXPECT_GT(after, before + 1000);
  EXPECT_TRUE(studio.errors.empty());
}

TEST(CloudPicture, AtRestNothingIsDrawnUntilSomethingChanges) {
  CloudStudio studio(two_halves());
  const gl::Target target(640, 400, false);
  const auto draw = [&](double seconds) {
    constexpr double kStep_s = 0.1;
    for (double t = 0.0; t < seconds; t += kStep_s) {
      studio.mode->controller().frame().finished = false;
      studio.mode->draw(*studio.gui, studio.settings, target.framebuffer(), 640, 400, studio.time_s += kStep_s, true);
    }
    return studio.mode->rests();
  };
  EXPECT_FALSE(studio.mode->rests()) << "nothing has been drawn yet";
  const double toast_s = 12.0;
  EXPECT_TRUE(draw(toast_s));
  studio.mode->press({key::kLeft});
  EXPECT_FALSE(studio.mode->rests());
  EXPECT_FALSE(draw(0.1)) << "the preview of all points waits for rest";
  EXPECT_TRUE(draw(toast_s));
  studio.workshop.status.note = "found";
  ++studio.workshop.status.notes;
  EXPECT_FALSE(studio.mode->rests());
  EXPECT_FALSE(draw(0.1)) << "words are shown";
  EXPECT_TRUE(draw(toast_s));
  studio.workshop.status.busy = true;
  EXPECT_FALSE(studio.mode->rests());
  EXPECT_FALSE(draw(1.0)) << "progress is shown";
}

TEST(CloudPicture, EveryColourAndSizeIsDrawnWithoutErrors) {
  PointView view = two_halves(60);
  for (std::size_t n = 0; n < view.points.size(); ++n) {
    view.intensity.push_back(static_cast<float>(n % 100));
    view.station.push_back(static_cast<std::uint8_t>(n % 3));
  }
  CloudStudio studio(std::move(view));
  studio.shoot();
  studio.mode->press({'K'});
  for (int colour = 0; colour < 4; ++colour) {
    for (const auto& [width, height] : {std::pair{640, 400}, std::pair{1280, 720}, std::pair{1920, 1080}})
      studio.shoot(width, height);
    studio.mode->press({'C'});
  }
  studio.mode->press({key::kF1});
  studio.mode->press({'X'});
  studio.mode->press({'G'});
  studio.workshop.status.busy = true;
  studio.workshop.status.stage = "Depth scan";
  studio.workshop.status.note = "Not there";
  studio.workshop.status.problem = true;
  studio.workshop.status.notes = 1;
  studio.shoot();
  EXPECT_TRUE(studio.settings.high_contrast);
  EXPECT_TRUE(studio.settings.large_type);
  EXPECT_TRUE(studio.errors.empty()) << studio.errors.front();
  EXPECT_EQ(std::ranges::count(studio.spoken, "Not there"), 0) << "the program announces it, once";
}

TEST(CloudPicture, AClickOnOneOfSixPicturesTurnsThatSideToTheViewer) {
  CloudStudio studio(two_halves(40));
  const auto pictures = std::make_shared<SidePictures>();
  pictures->side_px = 40;
  for (int k = 0; k < kFaces; ++k) {
    const Eigen::Matrix4d turn = seen_from(static_cast<Face>(k), false, Eigen::Matrix4d::Identity());
    pictures->sides.push_back({name_of(static_cast<Face>(k)), turn.row(2).head<3>(), turn.row(1).head<3>(),
                               std::vector<std::uint8_t>(40U * 40U, static_cast<std::uint8_t>(100 + 20 * k))});
  }
  studio.workshop.status.sides = pictures;
  const Image image = studio.shoot();
  const Rect panel = layout_of(1280, 720, studio.settings).panel;
  for (const int chosen : {4, 1, 5, 0, 2, 3}) {
    const auto grey = static_cast<std::uint8_t>(100 + 20 * chosen);
    const Image::Spot spot =
        image.find(panel, [&](const Pixel& p) { return p.r == grey && p.g == grey && p.b == grey; });
    ASSERT_GT(spot.count, 1000) << "the picture is in the panel";
    ImGuiIO& io = ImGui::GetIO();
    // A press and a release are two pictures.
    io.MousePos = {static_cast<float>(spot.x), static_cast<float>(spot.y)};
    studio.shoot();
    io.MouseDown[0] = true;
    studio.shoot();
    io.MouseDown[0] = false;
    studio.shoot();
    EXPECT_TRUE(studio.mode->controller().frame().setup.scan_to_grid.isApprox(
        seen_from(static_cast<Face>(chosen), false, Eigen::Matrix4d::Identity()), 1e-9))
        << chosen;
  }
  EXPECT_TRUE(studio.errors.empty()) << studio.errors.front();
}

TEST(CloudPicture, NothingIsLeftInTheDriver) {
  const int before = gl::living_objects();
  {
    CloudStudio studio(two_halves(40));
    for (int k = 0; k < 5; ++k) {
      studio.shoot(640 + 10 * k, 400);
      studio.mode->press({key::kRight});
    }
    EXPECT_GT(gl::living_objects(), before);
  }
  EXPECT_EQ(gl::living_objects(), before);
}

// tools/orienting-pictures.sh makes the picture of docs/use/orienting.md with it.
TEST(CloudPicture, TheDocumentationsPictureIsDrawn) {
  const char* const folder = std::getenv("SPARSHA_PICTURES");
  if (folder == nullptr) GTEST_SKIP() << "SPARSHA_PICTURES names no folder";
  PointView view;
  view.title = "lotus.ply";
  constexpr int kSide = 900;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const double x = 0.4 * i / kSide, y = 0.4 * j / kSide;
      const double shadow = std::hypot(x - 0.31, y - 0.09);  // a pillar stood before this place
      if (shadow < 0.035) continue;
      view.points.emplace_back(Eigen::Vector3d(x, y, lotus(x, y)).cast<float>());
    }
  view.total = view.points.size();
  CloudStudio studio(std::move(view));
  studio.shoot();
  studio.mode->press({'K'});
  for (int k = 0; k < 5; ++k) studio.mode->press({key::kLeft});
  for (int k = 0; k < 4; ++k) studio.mode->press({key::kUp});
  const Image image = studio.shoot();
  std::vector<std::uint8_t> rgb;
  for (std::size_t n = 0; n < image.rgba.size(); ++n)
    if (n % 4 != 3) rgb.push_back(image.rgba[n]);
  PngFormat format;
  format.width = image.width;
  format.height = image.height;
  write_png(std::filesystem::path(folder) / "orienting.png", format, rgb);
}

}  // namespace
}  // namespace sparsha::viewer::test
