// Pictures drawn without a display and judged by their pixels. Positions are recomputed here from the scene's numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "base/error.h"
#include "base/files/files.h"
#include "base/png/png_reader.h"
#include "relief_scene.h"
#include "scene/scene.h"
#include "studio.h"
#include "tests/support/soft_stone.h"
#include "tests/support/test_folder.h"
#include "viewer/viewer.h"

namespace sparsha::viewer::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

SceneOptions plate() {
  SceneOptions options;
  options.nx = options.ny = 201;
  options.spacing_m = 0.001;
  return options;
}

/// Stone is warm, the backdrop is neutral and dark.
bool is_stone(const Pixel& p) { return p.r > 60 && p.r > p.b + 12; }
bool is_ball(const Pixel& p) { return p.b > p.r + 40; }

haptics::State in_air(const scene::Scene& scene, double x_m, double y_m, double z_m, double cx_m, double cy_m) {
  haptics::State state = touching(scene, x_m, y_m, z_m, cx_m, cy_m);
  state.hip_m = state.proxy_m;
  state.contact = 0;
  state.normal = {};
  state.force_n = state.commanded_force_n = {};
  return state;
}

TEST(Picture, IsNotBlankAndHasNoGlErrors) {
  Studio studio(scene_of(lotus, {401, 401, 0.001, 3}));
  const auto scene = studio.picture().scene();
  const Image image = studio.shoot(touching(*scene, 0.2, 0.25, 0.01, 0.22, 0.22));
  double low = 255.0, high = 0.0;
  for (int y = 150; y < 550; y += 3)
    for (int x = 250; x < 650; x += 3) {
      low = std::min(low, image.at(x, y).luminance());
      high = std::max(high, image.at(x, y).luminance());
    }
  EXPECT_GT(high - low, 60.0) << "a carved stone under a raking light has lights and shades";
  EXPECT_TRUE(studio.gl_errors().empty()) << studio.gl_errors().front();
}

TEST(Picture, ASlopeThatFacesTheLightIsBrighter) {
  // A roof with its ridge along y: the left side falls to the left.
  const auto roof = [](double x_m, double) { return 0.05 - 0.25 * std::abs(x_m - 0.1); };
  ViewSettings settings;
  settings.light.azimuth_rad = 3.14159265358979;  // from the left
  Studio studio(scene_of(roof, plate()), settings);
  const Rect left{330, 300, 60, 100}, right{520, 300, 60, 100};
  const Image from_left = studio.shoot_bare();
  studio.controller().frame().settings.light.azimuth_rad = 0.0;
  const Image from_right = studio.shoot_bare();
  EXPECT_GT(from_left.mean_luminance(left), 1.3 * from_left.mean_luminance(right));
  EXPECT_GT(from_right.mean_luminance(right), 1.3 * from_right.mean_luminance(left));
}

TEST(Picture, ATallFormCastsItsShadowAwayFromTheLight) {
  const auto tower = [](double x_m, double y_m) {
    return std::max(std::abs(x_m - 0.1), std::abs(y_m - 0.1)) < 0.01 ? 0.03 : 0.0;
  };
  ViewSettings settings;
  settings.light = {3.14159265358979, 0.7};
  Studio studio(scene_of(tower, plate()), settings);
  const Image image = studio.shoot_bare();
  // 0.2 m are 0.92 of the height of a picture whose middle is the tower: a point 0.02 m away is about 65 pixels away.
  const Layout layout = layout_of(1280, 720, {});
  const int x = layout.detail.width / 2, y = layout.detail.height / 2;
  EXPECT_LT(image.mean_luminance({x + 50, y - 8, 16, 16}), 0.6 * image.mean_luminance({x - 66, y - 8, 16, 16}));
}

