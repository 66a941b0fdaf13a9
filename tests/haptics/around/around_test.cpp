// Touch of whole objects whose surface is known, judged by a god-object on their exact distance. Lengths are in mean
// point spacings, h.
#include "haptics/around/around_proxy.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "pipeline/charts/charts.h"
#include "tests/support/god_object.h"
#include "tests/support/wandering_hand.h"

namespace sparsha::test {
namespace {

using Eigen::Vector3d;
using haptics::AroundState;
using haptics::AroundUpdate;

void expect_true(const Touched& on, const Outcome& o, double most_error) {
  const std::string all = on.name + ": " + std::to_string(o.contacts) + " contacts, " + std::to_string(o.through) +
                          " through, " + std::to_string(o.unfinished) + " unfinished, " + std::to_string(o.hand_overs) +
                          " hand-overs, " + std::to_string(o.edges) + " edges, " + std::to_string(o.off_surface) +
                          " off, " + std::to_string(o.apart) + " of " + std::to_string(o.compared) + " apart, " +
                          std::to_string(o.forked) + " forked, force " + std::to_string(o.force_error) + ", " +
                          std::to_string(o.turn_deg) + " degrees, " + std::to_string(o.ns_median) + " and " +
                          std::to_string(o.ns_p99) + " ns";
  if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
  EXPECT_GT(o.contacts, o.ticks / 4) << all;
  EXPECT_GT(o.hand_overs, 5U) << all;
  EXPECT_EQ(o.through, 0U) << all;
  EXPECT_EQ(o.not_a_number, 0U) << all;
  EXPECT_EQ(o.released, 0U) << all;
  EXPECT_EQ(o.off_surface, 0U) << all;
  EXPECT_EQ(o.apart, 0U) << all;
  EXPECT_LE(o.forked, o.compared / 50) << all;
  EXPECT_LE(o.unfinished, o.ticks / 1000) << all;
  EXPECT_LE(o.force_error, most_error) << all;
  EXPECT_LE(o.turn_deg, 4.0) << all;
}

std::vector<Touched> smooth_objects() {
  return {touched("torus", make_torus()), touched("two spheres", make_two_spheres()),
          touched("vase", make_vase(turned(48.0, 0.0)), 100'000), touched("knot", make_knot())};
}

TEST(Around, AHandThatWandersFeelsTheTrueSurface) {
  const bool nightly = std::getenv("SPARSHA_NIGHTLY") != nullptr;
  for (const Touched& on : smooth_objects()) {
    const double most_error = on.name == "knot" ? 0.02 : 0.01;  // the knot's tube is eight spacings thick
    for (const haptics::CellShape shape : {haptics::CellShape::bilinear, haptics::CellShape::rounded})
      expect_true(on, wander(on, nightly ? 200'000 : 4'000, 4.0, 7, {.shape = shape}), most_error);
  }
}

/// Nodes are moved along their side's axis onto the true surface, by Newton's steps. Those whose slope is that of a
/// flank stay.
void move_onto(const ClosedObject& object, double h, scene::Charts& charts) {
  for (scene::Sheet& sheet : charts.sheets) {
    const scene::SideAxes axes = scene::SideAxes::of(sheet.side);
    const Vector3d up = axes.to_grid(Vector3d(0.0, 0.0, 1.0));
    for (int j = 0; j < sheet.ny; ++j) {
      for (int i = 0; i < sheet.nx; ++i) {
        const std::size_t node = sheet.index(i, j);
        if (!sheet.measured(node)) continue;
        Vector3d place = charts.place_m(sheet, i, j) + charts.origin_m;
        const Vector3d before = place;
        Vector3d normal = up;
        for (int k = 0; k < 8; ++k) {
          normal = GodObject(object, h, place).normal(place);
          place -= object.distance_m(place) / std::max(0.3, normal.dot(up)) * up;
        }
        if (normal.dot(up) <= 0.3 || (place - before).norm() > h) continue;
        sheet.height_m[node] += static_cast<float>((place - before).dot(up));
        const Vector3d local = axes.to_chart(normal);
        sheet.slope_u[node] = static_cast<float>(-local.x() / local.z());
        sheet.slope_v[node] = static_cast<float>(-local.y() / local.z());
      }
    }
  }
}

TEST(Around, OnExactNodesTheForceIsThatOfTheTrueSurface) {
  struct Object {
    std::string name;
    ObjectPtr object;
    double most_error;
  };
  for (const Object& exact : {Object{"torus", make_torus(), 0.004}, Object{"two spheres", make_two_spheres(), 0.004},
                              Object{"knot", make_knot(), 0.008}}) {
    ScanOptions options;
    options.points = 20'000;
    options.seed = 12;
    const ObjectScan scan = scan_object(*exact.object, options);
    ThreadPool pool(2);
    Progress progress;
    scene::GridConfig grid;
    grid.spacing_m = scan.spacing_m;
    auto charts =
        pipeline::make_charts(make_cloud(scan.points), Eigen::Matrix4d::Identity(), grid, 0.0, {pool, progress}).charts;
    move_onto(*exact.object, scan.spacing_m, charts);
    const Touched on{exact.name, exact.object, scan.spacing_m, haptics::make_object_surface(charts)};
    for (const haptics::CellShape shape : {haptics::CellShape::bilinear, haptics::CellShape::rounded})
      expect_true(on, wander(on, 2'500, 4.0, 7, {.shape = shape}), exact.most_error);
  }
}

/// What a hand that wanders over an object for so long may see, in ticks.
struct Allowed {
  Touched on;
  double through = 0.6;      ///< spacings deep a free hand is one that has come through
  double longest_arm = 1e9;  ///< spacings
  bool has_edges = false;
  bool has_hole = false;
};

// Scans wear edges by some tenths of a spacing and corners by one, and no person presses further past them.
Allowed sharp(const char* name, const ObjectPtr& object) { return {touched(name, object), 1.3, 8.0, true, false}; }

const Eigen::Matrix3d& oblique() {
  static const Eigen::Matrix3d view = turned(20.0, 30.0);
  return view;
}

const double kPlateSpacing = std::sqrt(8.0 / 20'000.0);

struct Kind {
  std::string name;
  Allowed (*make)();
};

/// One object a test: by night each is wandered over for minutes.
class AroundKinds : public ::testing::TestWithParam<Kind> {};

INSTANTIATE_TEST_SUITE_P(
    Objects, AroundKinds,
    ::testing::Values(
        Kind{"Torus", [] { return Allowed{.on = touched("torus", make_torus())}; }},
        Kind{"TwoSpheres", [] { return Allowed{.on = touched("two spheres", make_two_spheres())}; }},
        Kind{"Vase", [] { return Allowed{.on = touched("vase", make_vase(turned(48.0, 0.0)), 100'000)}; }},
        // Of 20 000 points its strands are so near to each other that one place has no node of any side.
        Kind{"Knot", [] { return Allowed{.on = touched("knot", make_knot(), 100'000)}; }},
        Kind{"Coin", [] { return Allowed{.on = touched("coin", make_coin()), .has_edges = true}; }},
        Kind{"PlateOfFive",
             [] {
               return sharp("plate of 5", make_box({1.0, 1.0, 2.5 * kPlateSpacing}, oblique()));
             }},
        Kind{"BevelledCube", [] { return sharp("bevelled cube", make_bevelled_cube(0.6, 0.1, oblique())); }},
        Kind{"BladeOfThree",
             [] {
               return sharp("blade of 3", make_box({1.0, 1.0, 1.5 * kPlateSpacing}, oblique()));
             }},
        Kind{"TorusWithAHole",
             [] {
               return Allowed{.on = touched("torus with a hole", make_torus(), 20'000, {}, 5.0), .has_hole = true};
             }}),
    [](const ::testing::TestParamInfo<Kind>& kind) { return kind.param.name; });

TEST_P(AroundKinds, TenMillionTicksEndOnTheSurface) {
  const bool nightly = std::getenv("SPARSHA_NIGHTLY") != nullptr;
  const std::size_t ticks = nightly ? 10'000'000 : 5'000;
  const Allowed c = GetParam().make();
  const Touched& on = c.on;
  const Outcome o = wander(on, ticks, 3.0, 23, {.shape = haptics::CellShape::rounded}, c.through, c.longest_arm, false);
  const std::string all = on.name + ": " + std::to_string(o.ticks) + " ticks, " + std::to_string(o.contacts) +
                          " in contact, " + std::to_string(o.through) + " through, " + std::to_string(o.released) +
                          " let go, " + std::to_string(o.off_surface) + " off, " + std::to_string(o.trapped) +
                          " trapped, " + std::to_string(o.not_a_number) + " not a number, " +
                          std::to_string(o.unfinished) + " unfinished, " + std::to_string(o.edges) + " edges, " +
                          std::to_string(o.ns_median) + " and " + std::to_string(o.ns_p99) + " ns";
  if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
  EXPECT_GT(o.contacts, o.ticks / 4) << all;
  EXPECT_EQ(o.not_a_number, 0U) << all;
  EXPECT_LE(o.unfinished, o.ticks / 1'000) << all;
  // Through what is thin, or out of a hole, a hand comes out again while it is held.
  if (!c.has_edges && !c.has_hole) {
    EXPECT_EQ(o.trapped, 0U) << all;
  }
  const std::size_t edges = c.has_edges ? 1 + o.ticks / 5'000 : 0;  // ticks at them
  if (!c.has_hole) {
    EXPECT_LE(o.through, o.ticks / 1'000'000) << all;
    EXPECT_LE(o.released, edges + o.ticks / 1'000'000) << all;
  }
  EXPECT_LE(o.off_surface, edges + o.ticks / 1'000) << all;
}

/// A stroke two spacings deep over the border between two sides, there and back.
struct Stroke {
  std::size_t ticks = 0, lost = 0, off = 0, not_handed_over = 0, hand_overs = 0;
};
/// False where the surface is no way to stroke along: another part of the object is nearer.
bool stroke(const Touched& on, const SurfacePoint& at, const Vector3d& way, Stroke& result) {
  const GodObject judge(*on.object, on.h, at.position_m);
  const auto surface_at = [&](double along) {
    Vector3d place = at.position_m + along * on.h * way;
    for (int k = 0; k < 5; ++k) place -= on.object->distance_m(place) * judge.normal(place);
    return place;
  };
  for (double along = -6.0; along < 6.0; along += 0.25)
    if ((surface_at(along + 0.25) - surface_at(along)).norm() > 0.6 * on.h) return false;
  AroundState state;
  const auto hand_at = [&](double along, double depth) {
    const Vector3d place = surface_at(along);
    return update_around(*on.surface, place - depth * on.h * judge.normal(place) - on.surface->origin_m, state, {});
  };
  for (double depth = -2.0; depth < 2.0; depth += 0.25) (void)hand_at(-6.0, depth);
  for (const double sign : {1.0, -1.0}) {
    AroundUpdate found;
    for (double along = -6.0; along <= 6.0; along += 0.25, ++result.ticks) {
      found = hand_at(sign * along, 2.0);
      result.lost += found.contact ? 0 : 1;
      result.hand_overs += static_cast<std::size_t>(found.hand_overs);
      if (std::abs(on.object->distance_m(found.position_m + on.surface->origin_m)) > 0.5 * on.h) ++result.off;
    }
    if (!found.contact) continue;
    const Vector3d true_normal = judge.normal(found.position_m + on.surface->origin_m);
    const double facing = on.surface->sheets[found.sheet].axes.to_chart(true_normal).z();
    result.not_handed_over += facing < 0.42 ? 1 : 0;  // 0.5, but for the noise of slopes
  }
  return true;
}

TEST(Around, BordersOfSidesAreCrossedBothWays) {
  const int strokes = std::getenv("SPARSHA_NIGHTLY") != nullptr ? 5'000 : 150;
  for (const Touched& on : smooth_objects()) {
    std::mt19937_64 random(21);
    Stroke result;
    for (int k = 0; k < strokes;) {
      const SurfacePoint at = on.object->sample(random);
      int first = 0, last = 0;
      at.normal.cwiseAbs().maxCoeff(&first);
      at.normal.cwiseAbs().minCoeff(&last);
      const int second = 3 - first - last;
      if (std::abs(at.normal[first]) - std::abs(at.normal[second]) > 0.1) continue;
      Vector3d way = std::copysign(1.0, at.normal[second]) * Vector3d::Unit(second) -
                     std::copysign(1.0, at.normal[first]) * Vector3d::Unit(first);
      way = (way - way.dot(at.normal) * at.normal).normalized();
      if (stroke(on, at, way, result)) ++k;
    }
    const std::string all = on.name + ": " + std::to_string(strokes) + " strokes both ways, " +
                            std::to_string(result.hand_overs) + " hand-overs, " + std::to_string(result.lost) +
                            " lost, " + std::to_string(result.off) + " off, " + std::to_string(result.not_handed_over) +
                            " not handed over";
    if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
    EXPECT_GT(result.hand_overs, static_cast<std::size_t>(strokes) / 10) << all;
    EXPECT_EQ(result.lost, 0U) << all;
    EXPECT_LE(result.off, static_cast<std::size_t>(strokes) / 1'000) << all;
    EXPECT_LE(result.not_handed_over, static_cast<std::size_t>(strokes) / 1'000) << all;
  }
}

/// Where a straight way first enters the object, by small steps; nothing when it does not.
std::optional<Vector3d> entry(const ClosedObject& object, const Vector3d& from, const Vector3d& to, double step) {
  const double length = (to - from).norm();
  for (double way = 0.0; way <= length;) {
    const Vector3d at = from + (to - from) * (way / length);
    const double d = object.distance_m(at);
    if (d < 0.0) return at;
    way += std::max(step, 0.5 * d);
  }
  return std::nullopt;
}

TEST(Around, TheFirstCrossingOfAFastHandIsWhatItTouches) {
  for (const Touched& on : smooth_objects()) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    std::size_t entered = 0, missed = 0, made_up = 0, displaced = 0;
    for (int k = 0; k < 600; ++k) {
      const Vector3d from = 2.5 * Vector3d(normal(random), normal(random), normal(random)).normalized();
      const Vector3d to = on.object->sample(random).position_m - 0.3 * from.normalized();
      const auto flight = haptics::fly(*on.surface, from - on.surface->origin_m, to - on.surface->origin_m, false,
                                       haptics::CellShape::bilinear);
      const auto want = entry(*on.object, from, to, 0.05 * on.h);
      entered += want ? 1 : 0;
      if (want && !flight.crossing) ++missed;
      if (!flight.crossing) continue;
      const Vector3d at = from + flight.share * (to - from);
      if (!want) {
        made_up += on.object->distance_m(at) > 0.3 * on.h ? 1 : 0;
      } else if ((at - *want).norm() > 0.5 * on.h) {
        // A way that grazes the surface enters where noise lets it.
        const Vector3d n = GodObject(*on.object, on.h, at).normal(at);
        displaced += std::abs(n.dot((to - from).normalized())) > 0.3 ? 1 : 0;
      }
    }
    EXPECT_GT(entered, 400U) << on.name;
    EXPECT_LE(missed, 3U) << on.name;  // those that end within noise of the surface
    EXPECT_EQ(made_up, 0U) << on.name;
    EXPECT_EQ(displaced, 0U) << on.name;
  }
}

/// A plate of so many spacings between 2 m wide faces.
Touched plate(double spacings, const Eigen::Matrix3d& view) {
  const double spacing = std::sqrt(8.0 / 20'000.0);
  return touched("plate", make_box({1.0, 1.0, 0.5 * spacings * spacing}, view));
}

TEST(Around, AHandPushedThroughAThinPlateStaysOnTheSideThatItCameFrom) {
  for (const double spacings : {5.0, 3.5}) {
    const Eigen::Matrix3d view = turned(30.0, 20.0);
    const Touched on = plate(spacings, view);
    const Vector3d origin = on.surface->origin_m;
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> inner(-0.8, 0.8);
    for (int k = 0; k < 500; ++k) {
      const double side = k % 2 == 0 ? 1.0 : -1.0;
      const Vector3d at(inner(random), inner(random), 0.0);
      const double speed = on.h * std::exp(std::uniform_real_distribution<double>(-4.0, 2.0)(random));
      AroundState state;
      double depth = -3.0 * on.h;
      AroundUpdate found;
      for (; depth < 12.0 * on.h; depth += std::max(speed, 0.02 * on.h)) {
        const Vector3d hip = view * (at + side * Vector3d(0.0, 0.0, 0.5 * spacings * on.h - depth));
        found = update_around(*on.surface, hip - origin, state, {});
      }
      ASSERT_TRUE(found.contact) << spacings << " " << k;
      const Vector3d place = view.transpose() * (found.position_m + origin);
      EXPECT_NEAR(side * place.z(), 0.5 * spacings * on.h, 0.5 * on.h) << spacings << " " << k;
      EXPECT_FALSE(found.released);
    }
  }
}

/// A level sheet of so many nodes with its corner at (first_u, first_v, w), in spacings of 1 mm.
scene::Sheet level_sheet(scene::Side side, int first_u, int first_v, int nx, int ny, double w) {
  scene::Sheet sheet;
  sheet.side = side;
  sheet.first_u = first_u;
  sheet.first_v = first_v;
  sheet.nx = nx;
  sheet.ny = ny;
  sheet.height_m.assign(sheet.count(), static_cast<float>(1e-3 * w));
  sheet.slope_u.assign(sheet.count(), 0.0F);
  sheet.slope_v.assign(sheet.count(), 0.0F);
  sheet.mask.assign(sheet.count(), scene::Sheet::kMeasured);
  for (int j = 0; j + 1 < ny; ++j)
    for (int i = 0; i + 1 < nx; ++i) sheet.mask[sheet.index(i, j)] |= scene::Sheet::kCell;
  return sheet;
}

TEST(Around, AConcaveCornerHoldsTheHandAndLetsItSlideAlong) {
  // A floor at z = 0 before a wall at x = 10 mm that faces -x.
  scene::Charts charts;
  charts.spacing_m = 1e-3;
  charts.sheets.push_back(level_sheet(scene::Side::front, -30, -30, 41, 61, 0.0));
  charts.sheets.push_back(level_sheet(scene::Side::left, 0, -30, 31, 61, -10.0));  // u is z, v is y
  const auto object = haptics::make_object_surface(charts);
  const double mm = 1e-3;
  for (const haptics::CellShape shape : {haptics::CellShape::bilinear, haptics::CellShape::rounded}) {
    AroundState state;
    AroundUpdate found;
    Vector3d hand = Vector3d::Zero();
    const auto go = [&](const Vector3d& to_mm, double step_mm) {
      if (!state.started) hand = mm * to_mm;
      const Vector3d start = hand;
      const int steps = std::max(1, static_cast<int>((mm * to_mm - start).norm() / (mm * step_mm)));
      for (int k = 1; k <= steps; ++k) {
        hand = start + (mm * to_mm - start) * (static_cast<double>(k) / steps);
        found = update_around(*object, hand, state, {.shape = shape});
        ASSERT_TRUE(found.position_m.allFinite());
        ASSERT_FALSE(found.released) << k;
      }
    };
    const auto is_at = [&](double x, double y, double z) {
      EXPECT_NEAR((found.position_m / mm - Vector3d(x, y, z)).norm(), 0.0, 0.05) << (found.position_m / mm).transpose();
    };
    go({0.0, 0.3, 4.0}, 0.1);
    go({0.0, 0.3, -2.0}, 0.1);
    is_at(0.0, 0.3, 0.0);
    go({13.0, 0.3, -2.0}, 0.1);  // along the floor, into the wall
    is_at(10.0, 0.3, 0.0);
    go({13.0, 12.6, -2.0}, 0.1);  // along the corner
    is_at(10.0, 12.6, 0.0);
    go({13.0, -7.2, -2.0}, 1.7);  // fast
    is_at(10.0, -7.2, 0.0);
    go({13.0, -7.2, 6.0}, 0.1);  // up the wall
    is_at(10.0, -7.2, 6.0);
    go({13.0, -7.2, -3.0}, 0.7);  // and down again
    is_at(10.0, -7.2, 0.0);
    go({4.0, -7.2, -3.0}, 0.3);  // back along the floor
    is_at(4.0, -7.2, 0.0);
    go({4.0, -7.2, 3.0}, 0.3);
    EXPECT_FALSE(found.contact);
    is_at(4.0, -7.2, 3.0);
  }
}

TEST(Around, NothingIsOverAPlaceThatAMeasuredSheetSaysIsOutside) {
  // Below a floor at z = 0, before a wall at x = 10 mm that faces -x.
  scene::Charts charts;
  charts.spacing_m = 1e-3;
  charts.sheets.push_back(level_sheet(scene::Side::front, -30, -30, 41, 61, 0.0));
  charts.sheets.push_back(level_sheet(scene::Side::left, -30, -30, 61, 61, -10.0));
  const auto object = haptics::make_object_surface(charts);
  for (const double before : {2.0, 4.0, 4.4}) {
    const Vector3d place = 1e-3 * Vector3d(10.0 - before, 0.3, -3.0);
    EXPECT_EQ(haptics::held_at(*object, haptics::kNoSheet, place), haptics::Held::outside) << before;
    EXPECT_FALSE(haptics::surface_over(*object, place)) << before;
  }
}

TEST(Around, AHandThatIsNoNumberChangesNothing) {
  const Touched on = touched("torus", make_torus());
  AroundState state;
  const Vector3d above(1.0, 0.0, 0.5);
  const Vector3d within = above - Vector3d(0.0, 0.0, 0.25);
  (void)update_around(*on.surface, above, state, {});
  (void)update_around(*on.surface, within, state, {});
  const AroundUpdate before = update_around(*on.surface, within, state, {});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Vector3d& bad : {Vector3d(nan, 0.0, 0.0), Vector3d(0.0, 0.0, std::numeric_limits<double>::infinity())})
    EXPECT_FALSE(update_around(*on.surface, bad, state, {}).contact);
  const AroundUpdate after = update_around(*on.surface, within, state, {});
  EXPECT_EQ(before.position_m, after.position_m);
  EXPECT_EQ(before.contact, after.contact);
}

}  // namespace
}  // namespace sparsha::test
