// Pictures of whole objects whose surface is known, judged ray by ray against exact distances.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <epoxy/gl.h>

#include <Eigen/Geometry>

#include "tests/support/scenes.h"
#include "tests/viewer/object/exhibit.h"
#include "tests/viewer/object/whole_objects.h"
#include "tests/viewer/studio.h"
#include "viewer/object/paint.h"
#include "viewer/object/view.h"

namespace sparsha::viewer::test {
namespace {

using sparsha::test::ClosedObject;
using sparsha::test::ObjectPtr;

/// Where a ray from outside meets the object first, by steps of the exact distance. Metres.
struct Truth {
  std::optional<double> at;
  double least = std::numeric_limits<double>::infinity();  ///< how near it has come, or how deep in the object
};
Truth cast(const ClosedObject& object, const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  Truth truth;
  double along = 0.0;
  for (int step = 0; step < 400 && along < 20.0; ++step) {
    const double distance = object.distance_m(from + along * direction);
    truth.least = std::min(truth.least, distance);
    if (distance < 1e-6 && !truth.at) truth.at = along;
    if (truth.at && along > *truth.at + 0.4) break;
    along += truth.at ? 0.005 : 0.8 * distance;
  }
  return truth;
}

Eigen::Vector3d normal_at(const ClosedObject& object, const Eigen::Vector3d& place) {
  constexpr double kStep = 1e-5;
  Eigen::Vector3d normal;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d by = kStep * Eigen::Vector3d::Unit(axis);
    normal[axis] = object.distance_m(place + by) - object.distance_m(place - by);
  }
  return normal.normalized();
}

Camera from_side(double turn_rad, double tilt_rad, double distance = 3.2) {
  Camera camera;
  camera.upright = true;
  camera.turn_rad = turn_rad;
  camera.tilt_rad = tilt_rad;
  camera.distance = distance;
  return camera;
}

constexpr double kQuarter = 0.5 * std::numbers::pi;
constexpr std::array<std::array<double, 2>, 8> kSides{
    {{0, 0}, {kQuarter, 0}, {2 * kQuarter, 0}, {-kQuarter, 0}, {0, -kQuarter}, {0, kQuarter}, {0.7, -0.6}, {3.9, 0.5}}};

struct Judged {
  int hit = 0;     ///< pixels of the object
  int holes = 0;   ///< of them, nothing is drawn though the ray goes through the object deeper than the outline's width
  int beyond = 0;  ///< drawn though the ray passes the object by more than the outline's width
  int deep = 0;    ///< of those that are no outline, more than `off_m` away from the surface
  double most = 0;  ///< spacings
};
/// `outline_m`: what a pixel and a vertex may be off at the outline.
Judged judge(const ClosedObject& object, const Exhibit& exhibit, double outline_m, double off_m) {
  Judged judged;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const Eigen::Vector3d from = exhibit.from_m(x, y), direction = exhibit.direction(x, y);
      const Truth truth = cast(object, from, direction);
      const std::optional<double> drawn = exhibit.away_m(x, y);
      if (!truth.at) {
        judged.beyond += drawn && truth.least > outline_m ? 1 : 0;
        continue;
      }
      ++judged.hit;
      const bool inside = truth.least < -outline_m;
      if (!drawn) {
        judged.holes += inside ? 1 : 0;
        continue;
      }
      const double off = std::abs(object.distance_m(from + *drawn * direction));
      // Another layer may show at an outline within the object.
      if (inside && off > off_m) ++judged.deep;
      if (inside) judged.most = std::max(judged.most, off / exhibit.spacing_m());
    }
  return judged;
}

struct Shape {
  std::string name;
  ObjectPtr object;
};
std::vector<Shape> smooth_shapes() {
  return {{"torus", sparsha::test::make_torus()}, {"two spheres", sparsha::test::make_two_spheres()}};
}

