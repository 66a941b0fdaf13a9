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
#include "tests/viewer/object/whole_objects.h"
#include "tests/viewer/studio.h"
#include "viewer/object/paint.h"
#include "viewer/object/view.h"

namespace sparsha::viewer::test {
namespace {

using sparsha::test::ClosedObject;
using sparsha::test::ObjectPtr;

constexpr int kSide = 300;  // pixels of a judged picture

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

/// One object on the graphics card, drawn from any side.
class Exhibit {
 public:
  explicit Exhibit(const scene::Charts& charts) : target_(kSide, kSide, true, gl::Filter::nearest) {
    ThreadPool pool(2);
    const ObjectBox bounds = bounds_of(charts);
    stage_.anchor_m = 0.5 * (bounds.low_m + bounds.high_m);
    stage_.unit_m = (bounds.high_m - bounds.low_m).maxCoeff();
    view_.emplace(make_object_meshes(charts, pool), charts.origin_m, charts.spacing_m);
    spacing_m_ = charts.spacing_m;
  }

  void draw(const Camera& camera, double node_pixels, Look look = Look::sky) {
    seen_ = make_view(camera, kSide, kSide);
    glBindFramebuffer(GL_FRAMEBUFFER, target_.framebuffer());
    glViewport(0, 0, kSide, kSide);
    glDisable(GL_BLEND);
    glClearColor(0.0F, 0.0F, 1.0F, 1.0F);
    glDepthMask(GL_TRUE);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    ReliefStyle style;
    style.look = look;
    style.node_pixels = node_pixels;
    view_->draw(seen_, stage_, style, {});
    depth_.resize(kSide * kSide);
    glReadPixels(0, 0, kSide, kSide, GL_DEPTH_COMPONENT, GL_FLOAT, depth_.data());
    rgba_ = target_.read_pixels();
    glDisable(GL_DEPTH_TEST);
  }

  /// Of the ray through the pixel's middle, from its origin, metres; nothing where nothing is drawn.
  [[nodiscard]] std::optional<double> away_m(int x, int y) const {
    const float depth = depth_[static_cast<std::size_t>((kSide - 1 - y) * kSide + x)];
    if (depth >= 1.0F) return std::nullopt;
    const Eigen::Vector4d clip(2.0 * (x + 0.5) / kSide - 1.0, 1.0 - 2.0 * (y + 0.5) / kSide,
                               2.0 * static_cast<double>(depth) - 1.0, 1.0);
    const Eigen::Vector4d world = seen_.inverse * clip;
    return (stage_.to_grid_m(world.head<3>() / world.w()) - from_m(x, y)).norm();
  }
  [[nodiscard]] View::Ray ray(int x, int y) const { return seen_.ray(x + 0.5, y + 0.5); }
  [[nodiscard]] Eigen::Vector3d from_m(int x, int y) const { return stage_.to_grid_m(ray(x, y).origin); }
  [[nodiscard]] Eigen::Vector3d direction(int x, int y) const { return stage_.turn.transpose() * ray(x, y).direction; }
  [[nodiscard]] double brightness(int x, int y) const {
    const std::size_t k = 4 * static_cast<std::size_t>(y * kSide + x);
    return 0.2126 * rgba_[k] + 0.7152 * rgba_[k + 1] + 0.0722 * rgba_[k + 2];
  }
  [[nodiscard]] double pixel_m() const { return stage_.unit_m / seen_.pixels_per_unit(seen_.focus); }
  [[nodiscard]] double spacing_m() const { return spacing_m_; }
  [[nodiscard]] Stage& stage() { return stage_; }
  [[nodiscard]] ObjectView& view() { return *view_; }

