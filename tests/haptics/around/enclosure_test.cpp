// What all nodes together say of a place, and a free hand that comes in by where no face was met. Lengths are in mean
// point spacings, h, which are metres here.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/files/files.h"
#include "base/threads/progress.h"
#include "base/threads/thread_pool.h"
#include "base/yaml/yaml.h"
#include "haptics/around/object_surface.h"
#include "haptics/around/unseen_entry.h"
#include "pipeline/charts/charts.h"
#include "pipeline/scan/reader.h"
#include "scene/config/config.h"
#include "tests/support/faceted.h"
#include "tests/support/raster_scan.h"
#include "tests/support/test_folder.h"
#include "tests/support/wandering_hand.h"

namespace sparsha::test {
namespace {

using Eigen::Vector3d;

/// A block on a slab, and its foot and top corner.
FacetedPtr block_on_slab() {
  return make_two_boxes({{-20.0, -20.0, -8.0}, {20.0, 20.0, 0.0}}, {{-8.0, -8.0, -5.0}, {8.0, 8.0, 12.0}},
                        turned(20.0, 30.0));
}
const std::vector<Vector3d> kCorners{{8.0, 8.0, 0.0}, {8.0, 8.0, 12.0}, {8.0, 0.0, 0.0}};

Touched touched_block(const FacetedPtr& block) {
  return touched("block", block, static_cast<std::size_t>(block->area_m2()));
}

/// A place of the block's own frame in the object frame.
Vector3d object_place(const Faceted& block, const Touched& on, const Vector3d& place) {
  return block.view() * place - on.surface->origin_m;
}

TEST(Enclosure, IsRightASpacingFromEdgesAndCorners) {
  const FacetedPtr block = block_on_slab();
  const Touched on = touched_block(block);
  EXPECT_FALSE(on.surface->enclosure->is_room());
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> about(-4.0, 4.0);
  std::size_t within = 0, outside = 0, wrong = 0;
  for (int k = 0; k < 6000; ++k) {
    const Vector3d off(about(random), about(random), about(random));
    const Vector3d place = block->view() * (kCorners[static_cast<std::size_t>(k) % kCorners.size()] + on.h * off);
    const double deep = -block->distance_m(place) / on.h;
    if (std::abs(deep) < 1.0) continue;
    (deep > 0.0 ? within : outside) += 1;
    wrong += on.surface->enclosure->holds(place - on.surface->origin_m) == (deep > 0.0) ? 0 : 1;
  }
  EXPECT_GT(within, 1000U);
  EXPECT_GT(outside, 1000U);
  EXPECT_LE(wrong, (within + outside) / 1000);
}

TEST(Enclosure, AHandThatWasOutsideIsGivenTheFaceThatItHasComeBehind) {
  const FacetedPtr block = block_on_slab();
  const Touched on = touched_block(block);
  const auto at = [&](double x, double y, double z) { return object_place(*block, on, {x, y, z}); };
  haptics::FreeHand free;
  EXPECT_FALSE(entered_unseen(*on.surface, at(0.0, 9.0, 6.0), free));
  EXPECT_TRUE(free.outside);
  const auto face = entered_unseen(*on.surface, at(0.0, 7.1, 6.0), free);  // 0.9 behind the wall at y = 8
  ASSERT_TRUE(face.has_value());
  const Vector3d place = on.surface->sheets[face->sheet].to_object(face->local_m);
  EXPECT_LT((place - at(0.0, 8.0, 6.0)).norm(), 0.5);
}

TEST(Enclosure, AHandThatWasLetGoWithinOrHasComeDeepIsLeftAlone) {
  const FacetedPtr block = block_on_slab();
  const Touched on = touched_block(block);
  const auto at = [&](double x, double y, double z) { return object_place(*block, on, {x, y, z}); };
  haptics::FreeHand never;
  for (const double y : {5.0, 6.0, 7.1}) EXPECT_FALSE(entered_unseen(*on.surface, at(0.0, y, 6.0), never)) << y;
  haptics::FreeHand deep;
  EXPECT_FALSE(entered_unseen(*on.surface, at(0.0, 8.5, 6.0), deep));
  EXPECT_FALSE(entered_unseen(*on.surface, at(0.0, 6.0, 6.0), deep));  // two spacings behind
  EXPECT_FALSE(entered_unseen(*on.surface, at(0.0, 4.0, 6.0), deep));
  EXPECT_FALSE(deep.outside);
  EXPECT_FALSE(entered_unseen(*on.surface, at(0.0, 7.1, 6.0), deep)) << "from within it comes behind no face";
}

TEST(Enclosure, IsAskedOnceForHalfASpacing) {
  const FacetedPtr block = block_on_slab();
  const Touched on = touched_block(block);
  const auto at = [&](double y) { return Vector3d(block->view() * Vector3d(0.0, y, 6.0) - on.surface->origin_m); };
  haptics::FreeHand free;
  EXPECT_FALSE(entered_unseen(*on.surface, at(8.2), free));
  EXPECT_FALSE(entered_unseen(*on.surface, at(7.8), free)) << "0.4 further, it is not looked at again";
  EXPECT_EQ((free.asked_m - at(8.2)).norm(), 0.0);
  EXPECT_TRUE(entered_unseen(*on.surface, at(7.2), free));
}

scene::Charts charts_of(const std::vector<RasterScan>& scans) {
  const TestFolder folder;
  write_file(folder / "scan.ptx", ptx_of(scans));
  const scene::Config config =
      scene::parse_config(yaml::parse_text("scans: [{file: scan.ptx, units: m}]\n", "scan"), folder.path());
  Progress progress;
  ThreadPool pool(2);
  return pipeline::make_charts(pipeline::load_scans(config.scans, progress), Eigen::Matrix4d::Identity(), config.grid,
                               0.0, {pool, progress})
      .charts;
}

TEST(Enclosure, OfARoomFromWithinIsWhatLiesBehindItsWalls) {
  std::vector<RasterScan> scans;
  for (const Vector3d& place : {Vector3d(-2.5, 0.3, 0.0), Vector3d(0.0, -0.5, 0.1), Vector3d(2.6, 0.2, 0.0)})
    scans.push_back(scan_from(place, free_in_cave, 0.015));
  const scene::Charts charts = charts_of(scans);
  const auto surface = haptics::make_object_surface(charts);
  EXPECT_TRUE(surface->enclosure->is_room());
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::size_t asked = 0, wrong = 0;
  for (int k = 0; k < 4000; ++k) {
    const Vector3d place = Vector3d(5.5 * unit(random), 3.5 * unit(random), 0.5 + 2.5 * unit(random));
    const double free_m = free_in_cave(place);
    if (std::abs(free_m) < 0.1 || free_m < -1.0) continue;
    ++asked;
    wrong += surface->enclosure->holds(place - surface->origin_m) == (free_m < 0.0) ? 0 : 1;
  }
  EXPECT_GT(asked, 1500U);
  EXPECT_LE(wrong, asked / 200);
}

}  // namespace
}  // namespace sparsha::test