TEST(WholePicture, IsTheObjectFromEverySideAtEveryLevelOfDetail) {
  const gl::OffscreenContext context(true);
  std::vector<std::string> errors;
  gl::watch_errors(errors);
  for (const Shape& shape : smooth_shapes()) {
    Exhibit exhibit(charts_of(*shape.object, 20'000, 0.1));
    for (std::size_t k = 0; k < kSides.size(); ++k)
      for (const double node_pixels : {0.5, 7.0}) {
        if (node_pixels > 1.0 && k % 3 != 0) continue;
        const auto& side = kSides[k];
        exhibit.draw(from_side(side[0], side[1]), node_pixels);
        // A vertex of a coarse level is the mean of a cube's.
        const double coarse_m = node_pixels > 1.0 ? node_pixels * exhibit.pixel_m() : 0.0;
        const double outline_m = exhibit.pixel_m() + 0.5 * exhibit.spacing_m() + 0.3 * coarse_m;
        const Judged judged = judge(*shape.object, exhibit, outline_m, 0.5 * exhibit.spacing_m() + 0.3 * coarse_m);
        const std::string where = shape.name + " turned " + std::to_string(side[0]) + " tilted " +
                                  std::to_string(side[1]) + " detail " + std::to_string(node_pixels);
        EXPECT_GT(judged.hit, 5'000) << where;
        EXPECT_EQ(judged.holes, 0) << where;
        EXPECT_EQ(judged.beyond, 0) << where;
        EXPECT_LE(judged.deep, judged.hit / 1000) << where << ", most " << judged.most;
      }
  }
  EXPECT_TRUE(errors.empty()) << errors.front();
}

// The sharp edges of a box, where sheets do not overlap, and the two faces of a plate.
TEST(WholePicture, HasNoGapAlongSharpEdges) {
  const gl::OffscreenContext context;
  const Eigen::Matrix3d turned = sparsha::test::turned(25.0, 35.0);
  for (const Eigen::Vector3d& half : {Eigen::Vector3d(1.0, 1.0, 1.0), Eigen::Vector3d(1.0, 0.8, 0.06)})
    for (const Eigen::Matrix3d& view : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), turned}) {
      const ObjectPtr box = sparsha::test::make_box(half, view);
      Exhibit exhibit(charts_of(*box, 20'000, 0.1));
      int hit = 0, holes = 0, beyond = 0, deep = 0;
      for (std::size_t k = 0; k < kSides.size(); k += 2) {
        const auto& side = kSides[k];
        exhibit.draw(from_side(side[0], side[1]), 0.5);
        const Judged judged =
            judge(*box, exhibit, exhibit.pixel_m() + 1.5 * exhibit.spacing_m(), 1.5 * exhibit.spacing_m());
        hit += judged.hit;
        holes += judged.holes;
        beyond += judged.beyond;
        deep += judged.deep;
      }
      EXPECT_GT(hit, 20'000);
      EXPECT_LE(holes, hit / 10'000) << half.transpose();
      EXPECT_LE(beyond, hit / 5'000) << half.transpose();
      EXPECT_LE(deep, hit / 2'000) << half.transpose();
    }
}

// Neighbouring pixels of nearly the same normal have nearly the same brightness, whichever sheets they are of.
TEST(WholePicture, ShowsNoSeams) {
  const gl::OffscreenContext context;
  const ObjectPtr torus = sparsha::test::make_torus();
  Exhibit exhibit(charts_of(*torus, 100'000, 0.0));
  for (const Look look : {Look::stone, Look::sky, Look::clay}) {
    int pairs = 0;
    double most = 0.0;
    for (const auto& side : kSides) {
      exhibit.draw(from_side(side[0], side[1]), 0.5, look);
      for (int y = 1; y < kSide; ++y)
        for (int x = 1; x < kSide; ++x) {
          const auto here = exhibit.away_m(x, y), left = exhibit.away_m(x - 1, y);
          if (!here || !left) continue;
          const Eigen::Vector3d a = normal_at(*torus, exhibit.from_m(x, y) + *here * exhibit.direction(x, y));
          const Eigen::Vector3d b = normal_at(*torus, exhibit.from_m(x - 1, y) + *left * exhibit.direction(x - 1, y));
          const bool steady = std::abs(*here - *left) < 3.0 * exhibit.pixel_m() && a.dot(b) > std::cos(0.03) &&
                              a.dot(exhibit.direction(x, y)) < -0.3;
          if (!steady) continue;
          ++pairs;
          most = std::max(most, std::abs(exhibit.brightness(x, y) - exhibit.brightness(x - 1, y)));
        }
    }
    EXPECT_GT(pairs, 50'000);
    EXPECT_LT(most, 10.0) << "look " << static_cast<int>(look);
  }
}

TEST(WholePicture, FollowsTheTurnOfTheObjectInTheHand) {
  const gl::OffscreenContext context;
  const ObjectPtr shape = sparsha::test::make_two_spheres();
  Exhibit exhibit(charts_of(*shape, 20'000, 0.1));
  exhibit.stage().turn = Eigen::AngleAxisd(2.1, Eigen::Vector3d(0.3, 1.0, -0.4).normalized()).toRotationMatrix();
  exhibit.draw(from_side(0.0, 0.0), 0.5);
  const Judged judged =
      judge(*shape, exhibit, exhibit.pixel_m() + 0.5 * exhibit.spacing_m(), 0.5 * exhibit.spacing_m());
  EXPECT_GT(judged.hit, 5'000);
  EXPECT_EQ(judged.holes, 0);
  EXPECT_EQ(judged.beyond, 0);
}

TEST(WholePicture, CostsByThePictureAndNotByTheScene) {
  const gl::OffscreenContext context;
  const ObjectPtr torus = sparsha::test::make_torus();
  std::array<std::size_t, 2> triangles{};
  std::array<std::size_t, 2> close{};
  for (std::size_t k = 0; k < 2; ++k) {
    Exhibit exhibit(charts_of(*torus, k == 0 ? 20'000 : 160'000, 0.1));
    exhibit.draw(from_side(0.0, 0.0), 4.0);
    triangles[k] = exhibit.view().drawn_triangles();
    // A few spacings before the surface: only blocks that are seen.
    Camera camera = from_side(0.0, 0.0, 0.2);
    const ObjectMesh& mesh = exhibit.view().finest();
    std::size_t nearest = 0;
    for (std::size_t v = 0; v < mesh.place.size(); ++v)
      if (mesh.place[v].z() > mesh.place[nearest].z()) nearest = v;
    camera.target = exhibit.stage().to_world(exhibit.view().place_m(nearest));
    exhibit.draw(camera, 1.0);
    close[k] = exhibit.view().drawn_triangles();
  }
  EXPECT_GT(triangles[0], 1'000U);
  EXPECT_LT(static_cast<double>(triangles[1]), 3.0 * static_cast<double>(triangles[0]))
      << "eight times the points, the same picture";
  EXPECT_LT(close[0], 30'000U);
  EXPECT_LT(close[1], 100'000U);
}

bool is_ball(const Pixel& p) { return p.b > p.r + 40; }

// The hand before and behind the object, from before and from behind.
TEST(WholePicture, TheObjectHidesTheHandBehindIt) {
  const ObjectPtr torus = sparsha::test::make_torus(Eigen::Matrix3d::Identity());
  Studio studio(whole_scene(torus, charts_of(*torus, 20'000, 0.1)));
  haptics::State state;
  state.tick = 1;
  state.scale = 0.03;
  state.workspace_m = 0.09;
  const auto balls = [&](double x, double y, double z) {
    state.hip_m = state.proxy_m = {x, y, z};
    const Image image = studio.shoot_bare(state);
    return image.find(layout_of(1280, 720, {}).detail, is_ball).count;
  };
  Eigen::Vector3d ring = Eigen::Vector3d::Zero();  // a place within the tube, from whichever axis it is about
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)})
    if (torus->distance_m(p) < -0.3 && std::abs(p.z()) < 0.5) ring = p;
  ASSERT_GT(ring.norm(), 0.5);
  const int before = balls(ring.x(), ring.y(), 0.7), behind = balls(ring.x(), ring.y(), -0.7);
  EXPECT_GT(before, 60);
  EXPECT_LT(behind, before / 4);
  // Half round, so that what was behind is before.
  for (int k = 0; k < 39; ++k) studio.act(Action::turn_right);  // 0.08 rad each
  studio.settle(state);
  const int now_behind = balls(ring.x(), ring.y(), 0.7), now_before = balls(ring.x(), ring.y(), -0.7);
  EXPECT_GT(now_before, 60);
  EXPECT_LT(now_behind, now_before / 4);
  // The object is turned half round in the hand instead.
  studio.act(Action::camera_reset);
  studio.settle(state);
  state.turn = {0.0, 1.0, 0.0, 0.0};
  const int turned = balls(ring.x(), ring.y(), -0.7);
  EXPECT_GT(turned, 60);
  EXPECT_TRUE(studio.gl_errors().empty()) << studio.gl_errors().front();
}

TEST(WholePicture, HasColoursOfItsOwnAndStereo) {
  const ObjectPtr torus = sparsha::test::make_torus();
  ViewSettings settings;
  settings.stereo.mode = StereoMode::anaglyph;
  Studio studio(whole_scene(torus, charts_of(*torus, 20'000, 0.1)), settings);
  const Image stereo = studio.shoot_bare();
  studio.controller().frame().settings.stereo.mode = StereoMode::off;
  const Image plain = studio.shoot_bare();
  int different = 0;
  for (int y = 0; y < 660; y += 2)
    for (int x = 0; x < 900; x += 2) different += std::abs(stereo.at(x, y).r - plain.at(x, y).r) > 30 ? 1 : 0;
  EXPECT_GT(different, 300);
  for (const ColourMode mode : {ColourMode::height, ColourMode::curvature, ColourMode::sky_view, ColourMode::slope}) {
    studio.controller().frame().settings.colour = mode;
    const Image painted = studio.shoot_bare();
    different = 0;
    for (int y = 0; y < 660; y += 2)
      for (int x = 0; x < 900; x += 2) different += std::abs(painted.at(x, y).b - plain.at(x, y).b) > 20 ? 1 : 0;
    EXPECT_GT(different, 2'000) << static_cast<int>(mode);
  }
  EXPECT_NEAR(studio.picture().legend().high, 90.0, 90.0);
  EXPECT_TRUE(studio.gl_errors().empty()) << studio.gl_errors().front();
}

// Charts that hold no cell leave the front view in the picture.
TEST(WholePicture, WithoutCellsIsTheFrontView) {
  scene::Charts charts;
  charts.spacing_m = 0.01;
  const ObjectPtr torus = sparsha::test::make_torus();
  Studio studio(whole_scene(torus, charts));
  EXPECT_EQ(studio.picture().object(), nullptr);
  EXPECT_GT(studio.shoot_bare().mean_luminance({300, 200, 300, 300}), 1.0);
}

}  // namespace
}  // namespace sparsha::viewer::test