 private:
  gl::Target target_;
  Stage stage_;
  std::optional<ObjectView> view_;
  double spacing_m_ = 0.0;
  View seen_;
  std::vector<float> depth_;
  std::vector<unsigned char> rgba_;
};

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

/// With friction, and a front view without any height.
scene::ScenePointer flat_scene(const scene::Charts& charts) {
  return sparsha::test::scene_of([](double, double) { return 0.0; }, sparsha::test::SceneOptions{},
                                 [&](scene::SceneDescription& description) {
                                   description.charts = std::make_shared<const scene::Charts>(charts);
                                   description.config.friction.emplace();
                                   description.friction_c_m = 0.005;
                                 });
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

/// Texture and friction of every vertex, on all sides: those of the nodes of the charts that were set so.
TEST(WholePicture, TextureAndFrictionAreShownOnAllSides) {
  const ObjectPtr torus = sparsha::test::make_torus();
  scene::Charts charts = charts_of(*torus, 5'000, 0.0);
  for (scene::Sheet& sheet : charts.sheets) {
    sheet.texture_m.assign(sheet.count(), std::numeric_limits<float>::quiet_NaN());
    sheet.curvature_per_m = sheet.texture_m;
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i) {
        const std::size_t node = sheet.index(i, j);
        if (!sheet.measured(node)) continue;
        const bool rough = charts.place_m(sheet, i, j).x() + charts.origin_m.x() > 0.0;
        sheet.texture_m[node] = rough ? 0.001F : -0.001F;
        sheet.curvature_per_m[node] = rough ? 100.0F : 0.0F;
      }
  }
  const gl::OffscreenContext context;
  Exhibit exhibit(charts);
  const scene::ScenePointer scene = flat_scene(charts);
  const Paint nothing;
  const ReliefData front;
  for (const ColourMode mode : {ColourMode::texture, ColourMode::friction}) {
    const Paint paint = paint_object(exhibit.view(), {scene->description(), 0.1, front, nothing}, mode);
    const std::size_t count = exhibit.view().finest().place.size();
    ASSERT_EQ(paint.rgba.size(), 4 * count);
    std::array<std::size_t, 2> behind{};  // smooth, rough
    for (std::size_t v = 0; v < count; ++v) {
      ASSERT_EQ(paint.rgba[4 * v + 3], 255) << "a vertex without colour";
      const double x = exhibit.view().place_m(v).x();
      if (std::abs(x) < 4.0 * exhibit.spacing_m()) continue;
      const double value = mode == ColourMode::texture ? (x > 0.0 ? 1.0 : -1.0) : (x > 0.0 ? 0.7 : 0.2);
      const auto want =
          colour_of(paint.legend.map, (value - paint.legend.low) / (paint.legend.high - paint.legend.low));
      for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(paint.rgba[4 * v + c], want[c], 1) << x;
      if (exhibit.view().finest().normal[v].z() < 0.0F) ++behind[x > 0.0 ? 1 : 0];
    }
    EXPECT_GT(std::min(behind[0], behind[1]), 300U);
    EXPECT_EQ(paint.legend.title.find("front"), std::string::npos);
  }
}

// Red where x is positive, blue elsewhere, on the back as on the front; intensities alone are greys.
TEST(WholePicture, HasTheScansColoursOnAllSides) {
  scene::Charts charts = charts_of(*sparsha::test::make_torus(), 20'000, 0.1);
  for (scene::Sheet& sheet : charts.sheets) {
    sheet.colour_rgba.assign(sheet.count(), 0);
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i)
        if (sheet.measured(sheet.index(i, j)))
          sheet.colour_rgba[sheet.index(i, j)] =
              (charts.origin_m + charts.place_m(sheet, i, j)).x() > 0.0 ? 0xFF0000C8U : 0xFFC80000U;
  }
  const gl::OffscreenContext context;
  const scene::ScenePointer scene = flat_scene(charts);
  const Paint nothing;
  const ReliefData front;
  const auto expect_halves = [&](Exhibit& exhibit, const Paint& paint, const std::array<std::array<int, 3>, 2>& want) {
    const ObjectView& view = exhibit.view();
    ASSERT_EQ(paint.rgba.size(), 4 * view.finest().place.size());
    std::array<std::size_t, 2> behind{};
    for (std::size_t v = 0; v < view.finest().place.size(); ++v) {
      ASSERT_EQ(paint.rgba[4 * v + 3], 255) << "a vertex without colour";
      const double x = view.place_m(v).x();
      if (std::abs(x) < 4.0 * exhibit.spacing_m()) continue;
      for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(paint.rgba[4 * v + c], want[x > 0.0 ? 1 : 0][c], 1) << x;
      if (view.finest().normal[v].z() < 0.0F) ++behind[x > 0.0 ? 1 : 0];
    }
    EXPECT_GT(std::min(behind[0], behind[1]), 300U);
    EXPECT_EQ(paint.legend.title.find("front"), std::string::npos);
  };
  {
    Exhibit exhibit(charts);
    expect_halves(exhibit, paint_object(exhibit.view(), {scene->description(), 0.1, front, nothing}, ColourMode::scan),
                  {{{0, 0, 200}, {200, 0, 0}}});
  }
  for (scene::Sheet& sheet : charts.sheets) {
    for (const std::uint32_t rgba : sheet.colour_rgba)
      sheet.intensity.push_back(rgba == 0             ? std::numeric_limits<float>::quiet_NaN()
                                : rgba == 0xFF0000C8U ? 9.0F
                                                      : 4.0F);
    sheet.colour_rgba.clear();
  }
  Exhibit exhibit(charts);
  expect_halves(exhibit, paint_object(exhibit.view(), {scene->description(), 0.1, front, nothing}, ColourMode::scan),
                {{{40, 40, 40}, {255, 255, 255}}});
}

// Half the sum of the principal curvatures times sigma squared is what a Gaussian mean cuts off.
TEST(WholePicture, HasLocalReliefCoverageAndDistancesOfItsOwn) {
  scene::Charts charts = charts_of(*sparsha::test::make_torus(Eigen::Matrix3d::Identity()), 40'000, 0.0);
  for (scene::Sheet& sheet : charts.sheets) sheet.error_m.assign(sheet.count(), 0.002F);
  const gl::OffscreenContext context;
  Exhibit exhibit(charts);
  const scene::ScenePointer scene = flat_scene(charts);
  const Paint nothing;
  const ReliefData front;
  const ObjectSource source{scene->description(), 0.1, front, nothing};
  const ObjectView& view = exhibit.view();
  const Paint relief = paint_object(view, source, ColourMode::local_relief);
  ASSERT_EQ(relief.rgba.size(), 4 * view.finest().place.size());
  constexpr double kRing = 1.0, kTube = 0.4, kSigma = 0.816 / 40.0 * 2.0 * (kRing + kTube);
  std::array<double, 2> off{}, count{};  // levels; on the inner side of the ring and on the outer one
  for (std::size_t v = 0; v < view.finest().place.size(); ++v) {
    const Eigen::Vector3d normal = view.finest().normal[v].cast<double>();
    const Eigen::Vector3d place = view.place_m(v);
    const double towards = place.head<2>().normalized().dot(normal.head<2>());
    if (std::abs(towards) < 0.95) continue;
    const double ring = kRing + kTube * towards;
    const double value = 1e3 * 0.5 * (1.0 / kTube + towards / ring) * kSigma * kSigma;
    const auto want =
        colour_of(relief.legend.map, (value - relief.legend.low) / (relief.legend.high - relief.legend.low));
    const std::size_t side = towards > 0.0 ? 1 : 0;
    for (std::size_t c = 0; c < 3; ++c) off[side] += (relief.rgba[4 * v + c] - static_cast<double>(want[c])) / 3.0;
    count[side] += 1.0;
  }
  for (const std::size_t side : {0U, 1U}) {
    ASSERT_GT(count[side], 500.0);
    EXPECT_LT(std::abs(off[side] / count[side]), 6.0) << (side == 0 ? "inner" : "outer");
  }

  // Nothing is continued of what has no edges; along those of a cube the sheets go on to where they meet.
  const Paint coverage = paint_object(view, source, ColourMode::coverage);
  ASSERT_EQ(coverage.legend.swatches.size(), 2U);
  EXPECT_EQ(coverage.legend.swatches[0].name, "measured 100.0 %");
  Exhibit cube(charts_of(*sparsha::test::make_box({0.6, 0.6, 0.6}, Eigen::Matrix3d::Identity()), 20'000, 0.1));
  const Paint of_cube = paint_object(cube.view(), source, ColourMode::coverage);
  std::size_t continued = 0;
  const std::vector<Eigen::Vector3f>& vertices = cube.view().finest().place;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (of_cube.rgba[4 * v + 2] != kFilledColour[2]) continue;
    ++continued;
    Eigen::Vector3d place = cube.view().place_m(v).cwiseAbs();
    std::sort(place.begin(), place.end());
    EXPECT_GT(place[1], 0.6 - 4.0 * cube.spacing_m());
  }
  EXPECT_GT(continued, 100U);
  EXPECT_LT(continued, vertices.size() / 5);
  const Paint distance = paint_object(view, source, ColourMode::error);
  EXPECT_NEAR(distance.legend.high, 2.0, 1e-6);
  EXPECT_EQ(distance.legend.unit, "mm");
  for (std::size_t v = 0; v < view.finest().place.size(); ++v) ASSERT_EQ(distance.rgba[4 * v + 3], 255);
  for (const Paint* paint : {&relief, &coverage, &distance})
    EXPECT_EQ(paint->legend.title.find("front"), std::string::npos);
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
