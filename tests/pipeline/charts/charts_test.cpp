// Charts of whole objects whose surface is known: all of it, on the right side, and nothing that is not there. Spacings
// are mean point spacings.
#include "pipeline/charts/charts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <random>
#include <string>

#include "base/error.h"
#include "pipeline/charts/sided_discs.h"
#include "tests/support/clouds.h"
#include "tests/support/whole_surface.h"

namespace sparsha::test {
namespace {

constexpr std::size_t kFew = 20'000, kMany = 100'000;

ScanOptions cloud_of(std::size_t points, double noise = 0.1) {
  ScanOptions options;
  options.points = points;
  options.noise_spacings = noise;
  options.seed = 11;
  return options;
}

pipeline::ChartResult charts_of(const Points& points, double spacing_m, unsigned threads = 2) {
  ThreadPool pool(threads);
  Progress progress;
  scene::GridConfig grid;
  grid.spacing_m = spacing_m;
  return pipeline::make_charts(make_cloud(points), Eigen::Matrix4d::Identity(), grid, 0.0, {pool, progress});
}

/// Exact points, several of them per point of the scan.
WholeSurface truth_of(const ClosedObject& object, const ObjectScan& scan) {
  return WholeSurface(object, 15 * scan.points.size(), scan.spacing_m);
}

void expect_whole(const NamedObject& named, const ScanOptions& options) {
  const ObjectScan scan = scan_object(*named.object, options);
  const pipeline::ChartResult result = charts_of(scan.points, scan.spacing_m);
  const ChartJudgement found = judge_charts(result.charts, truth_of(*named.object, scan), scan.spacing_m, 8'000);
  EXPECT_GT(found.reachable, 2'000U) << named.name;
  EXPECT_GE(found.covered, options.points < kMany ? 0.98 : 0.995) << named.name;
  EXPECT_LE(found.wrong, 0.0005) << named.name;
  EXPECT_LE(found.turned, 0.0005) << named.name;
  EXPECT_LE(found.median, 0.06) << named.name;
}

/// A plate of so many spacings between 2 m wide faces.
NamedObject plate(double spacings, std::size_t points, const Eigen::Matrix3d& view) {
  const double spacing = std::sqrt(8.0 / static_cast<double>(points));  // edges hardly count
  return {"plate of " + std::to_string(spacings), make_box({1.0, 1.0, 0.5 * spacings * spacing}, view)};
}

TEST(WholeObjects, HaveAllTheirSurfaceOnItsOuterSide) {
  const Eigen::Matrix3d straight = Eigen::Matrix3d::Identity();
  const std::vector<NamedObject> objects{{"torus", make_torus()},
                                         {"two spheres", make_two_spheres()},
                                         {"vase", make_vase(turned(48.0, 0.0))},
                                         {"knot", make_knot()},
                                         {"coin", make_coin()},
                                         {"cube", make_box({0.6, 0.6, 0.6}, straight)},
                                         {"cube on a corner", make_box({0.6, 0.6, 0.6}, turned(35.3, 45.0))},
                                         plate(5.0, kFew, straight),
                                         plate(5.0, kFew, turned(30.0, 20.0)),
                                         plate(3.5, kFew, turned(30.0, 20.0))};
  for (const NamedObject& named : objects) expect_whole(named, cloud_of(kFew));
}

TEST(WholeObjects, HaveThemUnderHardlyAnyNoiseAndMuch) {
  expect_whole({"cube without noise", make_box({0.6, 0.6, 0.6}, Eigen::Matrix3d::Identity())}, cloud_of(kFew, 0.0));
  const NamedObject vase{"vase", make_vase(turned(48.0, 0.0))};
  const ObjectScan scan = scan_object(*vase.object, cloud_of(kFew, 0.4));
  const ChartJudgement found =
      judge_charts(charts_of(scan.points, scan.spacing_m).charts, truth_of(*vase.object, scan), scan.spacing_m, 8'000);
  EXPECT_GE(found.covered, 0.98);
  EXPECT_LE(found.wrong, 0.0005);
  EXPECT_LE(found.turned, 0.0005);
  EXPECT_LE(found.median, 0.5 * 0.4);
}

TEST(WholeObjects, WhoseFootWasNotScannedKeepTheirOuterSide) {
  // The larger ball without its lowest fifth: its inside is seen from below.
  const ObjectScan scan = scan_object(*make_two_spheres(), cloud_of(kFew));
  Points open;
  const Eigen::Vector3d centre(0.0, 0.0, -0.6);
  for (const auto& p : scan.points) {
    const Eigen::Vector3d q(p[0], p[1], p[2]);
    if ((q - centre).norm() < 1.1 && q.y() > -0.6) open.push_back(p);
  }
  const pipeline::ChartResult result = charts_of(open, scan.spacing_m);
  std::size_t nodes = 0, inwards = 0;
  for (const scene::Sheet& sheet : result.charts.sheets) {
    for (int j = 0; j < sheet.ny; ++j) {
      for (int i = 0; i < sheet.nx; ++i) {
        if (!sheet.measured(sheet.index(i, j))) continue;
        const Eigen::Vector3d from_centre = result.charts.place_m(sheet, i, j) + result.charts.origin_m - centre;
        ++nodes;
        inwards += scene::Charts::normal(sheet, i, j).dot(from_centre) < 0.0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(nodes, open.size());
  EXPECT_EQ(inwards, 0U);
}

/// Exact points of a prism about the z axis whose base is a star, thinner towards its top; metres. Tips and notches lie
/// at the two radii in turn.
Points star_prism(int tips, double tip_m, double notch_m, double height_m, std::size_t count, std::uint64_t seed) {
  std::vector<Eigen::Vector2d> corner;
  for (int k = 0; k < 2 * tips; ++k) {
    const double turn = std::numbers::pi * k / tips;
    corner.push_back((k % 2 == 0 ? tip_m : notch_m) * Eigen::Vector2d(std::cos(turn), std::sin(turn)));
  }
  const double side_m2 = (corner[1] - corner[0]).norm() * height_m;
  const double cap_m2 = 0.5 * std::abs(corner[0].x() * corner[1].y());  // a triangle of one cap: corner[0] is on x
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Points points;
  while (points.size() < count) {
    const auto k = static_cast<std::size_t>(unit(random) * 2.0 * tips);
    const Eigen::Vector2d& from = corner[k];
    const Eigen::Vector2d& to = corner[(k + 1) % corner.size()];
    Eigen::Vector2d base = from + unit(random) * (to - from);
    double z = unit(random) * height_m;
    if (unit(random) * (side_m2 + 2.0 * cap_m2) > side_m2) {
      base *= std::sqrt(unit(random));
      z = unit(random) < 0.5 ? 0.0 : height_m;
    }
    if (unit(random) < std::pow(3.0, -z / height_m)) points.push_back({base.x(), base.y(), z});
  }
  return points;
}

TEST(WholeObjects, WithAcuteEdgesHaveNoFaceTurnedInwards) {
  ThreadPool pool(2);
  Progress progress;
  struct Star {
    int tips;
    double tip_m, notch_m, height_m;
  };
  for (const Star& star : {Star{5, 0.020, 0.009, 0.012}, Star{4, 0.020, 0.008, 0.015}}) {
    const double half_m = 0.5 * star.height_m;  // from the middle to the plane of the nearest face
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
      const Points points = star_prism(star.tips, star.tip_m, star.notch_m, star.height_m, kFew, seed);
      const pipeline::SidedDiscs found =
          pipeline::find_sided_discs(make_cloud(points), Eigen::Matrix4d::Identity(), {pool, progress});
      // The middle sees every face from within.
      const Eigen::Vector3d middle = Eigen::Vector3d(0.0, 0.0, half_m) - found.origin_m;
      std::size_t inwards = 0;
      for (std::size_t d = 0; d < found.count; ++d) {
        const Eigen::Vector3d foot = Eigen::Vector3f(found.discs[d].foot.data()).cast<double>();
        const Eigen::Vector3d normal = Eigen::Vector3f(found.discs[d].normal.data()).cast<double>();
        inwards += normal.dot(foot - middle) < -0.5 * half_m ? 1 : 0;
      }
      EXPECT_GT(found.count, points.size() * 9 / 10) << star.tips << " tips, seed " << seed;
      // A face has a twentieth of the discs or more; those at the very tips may be undecided.
      EXPECT_LT(static_cast<double>(inwards), 0.003 * static_cast<double>(found.count))
          << star.tips << " tips, seed " << seed;
    }
  }
}

/// Two balls of 40 mm radius, 0.2 mm apart, that rest on a plinth of 180 x 100 x 20 mm, sunk into it. Frame: z up, 0 at
/// the balls' middles. Uniform on what is seen from outside, noise across it.
class BallsOnPlinth {
 public:
  explicit BallsOnPlinth(double sunk_m) : top_m_(sunk_m - kRadius_m) {}

  [[nodiscard]] Points points(std::size_t count, std::uint64_t seed, double noise_m) const {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::normal_distribution<double> normal;
    const double ball_m2 = 4.0 * std::numbers::pi * kRadius_m * kRadius_m;
    const std::array<double, 3> face_m2 = {4.0 * kHalf_m[1] * kHalf_m[2], 4.0 * kHalf_m[0] * kHalf_m[2],
                                           4.0 * kHalf_m[0] * kHalf_m[1]};
    const double all_m2 = 2.0 * (ball_m2 + face_m2[0] + face_m2[1] + face_m2[2]);
    Points points;
    while (points.size() < count) {
      Eigen::Vector3d p, out;
      double left_m2 = unit(random) * all_m2;
      if (left_m2 < 2.0 * ball_m2) {
        out = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
        p = kRadius_m * out + Eigen::Vector3d(left_m2 < ball_m2 ? -kApart_m : kApart_m, 0.0, 0.0);
        if (std::abs(p.x()) < kHalf_m[0] && std::abs(p.y()) < kHalf_m[1] && p.z() < top_m_) continue;
      } else {
        left_m2 -= 2.0 * ball_m2;
        int axis = 0;
        while (axis < 2 && left_m2 > 2.0 * face_m2[static_cast<std::size_t>(axis)])
          left_m2 -= 2.0 * face_m2[static_cast<std::size_t>(axis++)];
        for (int k = 0; k < 3; ++k) p[k] = kHalf_m[static_cast<std::size_t>(k)] * (2.0 * unit(random) - 1.0);
        out = Eigen::Vector3d::Unit(axis) * (unit(random) < 0.5 ? -1.0 : 1.0);
        p[axis] = kHalf_m[static_cast<std::size_t>(axis)] * out[axis];
        p.z() += top_m_ - kHalf_m[2];
        if (distance_to_balls(p) < 0.0) continue;
      }
      p += noise_m * normal(random) * out;
      points.push_back({p.x(), p.y(), p.z()});
    }
    return points;
  }
  /// To the surface, negative within.
  [[nodiscard]] double distance(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d half(kHalf_m.data());
    const Eigen::Vector3d beyond = (p - Eigen::Vector3d(0.0, 0.0, top_m_ - kHalf_m[2])).cwiseAbs() - half;
    return std::min(distance_to_balls(p), beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0));
  }

 private:
  static constexpr double kRadius_m = 0.040, kApart_m = 0.0401;
  static constexpr std::array<double, 3> kHalf_m = {0.090, 0.050, 0.010};

  [[nodiscard]] static double distance_to_balls(const Eigen::Vector3d& p) {
    return Eigen::Vector3d(std::abs(p.x()) - kApart_m, p.y(), p.z()).norm() - kRadius_m;
  }

  double top_m_;
};

TEST(WholeObjects, ThatTouchEachOtherAndWhatTheyStandOnHaveNoneOfThemTurnedInwards) {
  ThreadPool pool(2);
  Progress progress;
  for (const double sunk_m : {0.0, 0.003}) {
    const BallsOnPlinth object(sunk_m);
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const Points points = object.points(kFew, seed, 0.0002);
      const pipeline::SidedDiscs found =
          pipeline::find_sided_discs(make_cloud(points), Eigen::Matrix4d::Identity(), {pool, progress});
      std::size_t inwards = 0;
      for (std::size_t d = 0; d < found.count; ++d) {
        const Eigen::Vector3d foot = Eigen::Vector3f(found.discs[d].foot.data()).cast<double>() + found.origin_m;
        const Eigen::Vector3d step = 0.001 * Eigen::Vector3f(found.discs[d].normal.data()).cast<double>();
        inwards += object.distance(foot + step) < object.distance(foot - step) - 0.001 ? 1 : 0;
      }
      EXPECT_GT(found.count, points.size() * 9 / 10) << sunk_m << " m, seed " << seed;
      // A ball has a quarter of the discs; beside the contacts some may be wrong.
      EXPECT_LT(static_cast<double>(inwards), 0.004 * static_cast<double>(found.count))
          << sunk_m << " m, seed " << seed;
    }
  }
}

TEST(WholeObjects, OfWhichNothingIsLeftOnCoarseNodesAreAnErrorThatNamesTheSpacing) {
  const NamedObject named = plate(5.0, kFew, turned(30.0, 20.0));
  const ObjectScan scan = scan_object(*named.object, cloud_of(kFew));
  try {
    (void)charts_of(scan.points, 100.0 * scan.spacing_m);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_NE(error.expected().find("grid.spacing_mm of about"), std::string::npos) << error.what();
  }
}

TEST(WholeObjects, ThatAreWallsOfTwoSpacingsAreUndecided) {
  const NamedObject named = plate(2.0, kFew, turned(30.0, 20.0));
  const ObjectScan scan = scan_object(*named.object, cloud_of(kFew));
  try {
    (void)charts_of(scan.points, scan.spacing_m);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find("undecided"), std::string::npos) << error.what();
  }
}

TEST(WholeObjects, AreCalledThinOnlyWhereSeveralPointsSaySo) {
  constexpr double kWarned = 0.001;
  const auto agreed_of = [](const NamedObject& named, std::size_t points) {
    const ObjectScan scan = scan_object(*named.object, cloud_of(points));
    const pipeline::ChartResult found = charts_of(scan.points, scan.spacing_m);
    EXPECT_LE(found.discs_thin_agreed, found.discs_thin) << named.name;
    return static_cast<double>(found.discs_thin_agreed) / static_cast<double>(found.discs);
  };
  EXPECT_GT(agreed_of(plate(2.5, kFew, turned(30.0, 20.0)), kFew), 10.0 * kWarned);
  EXPECT_LT(agreed_of(plate(3.5, kFew, turned(30.0, 20.0)), kFew), 0.1 * kWarned);
  // Of so many points, a thousandth has one disc opposite by noise alone.
  EXPECT_LT(agreed_of({"torus", make_torus()}, 1'000'000), 0.5 * kWarned);
}

TEST(WholeObjects, NeedASurfaceWithAnOuterSide) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal;
  Points sheet, line, few{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
  for (int k = 0; k < 10'000; ++k) {
    sheet.push_back({unit(random), unit(random), 0.001 * normal(random)});
    line.push_back({unit(random), 0.0, 0.0});
  }
  EXPECT_THROW((void)charts_of(sheet, 0.01), Error);
  EXPECT_THROW((void)charts_of(line, 0.01), Error);
  EXPECT_THROW((void)charts_of(few, 0.01), Error);
  EXPECT_THROW((void)charts_of({}, 0.01), Error);
}

bool same_bytes(const scene::Charts& a, const scene::Charts& b) {
  if (a.spacing_m != b.spacing_m || a.origin_m != b.origin_m || a.sheets.size() != b.sheets.size()) return false;
  const auto same = [](const std::vector<float>& x, const std::vector<float>& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(float)) == 0;
  };
  for (std::size_t s = 0; s < a.sheets.size(); ++s) {
    const scene::Sheet& x = a.sheets[s];
    const scene::Sheet& y = b.sheets[s];
    if (x.side != y.side || x.first_u != y.first_u || x.first_v != y.first_v || x.nx != y.nx || x.mask != y.mask ||
        !same(x.height_m, y.height_m) || !same(x.slope_u, y.slope_u) || !same(x.slope_v, y.slope_v)) {
      return false;
    }
  }
  return true;
}

TEST(WholeObjects, AreTheSameForAnyNumberOfThreadsAndAnyOrderOfPoints) {
  const ObjectScan scan = scan_object(*make_knot(), cloud_of(kFew));
  const pipeline::ChartResult one = charts_of(scan.points, scan.spacing_m, 1);
  EXPECT_TRUE(same_bytes(one.charts, charts_of(scan.points, scan.spacing_m, 3).charts));
  Points shuffled = scan.points;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937_64(3));
  EXPECT_TRUE(same_bytes(one.charts, charts_of(shuffled, scan.spacing_m, 2).charts));
}

TEST(WholeObjects, HaveSheetsThatKeepTheRules) {
  const ObjectScan scan = scan_object(*make_vase(turned(48.0, 0.0)), cloud_of(kFew));
  const pipeline::ChartResult result = charts_of(scan.points, scan.spacing_m);
  const pipeline::ChartRule rule;
  std::uint64_t nodes = 0;
  std::size_t cells = 0;
  for (const scene::Sheet& sheet : result.charts.sheets) {
    const scene::SideAxes axes = scene::SideAxes::of(sheet.side);
    std::size_t mine = 0;
    for (int j = 0; j < sheet.ny; ++j) {
      for (int i = 0; i < sheet.nx; ++i) {
        const std::size_t node = sheet.index(i, j);
        EXPECT_EQ(sheet.measured(node), std::isfinite(sheet.height_m[node]));
        if (sheet.measured(node)) {
          ++mine;
          EXPECT_GE(axes.to_chart(scene::Charts::normal(sheet, i, j)).z(), rule.least_facing - 1e-6);
        }
        if ((sheet.mask[node] & scene::Sheet::kCell) == 0) continue;
        ++cells;
        ASSERT_LT(i + 1, sheet.nx);
        ASSERT_LT(j + 1, sheet.ny);
        EXPECT_TRUE(sheet.measured(node) && sheet.measured(node + 1) && sheet.measured(sheet.index(i, j + 1)) &&
                    sheet.measured(sheet.index(i + 1, j + 1)));
      }
    }
    EXPECT_GE(mine, rule.least_nodes);
    nodes += mine;
  }
  EXPECT_EQ(nodes + result.small_sheet_nodes, result.layers);
  EXPECT_GT(cells, nodes * 9 / 10);
}

TEST(RealScanWholeObjects, HaveAllTheirSurfaceOnItsOuterSide) {
  const char* folder = std::getenv("SPARSHA_SCANS_DIR");
  const std::vector<NamedObject> objects = mesh_objects(folder == nullptr ? "" : folder);
  if (objects.empty()) GTEST_SKIP() << "SPARSHA_SCANS_DIR has no meshes";
  for (const NamedObject& named : objects) {
    expect_whole(named, cloud_of(kFew));
    if (std::getenv("SPARSHA_NIGHTLY") != nullptr) expect_whole(named, cloud_of(kMany));
  }
}

}  // namespace
}  // namespace sparsha::test