TEST(Picture, TheBallIsWhereTheProxyIs) {
  Studio studio(scene_of([](double, double) { return 0.0; }, plate()));
  const auto scene = studio.picture().scene();
  for (const auto& [x_m, y_m, z_m] : {std::tuple{0.10, 0.10, 0.004}, {0.13, 0.12, 0.004}, {0.08, 0.06, 0.010}}) {
    const haptics::State state = in_air(*scene, x_m, y_m, z_m, 0.10, 0.10);
    studio.settle(state);
    const Image image = studio.shoot_bare(state);
    // Similar triangles in the camera's own frame; the ball stands on the proxy.
    const Camera& camera = studio.controller().frame().camera;
    const double width_m = 0.099, unit_m = 0.2, ball = 0.016 * width_m / unit_m;
    const double dx = (x_m - 0.1) / unit_m - camera.target.x();
    const double dy = (y_m - 0.1) / unit_m - camera.target.y();
    const double dz = z_m / unit_m + ball - camera.target.z();
    const double up = dy * std::cos(camera.tilt_rad) + dz * std::sin(camera.tilt_rad);
    const double away = camera.distance - (dz * std::cos(camera.tilt_rad) - dy * std::sin(camera.tilt_rad));
    const Layout layout = layout_of(1280, 720, {});
    const double focal = 0.5 * layout.detail.height / std::tan(0.5 * camera.field_rad);
    const double px = 0.5 * layout.detail.width + focal * dx / away;
    const double py = 0.5 * layout.detail.height - focal * up / away;
    const Image::Spot spot = image.find(layout.detail, is_ball);
    ASSERT_GT(spot.count, 100);
    const double radius = focal * ball / away;
    EXPECT_NEAR(spot.x, px, 0.25 * radius + 1.0);
    EXPECT_NEAR(spot.y, py, 0.25 * radius + 1.0);
    EXPECT_NEAR(spot.right - spot.left + 1, 2.0 * radius, 0.35 * radius + 2.0);
  }
}

TEST(Picture, ContactIsHighlightedAndTheForceIsAnArrow) {
  Studio studio(scene_of([](double, double) { return 0.0; }, plate()));
  const auto scene = studio.picture().scene();
  const haptics::State free = in_air(*scene, 0.1, 0.1, 0.0, 0.1, 0.1);
  haptics::State pressed = touching(*scene, 0.1, 0.1, 0.0, 0.1, 0.1);
  studio.settle(free);
  const Layout layout = layout_of(1280, 720, {});
  const auto white = [](const Pixel& p) { return p.r > 235 && p.g > 235 && p.b > 235; };
  const int before = studio.shoot_bare(free).find(layout.detail, white).count;
  const int with_arrow = studio.shoot_bare(pressed).find(layout.detail, white).count;
  pressed.commanded_force_n = {0.0, 0.0, 4.0};
  const int with_long_arrow = studio.shoot_bare(pressed).find(layout.detail, white).count;
  EXPECT_GT(with_arrow, before + 60);
  EXPECT_GT(with_long_arrow, with_arrow + 40);
}

TEST(Picture, OfStoneThatGivesNoForceNeitherArrowNorGlowIsShown) {
  Studio studio(scene_of([](double, double) { return 0.0; }, plate()));
  const auto scene = studio.picture().scene();
  sparsha::test::SoftStone stone(haptics::window_on(scene));
  const haptics::State soft = stone.state();
  ASSERT_GT(soft.force_n[2], stone.kRaw_n);
  haptics::State nothing = soft;
  nothing.force_n = {};
  studio.settle(soft);
  const Image shown = studio.shoot_bare(soft);
  EXPECT_EQ(shown.rgba, studio.shoot_bare(nothing).rgba) << "the raw force is no part of the picture";
  const Image felt = studio.shoot_bare(stone.felt());
  const Layout layout = layout_of(1280, 720, {});
  const auto white = [](const Pixel& p) { return p.r > 235 && p.g > 235 && p.b > 235; };
  EXPECT_GT(felt.find(layout.detail, white).count, shown.find(layout.detail, white).count + 60);
  haptics::State little = soft;  // no arrow yet, but a glow
  little.commanded_force_n = {0.0, 0.0, 0.01};
  const Image glowing = studio.shoot_bare(little);
  int other = 0;
  for (std::size_t k = 0; k < shown.rgba.size(); k += 4)
    other += std::abs(int{glowing.rgba[k]} - int{shown.rgba[k]}) > 20 ? 1 : 0;
  EXPECT_GT(other, 200);
}

