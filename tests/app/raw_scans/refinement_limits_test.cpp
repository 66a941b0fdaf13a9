// Refinement of files that lack colours, become shorter, hold empty returns, or must rest.
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/raw_scans/depth_scans.h"
#include "base/files/files.h"
#include "base/system.h"
#include "tests/app/raw_scans/refined.h"

namespace sparsha::app::testing {
namespace {

viewer::SplatView of_everything(const viewer::PointView& points) {
  return around(Eigen::Vector3d::Constant(8.0), 16.0, points);
}

TEST(Refinement, FinerPointsWithoutColourAreGreyAsTheCoarseOnesBesideAColouredScan) {
  const Written written;
  scene::ScanConfig coloured;
  coloured.file = written.folder / "b.xyz";
  coloured.units.unit = scene::LengthUnit::m;
  write_file(coloured.file, "1 1 1 255 0 0\n2 1 1 255 0 0\n1 2 1 255 0 0\n2 2 2 255 0 0\n");
  Opened opened(std::vector{coloured, written.scan}, 600, 1'000'000);
  ASSERT_EQ(opened.coarse->points.size(), 304U) << "the root and the other scan";
  EXPECT_EQ(std::ranges::count(opened.coarse->rgba, kUncoloured), 300);
  opened.refinement->look({of_everything(*opened.coarse), {}});
  finish(*opened.refinement);
  const auto detail = opened.refinement->detail();
  ASSERT_EQ(detail->parts.size(), 24U);
  for (const auto& part : detail->parts) {
    EXPECT_EQ(part->rgba, std::vector<std::uint32_t>(part->points.size(), kUncoloured));
    EXPECT_EQ(part->intensity.size(), opened.coarse->intensity.empty() ? 0 : part->points.size());
    EXPECT_EQ(part->station.size(), part->points.size());
  }
}

TEST(Refinement, AFileThatBecomesShorterIsSaidOnceAndReadNoMore) {
  const Written written;
  Opened opened(written.scan, 1, 1'000'000);
  system::survive_cut_files();
  std::filesystem::resize_file(written.scan.file, written.file.chunks[1]);
  viewer::SplatView view = of_everything(*opened.coarse);
  for (int k = 0; k < 3; ++k) {
    view.pixels_per_m *= 1.1;
    opened.refinement->look({view, {}});
    finish(*opened.refinement);
  }
  EXPECT_EQ(opened.refinement->detail()->parts.size(), 0U);
  ASSERT_EQ(opened.said.size(), 1U);
  EXPECT_NE(opened.said.front().find("became shorter"), std::string::npos) << opened.said.front();
  EXPECT_EQ(opened.refinement->failures(), written.nodes.size() - 1);
}

TEST(Refinement, ManyDamagedNodesAreCountedAndNotSaidOneByOne) {
  Written written;
  for (std::size_t n = 1; n < written.nodes.size(); ++n)
    std::fill_n(written.file.bytes.begin() + static_cast<std::ptrdiff_t>(written.file.chunks[n]), 60, '\xA5');
  write_file(written.scan.file, written.file.bytes);
  Opened opened(written.scan, 1, 1'000'000);
  opened.refinement->look({of_everything(*opened.coarse), {}});
  finish(*opened.refinement);
  EXPECT_EQ(opened.refinement->failures(), 24U);
  ASSERT_EQ(opened.said.size(), 2U);
  EXPECT_NE(opened.said.back().find("24 nodes cannot be read"), std::string::npos) << opened.said.back();
}

TEST(Refinement, EmptyReturnsThatTheCoarsePointsLeaveOutDoNotComeBack) {
  std::vector<CopcNode> nodes = three_levels();
  for (const std::size_t n : {0U, 1U, 9U})  // those at the corner of the cube
    nodes[n].points.insert(nodes[n].points.end(), 40, {0, 0, 0});
  const Written written(std::move(nodes));
  Opened opened(written.scan, 1, 1'000'000);
  ASSERT_EQ(opened.coarse->points.size(), 300U);
  const viewer::SplatView view = of_everything(*opened.coarse);
  opened.refinement->look({view, {}});
  finish(*opened.refinement);
  EXPECT_EQ(shown(*opened.coarse, opened.refinement->detail().get(), view), all_of(written.scan, *opened.coarse, view));
}

TEST(Refinement, AtRestNothingIsLoadedAndWhatWasLookedAtComesAgain) {
  const Written written;
  Opened opened(written.scan, 1, 1'000'000);
  const viewer::SplatView view = of_everything(*opened.coarse);
  opened.refinement->look({view, {}});
  finish(*opened.refinement);
  const std::weak_ptr<const viewer::PointView> part = opened.refinement->detail()->parts.front();
  for (int k = 0; k < 2; ++k) {  // also in the middle of reading
    opened.refinement->rest();
    EXPECT_TRUE(part.expired());
    EXPECT_FALSE(opened.refinement->detail());
    opened.refinement->look({view, {}});
    EXPECT_FALSE(opened.refinement->busy());
    opened.refinement->resume();
  }
  finish(*opened.refinement);
  EXPECT_EQ(shown(*opened.coarse, opened.refinement->detail().get(), view), all_of(written.scan, *opened.coarse, view));
}

TEST(DepthScans, WhatWasReadFinerIsGivenUpWhileTheScansAreReadAgain) {
  // Coarse levels have a million points at least.
  std::vector<CopcNode> nodes{{0, {0, 0, 0}, {}}, {1, {0, 0, 0}, {}}};
  for (std::int32_t y = 1; y <= 1000; ++y)
    for (std::int32_t x = 1; x <= 1000; ++x) nodes[0].points.push_back({x, y, 700});
  for (std::int32_t k = 1; k <= 500; ++k) nodes[1].points.push_back({k, k, 710});
  const Written written(std::move(nodes));
  write_file(written.folder / "a.yaml",
             "scans:\n  - {file: a.copc.laz, units: m}\norientation: {look_from: [0, 0, 1], up: [0, 1, 0]}\ngrid: "
             "{spacing_mm: 20}\n");
  DepthScans scans(written.folder / "a.yaml");
  scans.set_most_points(1'010'000);
  scans.open();
  test::wait_until([&] { return !scans.status().busy; });
  ASSERT_TRUE(scans.status().points) << scans.status().note;
  ASSERT_EQ(scans.status().points->points.size(), 1'000'000U);
  scans.look(of_everything(*scans.status().points), {});
  const auto some = [&] { return !scans.status().refining && scans.status().detail; };
  test::wait_until(some);
  ASSERT_EQ(scans.status().detail->parts.size(), 1U);
  const std::weak_ptr<const viewer::PointView> part = scans.status().detail->parts.front();
  std::filesystem::remove(written.scan.file);
  scans.set_unit(scene::LengthUnit::mm);
  test::wait_until([&] { return !scans.status().busy; });
  EXPECT_TRUE(scans.status().problem) << "the file is gone";
  EXPECT_TRUE(part.expired());
  test::wait_until(some);
  EXPECT_EQ(scans.status().detail->parts.size(), 1U) << "as before";
}

}  // namespace
}  // namespace sparsha::app::testing
