// Maps beside depth steps, holes and borders: what one surface shows does not depend on what lies behind it, and no map
// has an edge where its window begins to meet a step.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tests/viewer/relief_scene.h"
#include "viewer/surface/colour_maps.h"
#include "viewer/surface/height_light.h"
#include "viewer/surface/layer_blur.h"
#include "viewer/surface/paint.h"
#include "viewer/surface/relief_data.h"

namespace sparsha::viewer::test {
namespace {

constexpr int kSide = 160;
constexpr double kSpacing_m = 0.001;
constexpr int kRadius = 4;               // of the local relief's means: a fortieth of the side
constexpr int kReach = 2 * kRadius + 1;  // of two means, and of a difference between neighbours
constexpr double kStep_m = 0.04;

using Side = std::function<bool(double, double)>;

double waves(double x_m, double y_m) {
  const double k = 2 * std::numbers::pi / 0.03;
  return 0.4 * x_m - 0.2 * y_m + 0.001 * std::sin(k * x_m + 0.3) * std::sin(k * y_m + 0.7);
}

std::vector<std::pair<std::string, Side>> outlines() {
  return {{"along y", [](double x, double) { return x > 0.0803; }},
          {"oblique", [](double x, double y) { return x + 0.6 * y > 0.13; }},
          {"round", [](double x, double y) { return std::hypot(x - 0.08, y - 0.08) < 0.0404; }},
          {"corner", [](double x, double y) { return x > 0.0805 && y > 0.0805; }}};
}

bool on(const Side& raised, int i, int j) { return raised(i * kSpacing_m, j * kSpacing_m); }

/// Of each node: rows or columns, whichever are more, to the nearest node of the other side; at most kFar.
constexpr int kFar = kReach + 2;
std::vector<int> to_the_other_side(const Side& raised) {
  std::vector<int> nearest(kSide * kSide, kFar);
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i)
      for (int b = -kFar; b <= kFar; ++b)
        for (int a = -kFar; a <= kFar; ++a) {
          if (on(raised, i + a, j + b) == on(raised, i, j)) continue;
          int& own = nearest[static_cast<std::size_t>(j * kSide + i)];
          own = std::min(own, std::max(std::abs(a), std::abs(b)));
        }
  return nearest;
}

ReliefData relief_of(const std::function<double(double, double)>& height_m, int nx = kSide, int ny = kSide) {
  const auto scene = scene_of(height_m, {nx, ny, kSpacing_m, 1});
  ThreadPool pool(2);
  return prepare_relief(scene->read_level(0), 0, false, 0.0, pool);
}

/// Values that a map's colours stand for, of the range of `legend`.
std::vector<double> values_of(const ReliefData& relief, ColourMode mode, const Legend& legend) {
  constexpr int kSteps = 1024;
  std::map<std::array<std::uint8_t, 3>, double> value;
  for (int s = 0; s < kSteps; ++s) {
    const double share = static_cast<double>(s) / (kSteps - 1);
    value.emplace(colour_of(legend.map, share), legend.low + share * (legend.high - legend.low));
  }
  const auto scene = scene_of([](double, double) { return 0.0; }, {2, 2, kSpacing_m, 1});
  const Paint paint = paint_relief(relief, scene->description(), mode, 0.1, &legend);
  std::vector<double> values;
  for (std::size_t k = 0; k < relief.lattice.count(); ++k) {
    const auto found = value.find({paint.rgba[4 * k], paint.rgba[4 * k + 1], paint.rgba[4 * k + 2]});
    values.push_back(found == value.end() ? std::numeric_limits<double>::quiet_NaN() : found->second);
  }
  return values;
}

/// Greatest change from node to node of one side: far from the other, and where the window begins to meet it.
struct Changes {
  double open = 0.0, border = 0.0;
  int counted = 0;
};

Changes changes(const std::vector<double>& values, const Side& raised, const std::vector<int>& to_side, int reach) {
  Changes result;
  for (int j = 16; j < kSide - 16; ++j)
    for (int i = 16; i < kSide - 17; ++i) {
      if (on(raised, i, j) != on(raised, i + 1, j)) continue;
      const auto n = static_cast<std::size_t>(j * kSide + i);
      const int nearest = std::min(to_side[n], to_side[n + 1]);
      const double change = std::abs(values[n + 1] - values[n]);
      if (nearest > reach + 1) result.open = std::max(result.open, change);
      if (nearest < reach - 1 || nearest > reach + 1) continue;
      result.border = std::max(result.border, change);
      ++result.counted;
    }
  return result;
}

struct Map {
  ColourMode mode;
  Legend legend;
  int reach;
};

std::vector<Map> maps() {
  const auto legend = [](double low, double high) {
    Legend own;
    own.map = low < 0.0 ? ColourMap::diverging : ColourMap::sequential;
    own.low = low;
    own.high = high;
    return own;
  };
  return {{ColourMode::local_relief, legend(-1.0, 1.0), kReach},
          {ColourMode::curvature, legend(-100.0, 100.0), 2 * 2 + 2},
          {ColourMode::slope, legend(0.0, 60.0), 2}};
}

TEST(MapEdges, NoMapHasOneWhereItsWindowMeetsAStepOrAHole) {
  for (const auto& [name, raised] : outlines()) {
    const std::vector<int> to_side = to_the_other_side(raised);
    for (const bool hole : {false, true}) {
      const ReliefData relief = relief_of([hole, &side = raised](double x, double y) {
        if (!side(x, y)) return waves(x, y);
        return hole ? std::numeric_limits<double>::quiet_NaN() : waves(x, y) + kStep_m;
      });
      for (const Map& map : maps()) {
        const Changes found = changes(values_of(relief, map.mode, map.legend), raised, to_side, map.reach);
        EXPECT_GT(found.counted, 100) << name;
        EXPECT_GT(found.open, 0.0) << name;
        EXPECT_LE(found.border, 1.3 * found.open)
            << name_of(map.mode) << ", " << name << (hole ? ", a hole" : ", a step");
      }
      if (hole) continue;
      // The means that know no surfaces have one.
      const std::vector<float> form_m = blur({kSide, kSide, relief.height_m}, kRadius);
      std::vector<double> across;
      for (std::size_t k = 0; k < form_m.size(); ++k)
        across.push_back(1e3 * static_cast<double>(relief.height_m[k] - form_m[k]));
      const Changes fault = changes(across, raised, to_side, kReach - 2);
      EXPECT_GT(fault.border, 3.0 * fault.open) << name;
    }
  }
}

TEST(MapEdges, BesideAStepMapsShowWhatTheSurfaceShowsWithoutIt) {
  const ReliefData unbroken = relief_of(waves);
  for (const auto& [name, raised] : outlines()) {
    const std::vector<int> to_side = to_the_other_side(raised);
    const ReliefData broken =
        relief_of([&side = raised](double x, double y) { return waves(x, y) + (side(x, y) ? kStep_m : 0.0); });
    for (const Map& map : maps()) {
      const std::vector<double> wanted = values_of(unbroken, map.mode, map.legend);
      const std::vector<double> found = values_of(broken, map.mode, map.legend);
      double wrong = 0.0, shown = 0.0;
      for (int j = 16; j < kSide - 16; ++j)
        for (int i = 16; i < kSide - 16; ++i) {
          const std::size_t n = static_cast<std::size_t>(j) * kSide + static_cast<std::size_t>(i);
          ASSERT_TRUE(std::isfinite(found[n])) << name_of(map.mode) << ' ' << i << ' ' << j;
          if (to_side[n] > map.reach) {
            EXPECT_NEAR(found[n], wanted[n], 2e-3 * (map.legend.high - map.legend.low)) << name_of(map.mode);
            continue;
          }
          wrong += (found[n] - wanted[n]) * (found[n] - wanted[n]);
          shown += wanted[n] * wanted[n];
        }
      EXPECT_LE(std::sqrt(wrong), 0.4 * std::sqrt(shown)) << name_of(map.mode) << ", " << name;
    }
  }
}

TEST(MapEdges, APlaneHasNeitherReliefNorCurvatureAtItsBorders) {
  const ReliefData relief = relief_of([](double x, double y) { return x > 0.05 ? -0.5 * x : 0.8 * x - 0.6 * y + 0.2; });
  const std::vector<float> form_m = blur_on_layers(relief, kRadius);
  const std::vector<double> bend_m = laplacian_on_layers(relief, 2);
  // Heights of 0.3 m as float32 are rounded by 15 nm, and second differences add eight of them.
  for (std::size_t k = 0; k < form_m.size(); ++k) {
    EXPECT_NEAR(form_m[k], relief.height_m[k], 1e-7F);
    EXPECT_NEAR(bend_m[k], 0.0, 3e-7);
  }
}

/// Mean change between nodes of different blocks of the sky's light, over that between nodes of one.
double across_blocks(const std::vector<double>& values, int nx, int ny, int block) {
  std::array<double, 2> sum{};
  std::array<int, 2> count{};
  for (int j = 2 * block; j < ny - 2 * block; ++j)
    for (int i = 2 * block; i < nx - 2 * block; ++i) {
      const std::size_t n = static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
      const std::size_t kind = (i + 1) % block == 0 ? 1 : 0;
      sum[kind] += std::abs(values[n + 1] - values[n]);
      ++count[kind];
    }
  return sum[1] / count[1] / (sum[0] / count[0]);
}

TEST(MapEdges, TheSkysLightHasNoBlocksWhereItIsFoundOnACoarserLattice) {
  constexpr int kNx = 1290, kNy = 60, kBlock = 3;  // of at most 640 blocks along the longer side
  const ReliefData relief = relief_of([](double x, double y) { return 5 * waves(x, y); }, kNx, kNy);
  std::vector<double> sky, blocks;
  for (int j = 0; j < kNy; ++j)
    for (int i = 0; i < kNx; ++i) {
      sky.push_back(relief.tone[4 * relief.lattice.index(i, j)]);
      blocks.push_back(relief.tone[4 * relief.lattice.index(i / kBlock * kBlock + 1, j)]);
    }
  EXPECT_NEAR(across_blocks(sky, kNx, kNy, kBlock), 1.0, 0.2);
  EXPECT_GT(across_blocks(blocks, kNx, kNy, kBlock), 10.0) << "the blocks that there would be";
}

}  // namespace
}  // namespace sparsha::viewer::test