TEST(Picture, TheWindowsFrameLiesInTheOverviewWhereTheWindowIs) {
  Studio studio(scene_of(lotus, {401, 401, 0.001, 1}));
  const auto scene = studio.picture().scene();
  haptics::State state = touching(*scene, 0.28, 0.30, 0.01, 0.28, 0.30);
  const Image with = studio.shoot(state);
  const Image bare = studio.shoot_bare(state);
  const Rect overview = layout_of(1280, 720, {}).overview;
  const Image::Spot stone = bare.find(overview, is_stone);
  // Amber pixels that the picture without the interface does not have.
  Image marks = with;
  for (std::size_t k = 0; k < marks.rgba.size(); ++k)
    if (std::abs(with.rgba[k] - bare.rgba[k]) < 8 && k % 4 != 3) marks.rgba[k] = 0;
  const auto amber = [](const Pixel& p) { return p.r > 150 && p.g > 80; };
  const Image::Spot frame = marks.find(overview, amber);
  ASSERT_GT(frame.count, 100);
  const double pixels_per_m = (stone.right - stone.left + 1) / 0.400;
  const double half = 0.5 * 0.099;
  EXPECT_NEAR(frame.left, stone.left + (0.28 - half) * pixels_per_m, 3.0);
  EXPECT_NEAR(frame.right, stone.left + (0.28 + half) * pixels_per_m, 3.0);
  EXPECT_NEAR(frame.top, stone.bottom - (0.30 + half) * pixels_per_m, 3.0);
  EXPECT_NEAR(frame.bottom, stone.bottom - (0.30 - half) * pixels_per_m, 3.0);
}

TEST(Picture, ABumpInTheUpperRightOfTheGridAppearsUpperRight) {
  const auto bump = [](double x_m, double y_m) {
    return 0.02 * std::exp(-(std::pow(x_m - 0.15, 2) + std::pow(y_m - 0.16, 2)) / 1e-4);
  };
  ViewSettings settings;
  settings.colour = ColourMode::height;
  Studio studio(scene_of(bump, plate()), settings);
  const Image image = studio.shoot_bare();
  const auto high = [](const Pixel& p) { return p.g > 120 && p.r > p.b + 20; };
  const auto any = [](const Pixel& p) { return p.r + p.g + p.b > 120; };
  const Layout layout = layout_of(1280, 720, {});
  const Image::Spot small = image.find(layout.overview, high), stone = image.find(layout.overview, any);
  ASSERT_GT(small.count, 20);
  const double side = stone.right - stone.left + 1;
  EXPECT_NEAR((small.x - stone.left) / side, 0.15 / 0.2, 0.03);
  EXPECT_NEAR((stone.bottom + 1 - small.y) / side, 0.16 / 0.2, 0.03);
  const Image::Spot large = image.find(layout.detail, high);
  ASSERT_GT(large.count, 50);
  EXPECT_GT(large.x, layout.detail.width / 2 + 100);
  EXPECT_LT(large.y, layout.detail.height / 2 - 100);
}

TEST(Picture, UnknownGroundIsLeftOutAndOutlinedOnlyWhenAsked) {
  const auto half = [](double x_m, double) { return x_m < 0.1 ? 0.0 : kNaN; };
  Studio studio(scene_of(half, plate()));
  const Layout layout = layout_of(1280, 720, {});
  const int middle = layout.detail.width / 2, y = layout.detail.height / 2;
  const Rect unknown{middle + 20, y - 60, 150, 120}, known{middle - 170, y - 60, 150, 120};
  const Image image = studio.shoot_bare();
  EXPECT_EQ(image.find(unknown, is_stone).count, 0);
  EXPECT_EQ(image.find(known, is_stone).count, known.width * known.height);
  const auto bright = [](const Pixel& p) { return p.luminance() > 90.0 && p.r < p.b + 60; };
  const Rect rim{middle - 2, y - 60, 12, 120};
  const int without = image.find(rim, bright).count;
  studio.act(Action::outline);
  EXPECT_GT(studio.shoot_bare().find(rim, bright).count, without + 100);
}

TEST(Picture, NoCurtainHangsFromANearFormToAFarOne) {
  // A plate floats half its width over another; seen aslant there is nothing between them.
  const auto plates = [](double x_m, double) { return x_m < 0.1 ? 0.1 : 0.0; };
  Studio studio(scene_of(plates, plate()));
  studio.act(Action::turn_right, 20);  // about a quarter: the step is seen from its low side
  studio.act(Action::tilt_down, 15);
  studio.settle();
  const Image image = studio.shoot_bare();
  const View& view = studio.picture().detail_view();
  const Stage& stage = studio.picture().stage();
  int stone = 0, places = 0;
  for (int k = 1; k < 20; ++k) {
    // On the wall that a curtain would be.
    const auto pixel = view.to_pixel(stage.to_world({0.0995, 0.1, 0.005 * k}));
    ASSERT_TRUE(pixel);
    // What is seen there lies farther than the wall, or is nothing at all.
    ++places;
    stone += is_stone(image.at(static_cast<int>(pixel->x()), static_cast<int>(pixel->y()))) ? 1 : 0;
  }
  EXPECT_LT(stone, places / 4);
}

