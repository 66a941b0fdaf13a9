// Finer levels of COPC files come where somebody looks: the same points as decoding all, from the chunks in the
// picture.
#include "app/raw_scans/refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "base/files/files.h"
#include "tests/app/raw_scans/refined.h"
#include "tests/support/scan_files.h"

namespace sparsha::app::testing {
namespace {

TEST(Refinement, ThePointsInThePictureAreThoseOfDecodingAllAndOtherChunksAreNotRead) {
  Written written;
  // A picture of 1.5 x 1 m: of level 1 the two cubes over each other that hold it, of level 2 one.
  const Eigen::Vector3d place(2.0, 2.0, 8.0);
  std::string spoilt = written.file.bytes;
  std::uint64_t bytes = 0;
  for (std::size_t n = 0; n < written.nodes.size(); ++n) {
    if (written.nodes[n].level == 0 || written.meets(n, 1.0, 1.0, 3.0, 3.0)) {
      bytes += written.nodes[n].level == 0 ? 0 : written.file.sizes[n];
      continue;
    }
    std::fill_n(spoilt.begin() + static_cast<std::ptrdiff_t>(written.file.chunks[n]), written.file.sizes[n], '\xA5');
  }
  scene::ScanConfig damaged = written.scan;
  damaged.file = written.folder / "spoilt.copc.laz";
  write_file(damaged.file, spoilt);
  Opened opened(damaged, 1, 1'000'000);
  EXPECT_EQ(opened.coarse->points.size(), 300U) << "the root alone";
  EXPECT_EQ(opened.coarse->total, 300U + 8 * 200 + 16 * 100);
  EXPECT_EQ(opened.refinement->bytes_read(), 0U) << "points of this format have no colours";
  const viewer::SplatView view = around(place, 1.0, *opened.coarse);
  opened.refinement->look({view, {}});
  finish(*opened.refinement);
  const auto detail = opened.refinement->detail();
  ASSERT_TRUE(detail);
  EXPECT_TRUE(detail->whole);
  EXPECT_EQ(opened.said, std::vector<std::string>());
  EXPECT_EQ(opened.refinement->bytes_read(), bytes);
  EXPECT_EQ(detail->points, 2U * 200 + 100);
  const std::vector<Row> expected = all_of(written.scan, *opened.coarse, view);
  EXPECT_GT(expected.size(), 0U);
  EXPECT_EQ(shown(*opened.coarse, detail.get(), view), expected);
  EXPECT_LT(shown(*opened.coarse, nullptr, view).size(), expected.size());
}

TEST(Refinement, FromAfarNothingIsReadAndCloserOneLevelAfterTheOther) {
  const Written written;
  Opened opened(written.scan, 1, 1'000'000);
  const Eigen::Vector3d middle = Eigen::Vector3d::Constant(8.0);
  const auto parts_at = [&](double pixels_per_m) {
    viewer::SplatView view = around(middle, 1.0, *opened.coarse);
    view.pixels_per_m = pixels_per_m;
    opened.refinement->look({view, {}});
    finish(*opened.refinement);
    return opened.refinement->detail()->parts.size();
  };
  EXPECT_EQ(parts_at(0.9), 0U) << "points of the root are less than a pixel apart";
  EXPECT_EQ(opened.refinement->bytes_read(), 0U);
  EXPECT_EQ(parts_at(1.5), 8U);
  EXPECT_EQ(parts_at(2.5), 24U);
  EXPECT_EQ(parts_at(0.9), 24U) << "what is here stays while there is room";
}

TEST(Refinement, TheMemoryIsBoundedAndWhatWasLookedAtLongAgoGoesFirst) {
  const Written written;
  constexpr std::uint64_t kMost = 4 * kLeastCounted;  // a picture wants three, which have few points
  Opened opened(written.scan, 1, kMost);
  std::set<const viewer::PointView*> before;
  for (const auto& [x, y] : {std::pair{2.0, 2.0}, {14.0, 2.0}, {14.0, 14.0}, {2.0, 14.0}, {2.0, 2.0}}) {
    const viewer::SplatView view = around({x, y, 8.0}, 1.0, *opened.coarse);
    opened.refinement->look({view, {}});
    finish(*opened.refinement);
    const auto detail = opened.refinement->detail();
    EXPECT_LE(detail->parts.size(), 4U) << "a node takes memory beside its points";
    EXPECT_TRUE(detail->whole);
    EXPECT_EQ(shown(*opened.coarse, detail.get(), view), all_of(written.scan, *opened.coarse, view));
  }
  // A picture of everything does not fit: whole levels and near nodes come as far as they go.
  viewer::SplatView whole = around(Eigen::Vector3d::Constant(8.0), 16.0, *opened.coarse);
  opened.refinement->look({whole, {}});
  finish(*opened.refinement);
  EXPECT_FALSE(opened.refinement->detail()->whole);
  EXPECT_EQ(opened.refinement->detail()->parts.size(), 4U);
  EXPECT_EQ(opened.refinement->detail()->spacing_m, 0.0) << "no level is whole";
}

TEST(Refinement, CoarseNodesComeFirstThenThoseNearTheMiddleAndTheViewer) {
  const auto node = [](int level, const Eigen::Vector3d& middle) {
    DetailNode made;
    made.levels_below = level;
    made.low_m = middle - Eigen::Vector3d::Constant(0.5);
    made.high_m = middle + Eigen::Vector3d::Constant(0.5);
    made.parents_apart_m = 0.1;
    made.points = 6000;
    return made;
  };
  const std::vector<DetailNode> nodes{node(2, {0, 0, 0}), node(1, {2, 0, 0}), node(1, {0, 1, -3}),
                                      node(1, {0, 0, 1}), node(1, {9, 0, 0}), node(1, {0, 0, -1})};
  viewer::SplatView view;
  view.pixels_per_m = 20.0;
  view.width = view.height = 100;
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  const auto order = [&](const Look& look, std::uint64_t most) { return wanted_nodes(nodes, look, origin, most); };
  EXPECT_EQ(order({view, {}}, 100'000).nodes, (std::vector<std::size_t>{3, 5, 1, 2, 0}));
  EXPECT_TRUE(order({view, {}}, 100'000).all);
  EXPECT_EQ(order({view, {}}, 15'000).nodes, (std::vector<std::size_t>{3, 5}));
  EXPECT_FALSE(order({view, {}}, 15'000).all);
  const scene::CropConfig upper{{-9, -9, 0.6}, {9, 9, 9}};
  EXPECT_EQ(order({view, upper}, 100'000).nodes, (std::vector<std::size_t>{3}));
  std::vector<DetailNode> small = nodes;
  for (DetailNode& made : small) made.points = 1;
  EXPECT_EQ(wanted_nodes(small, {view, {}}, origin, 2 * kLeastCounted).nodes, (std::vector<std::size_t>{3, 5}))
      << "a node takes memory beside its points";
  view.pixels_per_m = 9.0;
  EXPECT_TRUE(order({view, {}}, 100'000).nodes.empty());
}

TEST(Refinement, ADamagedNodeIsSaidOnceAndLeavesTheOthers) {
  Written written;
  const std::size_t bad = 3;
  std::fill_n(written.file.bytes.begin() + static_cast<std::ptrdiff_t>(written.file.chunks[bad]), 60, '\xA5');
  write_file(written.scan.file, written.file.bytes);
  Opened opened(written.scan, 1, 1'000'000);
  viewer::SplatView view = around(Eigen::Vector3d::Constant(8.0), 16.0, *opened.coarse);
  for (int k = 0; k < 2; ++k) {
    view.pixels_per_m *= 1.1;
    opened.refinement->look({view, {}});
    finish(*opened.refinement);
  }
  EXPECT_EQ(opened.refinement->detail()->parts.size(), written.nodes.size() - 2);
  ASSERT_EQ(opened.said.size(), 1U);
  EXPECT_NE(opened.said.front().find("at byte"), std::string::npos) << opened.said.front();
  EXPECT_NE(opened.said.front().find("node 3 of level 1"), std::string::npos) << opened.said.front();
}

TEST(Refinement, ANewLookTakesThePlaceOfTheOneBeforeAndItEndsInTheMiddle) {
  const Written written;
  for (int trial = 0; trial < 20; ++trial) {
    Opened opened(written.scan, 1, 1'000'000);
    viewer::SplatView view;
    for (int k = 0; k < 20; ++k) {
      view = around({0.7 * k, 0.7 * k, 8.0}, 2.0, *opened.coarse);
      opened.refinement->look({view, {}});
    }
    if (trial % 2 == 0) continue;
    finish(*opened.refinement);
    const auto detail = opened.refinement->detail();
    EXPECT_EQ(shown(*opened.coarse, detail.get(), view), all_of(written.scan, *opened.coarse, view));
  }
}

TEST(RealScanRefinement, ALionIsShownAsDecodingAllOfItDoes) {
  SPARSHA_REAL_SCANS_OR_SKIP(scans);
  scene::ScanConfig scan;
  scan.file = scans / "heritage/lion_takanawa.copc.laz";
  Opened opened(scan, 1, 1'000'000);
  std::size_t finer = 0;
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(-0.9, 5.1, -0.6), Eigen::Vector3d(-1.6, 4.6, -0.6)}) {
    const viewer::SplatView view = around(place, 0.5, *opened.coarse);
    opened.refinement->look({view, {}});
    finish(*opened.refinement);
    const auto detail = opened.refinement->detail();
    const std::vector<Row> now = shown(*opened.coarse, detail.get(), view);
    EXPECT_TRUE(detail->whole);
    EXPECT_TRUE(now == all_of(scan, *opened.coarse, view)) << now.size();
    finer += now.size() - shown(*opened.coarse, nullptr, view).size();
  }
  EXPECT_GT(finer, 0U);
  // As its hierarchy has them: the file's first node, which tells the range of colours, and two nodes over each other.
  EXPECT_EQ(opened.refinement->bytes_read(), 637554U + 490963U + 4072U);
  EXPECT_EQ(opened.said, std::vector<std::string>());
}

}  // namespace
}  // namespace sparsha::app::testing
