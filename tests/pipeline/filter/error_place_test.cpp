// What a filter does not find is an error that names the line of the configuration where the filter stands.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/yaml/yaml.h"
#include "pipeline/filter/filter.h"
#include "pipeline/filter/streamed.h"
#include "scene/config/config.h"
#include "tests/pipeline/filter/labelled.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

/// The configuration's third line has one filter before the one that fails, in its fourth.
scene::Config with_filter(const std::string& filter, const std::string& scan = "a.xyz") {
  const std::string text =
      "scans: [{file: " + scan + ", units: m}]\nfilters:\n  - pass: {axis: z, min_m: -9}\n  - " + filter + "\n";
  return scene::parse_config(yaml::parse_text(text, "statue.yaml"), "/");
}

/// A sphere without a plane, 2.8 mm between points.
LabelledCloud sphere() {
  std::mt19937 random(1);
  LabelledCloud scene;
  add_sphere(scene, {0, 0}, 0.1, 0.0, 15000, 0.0, Part::object, random);
  return scene;
}

const std::vector<std::string>& failing_filters() {
  static const std::vector<std::string> filters{
      "crop: {min_m: [5, 5, 5], max_m: [6, 6, 6]}",
      "pass: {axis: z, min_m: 5}",
      "remove_plane: {distance_mm: 1}",
      "keep: {cluster: largest, tolerance_mm: 0.01}",
      "keep: {cluster: largest, tolerance_mm: 0.01, method: pcl}",
      "keep: {nearest_to: [900, 900, 900]}",
      "radius_outliers: {radius_mm: 0.01, neighbours: 2}",
      "radius_outliers: {radius_mm: 0.01, neighbours: 2, method: pcl}",
      "smooth: {radius_mm: 0.01}",
      "smooth: {radius_mm: 0.01, method: pcl}",
      "voxel: {leaf_mm: 0.000001}",
  };
  return filters;
}

void expect_fourth_line(const Error& error, const std::string& filter) {
  EXPECT_EQ(error.place().file, "statue.yaml") << filter << ": " << error.what();
  EXPECT_EQ(error.place().line, 4) << filter;
  EXPECT_EQ(error.place().column, 5) << filter;
  EXPECT_FALSE(error.expected().empty()) << filter;
}

TEST(FilterErrors, NameTheLineOfTheFilterThatFindsNothing) {
  for (const std::string& filter : failing_filters()) {
    Cloud cloud = sphere().cloud();
    cloud.origin_m.x() = 5e6;  // the leaf of the voxel filter is below its precision
    Work work;
    try {
      apply_filters(cloud, with_filter(filter).filters, work.context());
      ADD_FAILURE() << filter << ": no error";
    } catch (const Error& error) {
      expect_fourth_line(error, filter);
    }
  }
}

TEST(FilterErrors, NameTheLineAlsoWhereThePointsStayOnDisk) {
  std::string text;
  for (const Eigen::Vector3d& p : sphere().points_m) {
    text += std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) + "\n";
  }
  const testing::ScanFolder folder;
  const std::string file = folder.write("sphere.xyz", text).string();
  for (const std::string& filter : failing_filters()) {
    const scene::Config config = with_filter(filter, file);
    if (!can_be_streamed(config.filters.back())) continue;
    Work work;
    try {
      const ScanSet scans(config.scans, ScanSet::Keep::disk, false, work.progress);
      StreamedFilters streamed(scans, config.filters, work.context());
      (void)scans.stream(
          [&](const CloudBlock& block) {
            for (std::size_t k = 0; k < block.points.size(); ++k) (void)streamed.keep(block, k);
          },
          work.progress);
      (void)streamed.finish(work.progress);
      ADD_FAILURE() << filter << ": no error";
    } catch (const Error& error) {
      expect_fourth_line(error, filter);
    }
  }
}

TEST(FilterErrors, CancellingStaysCancelling) {
  Cloud cloud = sphere().cloud();
  Work work;
  work.progress.cancel();
  EXPECT_THROW(apply_filters(cloud, with_filter("keep: {cluster: largest}").filters, work.context()), Cancelled);
}

}  // namespace
}  // namespace sparsha::pipeline