TEST(Picture, TheFirstViewLooksStraightOnAndHomeRestoresIt) {
  Studio studio(scene_of(lotus, {401, 401, 0.001, 1}));
  const auto scene = studio.picture().scene();
  const haptics::State state = touching(*scene, 0.2, 0.2, 0.01, 0.2, 0.2);
  const Image first = studio.shoot_bare(state);
  EXPECT_EQ(studio.controller().frame().camera.tilt_rad, 0.0);
  for (const Action action : {Action::turn_left, Action::tilt_down, Action::closer, Action::tilt_down}) {
    studio.act(action, 7);
    studio.settle(state);
  }
  EXPECT_NE(studio.shoot_bare(state).rgba, first.rgba);
  studio.act(Action::home);
  studio.settle(state);
  EXPECT_EQ(studio.shoot_bare(state).rgba, first.rgba);
}

TEST(Picture, FilledAreasAreMarkedOnlyWhenAsked) {
  const auto filled = [](scene::Layers& layers) {
    for (int j = 80; j < 120; ++j)
      for (int i = 80; i < 120; ++i) layers.grid.state[layers.grid.lattice.index(i, j)] = scene::NodeState::filled;
  };
  Studio studio(scene_of([](double, double) { return 0.0; }, plate(), {}, filled));
  const int middle = layout_of(1280, 720, {}).detail.width / 2;
  const auto blue = [](const Pixel& p) { return p.b > p.r; };
  const Rect inside{middle - 50, 310, 100, 100};
  EXPECT_EQ(studio.shoot_bare().find(inside, blue).count, 0);
  studio.act(Action::filled);
  EXPECT_GT(studio.shoot_bare().find(inside, blue).count, 1000);
}

TEST(Picture, SurfacesAreDrawnAgainOnlyWhenCameraOrDataChange) {
  Studio studio(scene_of(lotus, {401, 401, 0.001, 1}));
  const auto scene = studio.picture().scene();
  haptics::State state = touching(*scene, 0.2, 0.2, 0.01, 0.2, 0.2);
  studio.shoot(state);
  const int first = studio.picture().surface_redraws();
  EXPECT_EQ(first, 2) << "detail and overview";
  for (int k = 0; k < 5; ++k) {
    state.proxy_m[0] += 0.002;
    studio.shoot(state);
  }
  EXPECT_EQ(studio.picture().surface_redraws(), first) << "a moving hand draws no stone";
  studio.act(Action::turn_left);
  studio.settle(state);
  studio.shoot(state);
  EXPECT_EQ(studio.picture().surface_redraws(), first + 1) << "a turned camera draws the detail view only";
  studio.act(Action::light_turn);
  studio.shoot(state);
  EXPECT_EQ(studio.picture().surface_redraws(), first + 3);
}

TEST(Picture, AnaglyphOfASurfaceInTheScreensPlaneIsGrey) {
  Studio studio(scene_of([](double, double) { return 0.0; }, plate()));
  studio.act(Action::stereo, 2);
  const Image image = studio.shoot_bare();
  const int middle = layout_of(1280, 720, {}).detail.width / 2;
  for (int y = 300; y < 420; y += 7)
    for (int x = middle - 60; x < middle + 60; x += 7) {
      const Pixel p = image.at(x, y);
      // Dubois's rows do not add up to exactly one: 2 % in linear light are at most 4 of 255 steps.
      EXPECT_NEAR(p.r, p.g, 6);
      EXPECT_NEAR(p.g, p.b, 6);
    }
}

