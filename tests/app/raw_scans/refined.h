// COPC files in three levels, and what a picture of them shows.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "app/raw_scans/point_reader.h"
#include "app/raw_scans/refinement.h"
#include "base/files/files.h"
#include "pipeline/scan/reader.h"
#include "tests/support/copc_file.h"
#include "tests/support/test_folder.h"
#include "tests/support/wait.h"

namespace sparsha::app::testing {

using pipeline::testing::CopcFile;
using pipeline::testing::CopcNode;

using Row = std::tuple<float, float, float, std::uint32_t, float>;

inline void finish(const Refinement& refinement) {
  test::wait_until([&] { return !refinement.busy(); });
}

/// A root, all cells of level 1, and of level 2 those at the bottom; none at a lower corner of its cube.
inline std::vector<CopcNode> three_levels() {
  std::mt19937 random(11);
  std::vector<CopcNode> nodes;
  const auto add = [&](int level, const std::array<std::int32_t, 3>& cell, int count) {
    const std::int32_t edge = 1600 >> level;
    CopcNode node{level, cell, {}};
    std::uniform_int_distribution<std::int32_t> place(1, edge - 1);
    for (int n = 0; n < count; ++n) {
      node.points.push_back(
          {cell[0] * edge + place(random), cell[1] * edge + place(random), cell[2] * edge + place(random)});
    }
    nodes.push_back(std::move(node));
  };
  add(0, {0, 0, 0}, 300);
  for (std::int32_t k = 0; k < 8; ++k) add(1, {k & 1, k >> 1 & 1, k >> 2}, 200);
  for (std::int32_t k = 0; k < 16; ++k) add(2, {k & 3, k >> 2, 0}, 100);
  return nodes;
}

/// Seen from +z, `metres` high around a place of the scan frame.
inline viewer::SplatView around(const Eigen::Vector3d& place, double metres, const viewer::PointView& points) {
  viewer::SplatView view;
  view.width = 300;
  view.height = 200;
  view.pixels_per_m = view.height / metres;
  view.target_m = place - points.origin_m;
  return view;
}

inline bool in_picture(const viewer::SplatView& view, const Eigen::Vector3d& p) {
  const Eigen::Vector3d pixel = view.to_pixel(p);
  return pixel.x() >= 0.0 && pixel.x() <= view.width && pixel.y() >= 0.0 && pixel.y() <= view.height;
}

inline void add_rows(const viewer::PointView& points, const viewer::SplatView& view, std::vector<Row>& rows) {
  for (std::size_t n = 0; n < points.points.size(); ++n) {
    const Eigen::Vector3f& p = points.points[n];
    if (!in_picture(view, p.cast<double>())) continue;
    rows.emplace_back(p.x(), p.y(), p.z(), points.rgba.empty() ? 0 : points.rgba[n],
                      points.intensity.empty() ? 0.0F : points.intensity[n]);
  }
}

inline std::vector<Row> shown(const viewer::PointView& coarse, const viewer::PointDetail* detail,
                              const viewer::SplatView& view) {
  std::vector<Row> rows;
  add_rows(coarse, view, rows);
  if (detail != nullptr)
    for (const auto& part : detail->parts) add_rows(*part, view, rows);
  std::sort(rows.begin(), rows.end());
  return rows;
}

/// What reading all of the file gives.
inline std::vector<Row> all_of(const scene::ScanConfig& scan, const viewer::PointView& coarse,
                               const viewer::SplatView& view) {
  Progress progress;
  const pipeline::Cloud cloud = pipeline::load_scan(scan, progress, coarse.origin_m);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float* const p = cloud.xyz1() + 4 * i;
    if (!in_picture(view, Eigen::Vector3d(p[0], p[1], p[2]))) continue;
    rows.emplace_back(p[0], p[1], p[2], cloud.rgba.empty() ? 0 : cloud.rgba[i] | 0xFF000000U, cloud.intensity[i]);
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

struct Opened {
  std::shared_ptr<const viewer::PointView> coarse;
  std::unique_ptr<Refinement> refinement;
  std::vector<std::string> said;

  Opened(const scene::ScanConfig& scan, std::uint64_t coarse_points, std::uint64_t most_points)
      : Opened(std::vector{scan}, coarse_points, most_points) {}
  Opened(const std::vector<scene::ScanConfig>& scans, std::uint64_t coarse_points, std::uint64_t most_points) {
    Progress progress;
    ReadPoints read = read_points(scans, "a", progress, kMostPointsShown, coarse_points);
    coarse = read.view;
    EXPECT_FALSE(read.coarse.empty());
    refinement = std::make_unique<Refinement>(std::move(read.coarse), coarse, most_points,
                                              [this](const std::string& words) { said.push_back(words); });
  }
};

struct Written {
  test::TestFolder folder;
  std::vector<CopcNode> nodes;
  CopcFile file{nodes};
  scene::ScanConfig scan;

  explicit Written(std::vector<CopcNode> made = three_levels()) : nodes(std::move(made)) {
    scan.file = folder / "a.copc.laz";
    scan.units.unit = scene::LengthUnit::m;
    write_file(scan.file, file.bytes);
  }
  /// Whether the node's cube reaches into a rectangle over x and y, with a step of the coordinates.
  [[nodiscard]] bool meets(std::size_t n, double x0, double y0, double x1, double y1) const {
    const double edge = CopcFile::kSide / (1 << nodes[n].level), step = CopcFile::kScale;
    const double x = edge * nodes[n].cell[0], y = edge * nodes[n].cell[1];
    return x - step <= x1 && x + edge + step >= x0 && y - step <= y1 && y + edge + step >= y0;
  }
};

}  // namespace sparsha::app::testing