TEST(Picture, TheDisparityOfAKnownPointIsTheFormulasToAPixel) {
  // A flat plate, and a ball that hovers over it: its distance along the line of sight is known.
  Studio studio(scene_of([](double, double) { return 0.0; }, plate()));
  const auto scene = studio.picture().scene();
  studio.act(Action::stereo, 3);
  ASSERT_EQ(studio.controller().settings().stereo.mode, StereoMode::side_by_side);
  for (const double z_m : {0.0, 0.015, 0.03}) {
    const haptics::State state = in_air(*scene, 0.1, 0.1, z_m, 0.1, 0.1);
    studio.settle(state);
    const Image image = studio.shoot_bare(state);
    const Layout layout = layout_of(1280, 720, {});
    const int half = layout.detail.width / 2;
    const Image::Spot left = image.find({0, 0, half, layout.detail.height}, is_ball);
    const Image::Spot right = image.find({half, 0, half, layout.detail.height}, is_ball);
    ASSERT_GT(left.count, 50);
    ASSERT_GT(right.count, 50);
    const Camera& camera = studio.controller().frame().camera;
    const Stereo& stereo = studio.controller().settings().stereo;
    const double unit_m = 0.2, ball = 0.016 * 0.099 / unit_m;
    const double focal = 0.5 * layout.detail.height / std::tan(0.5 * camera.field_rad);
    const double away = camera.distance - (z_m / unit_m + ball - (camera.target.z() + 0.0));
    const double eyes = stereo.separation * camera.distance;
    const double formula = focal * eyes * (1.0 / (stereo.convergence * camera.distance) - 1.0 / away);
    EXPECT_NEAR((right.x - half) - left.x, formula, 1.0) << z_m;
  }
}

TEST(Picture, EveryModeDrawsWithoutGlErrorsAndFreesWhatItTook) {
  const auto edit = [](scene::SceneDescription& description) {
    description.has_envelope = description.has_curvature = description.has_colour = true;
    description.config.friction.emplace();
    description.friction_c_m = 0.01;
  };
  const auto layers = [](scene::Layers& l) {
    l.envelope_m = l.grid.height_m;
    l.curvature_per_m.assign(l.grid.lattice.count(), 20.0F);
    l.colour_rgba.assign(l.grid.lattice.count(), 0xFF3050A0U);
  };
  Studio studio(scene_of(lotus, {201, 201, 0.002, 2}, edit, layers));
  const auto scene = studio.picture().scene();
  const haptics::State state = touching(*scene, 0.2, 0.2, 0.01, 0.2, 0.2);
  for (const Action action : {Action::colour, Action::colour, Action::colour, Action::colour, Action::stereo,
                              Action::stereo, Action::contrast, Action::large_type, Action::filled, Action::help}) {
    studio.act(action);
    studio.shoot(state);
  }
  haptics::State untextured = state;
  untextured.flags &= ~static_cast<std::uint64_t>(haptics::kFlagTexture);
  studio.shoot(untextured);
  studio.controller().frame().settings.kiosk = true;
  studio.shoot(state, 1920, 1080);
  studio.shoot(state, 200, 150);
  studio.shoot(state, 1, 1);
  EXPECT_TRUE(studio.gl_errors().empty()) << studio.gl_errors().front();
  studio.strike();
  EXPECT_EQ(gl::living_objects(), 0);
}

TEST(Picture, EveryVariantOfTheReliefsProgramCompiles) {
  const gl::OffscreenContext context;
  ReliefPrograms programs;
  for (unsigned features = 0; features < 64; ++features) EXPECT_NO_THROW(programs.with(features).use()) << features;
}

TEST(Picture, SurvivesScenesAtTheLimits) {
  const auto state_of = [](const scene::Scene& scene) { return touching(scene, 0.0, 0.0, 0.0, 0.0, 0.0); };
  const auto flat = [](double, double) { return 0.0; };
  const auto unknown = [](double, double) { return kNaN; };
  const auto needle = [](double x_m, double) { return x_m > 0.02 && x_m < 0.022 ? 1e4 : 0.0; };
  for (const auto& scene :
       {scene_of(flat, {1, 1, 0.001, 1}), scene_of(flat, {2, 2, 0.001, 1}), scene_of(flat, {1, 300, 0.001, 1}),
        scene_of(unknown, {50, 40, 0.001, 1}), scene_of(needle, {64, 64, 0.001, 1}),
        scene_of(lotus, {101, 57, 0.004, 1, {450000.0, 5412000.0, 5.4e6}}), scene_of(flat, {64, 64, 1e-9, 1}),
        scene_of(flat, {64, 64, 1e5, 1})}) {
    Studio studio(scene);
    studio.shoot(state_of(*scene));
    studio.shoot();
    haptics::State broken = state_of(*scene);
    broken.proxy_m = {kNaN, kNaN, kNaN};
    broken.hip_m = broken.commanded_force_n = broken.normal = broken.proxy_m;
    studio.shoot(broken);
    broken.centre_m = broken.proxy_m;
    broken.scale = kNaN;
    studio.shoot(broken);
    broken.level = 77;
    studio.shoot(broken);
    EXPECT_TRUE(studio.gl_errors().empty()) << studio.gl_errors().front();
  }
}

TEST(Picture, ABigSceneShowsTheFinestLevelAroundTheWindow) {
  // Waves that only level 0 resolves, 4 nodes long, in a scene too big to be drawn whole at level 0.
  const double spacing_m = 0.0005;
  const auto waves = [&](double x_m, double) {
    return 0.0005 * std::cos(2.0 * 3.14159265358979 * x_m / (4.0 * spacing_m));
  };
  Studio studio(scene_of(waves, {4096, 4096, spacing_m, 2}));
  const auto scene = studio.picture().scene();
  const double centre_m = 2048 * spacing_m;
  haptics::State state = touching(*scene, centre_m, centre_m, 0.0, centre_m, centre_m);
  EXPECT_NEAR(studio.picture().height_at(centre_m + 10 * spacing_m, centre_m), waves(centre_m + 10 * spacing_m, 0.0),
              1e-6);
  EXPECT_GT(std::abs(studio.picture().height_at(centre_m + spacing_m, centre_m) - waves(centre_m + spacing_m, 0.0)),
            0.0);
  const Image image = studio.shoot(state);
  for (int k = 0; k < 8; ++k)
    EXPECT_NEAR(studio.picture().height_at(centre_m + k * spacing_m, centre_m), waves(centre_m + k * spacing_m, 0.0),
                1e-6);
  EXPECT_GT(image.mean_luminance({300, 200, 300, 300}), 20.0);
  EXPECT_TRUE(studio.gl_errors().empty()) << studio.gl_errors().front();
}

TEST(Screenshot, WritesAPngOfTheContractsSizeOrNothing) {
  const sparsha::test::TestFolder folder;
  const auto file = folder / "view.png";
  const auto scene = scene_of(lotus, {201, 201, 0.002, 1});
  write_screenshot(scene, touching(*scene, 0.2, 0.2, 0.01, 0.2, 0.2), {}, file);
  ASSERT_TRUE(std::filesystem::exists(file));
  EXPECT_GT(std::filesystem::file_size(file), 100'000U) << "a blank picture is far smaller";
  EXPECT_THROW(write_screenshot(scene, {}, {}, folder / "missing" / "view.png"), Error);
}

/// Of the strip's blue curve, in a picture on disk.
std::size_t depth_pixels(const std::filesystem::path& file) {
  const ColourImage image =
      read_colour_png(read_file(file, 10'000'000), file.string(), [](std::size_t, std::size_t) {});
  return static_cast<std::size_t>(std::ranges::count_if(image.rgba, [](std::uint32_t rgba) {
    const auto* p = reinterpret_cast<const unsigned char*>(&rgba);
    return std::abs(p[0] - 110) < 12 && std::abs(p[1] - 190) < 12 && std::abs(p[2] - 255) < 12;
  }));
}

TEST(Screenshot, ShowsTheSecondsBeforeTheTouch) {
  const sparsha::test::TestFolder folder;
  const auto scene = scene_of(lotus, {201, 201, 0.002, 1});
  haptics::State state = touching(*scene, 0.2, 0.2, 0.01, 0.2, 0.2);
  Strip strip;
  for (int k = 0; k <= 500; ++k) {
    state.tick = static_cast<std::uint64_t>(20 * k + 1);
    state.time_s = 0.02 * k;
    state.penetration_m = 0.0004 * (1.0 + std::sin(0.05 * k));
    strip.add(state);
  }
  write_screenshot(scene, state, {}, folder / "with.png", strip);
  write_screenshot(scene, state, {}, folder / "without.png");
  EXPECT_GT(depth_pixels(folder / "with.png"), depth_pixels(folder / "without.png") + 100);
}

}  // namespace
}  // namespace sparsha::viewer::test
