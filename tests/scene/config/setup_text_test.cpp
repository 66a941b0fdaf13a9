// Another orientation, unit and crop in the text of a configuration: all else stays.
#include "scene/config/setup_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <functional>

#include "base/yaml/yaml.h"
#include "scene/config/config.h"

namespace sparsha::scene {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Config read(const std::string& text) { return parse_config(yaml::parse_text(text, "test"), {}); }

Config wanted_from(const std::string& text) {
  Config wanted = read(text);
  wanted.orientation.scan_to_grid.setIdentity();
  wanted.orientation.scan_to_grid.topLeftCorner<3, 3>() =
      2.0 * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  return wanted;
}

void expect_says(const SetupText& result, const Config& wanted) {
  const Config again = read(result.text);
  EXPECT_TRUE(again.orientation.scan_to_grid.isApprox(wanted.orientation.scan_to_grid, 1e-12)) << result.text;
  Config same = again;
  same.orientation = wanted.orientation;
  EXPECT_EQ(to_yaml(same), to_yaml(wanted));
}

TEST(SetupText, OrientationIsReplacedInEveryStyle) {
  for (const char* orientation :
       {"orientation: {look_from: [0, 0, 1]}  # why\n",
        "# why\norientation:\n  look_from: [0, 0, 1]\n  up: [0, 1, 0]\n", "", "orientation: {face: auto}  # why\n"}) {
    const std::string text =
        std::string("# first\nscans:\n  - file: a.ply  # station\n") + orientation + "fill: {max_gap_mm: 3}  # last";
    Config wanted = wanted_from(text);
    wanted.orientation.face.reset();
    const SetupText result = text_with_setup(text, wanted, {});
    EXPECT_TRUE(result.kept) << text;
    for (const char* comment : {"# first", "# station", "# last"}) EXPECT_THAT(result.text, HasSubstr(comment));
    if (*orientation != '\0') {
      EXPECT_THAT(result.text, HasSubstr("# why"));
    }
    EXPECT_THAT(result.text, HasSubstr("euler_deg"));
    expect_says(result, wanted);
  }
}

TEST(SetupText, UnitsAndCropAreReplacedOrAdded) {
  const std::string head = "scans:\n  - {file: a.ply, units: mm}  # flow\n  - file: b.ply  # block\n";
  for (const char* filters :
       {"", "filters:\n  - voxel: {leaf_mm: 1}  # thin\n",
        "filters:\n  - crop: {min_m: [0, 0, 0], max_m: [1, 1, 1]}  # box\n  - voxel: {leaf_mm: 1}\n",
        "filters:\n- crop:\n    min_m: [0, 0, 0]\n    max_m: [1, 1, 1]\n"}) {
    const std::string text = head + filters;
    Config wanted = wanted_from(text);
    for (ScanConfig& scan : wanted.scans) scan.units = {LengthUnit::cm, 0.0};
    const CropConfig crop{{-0.5, 0.1, 2.25}, {0.5, 0.3, 1e5}};
    const bool has_crop = !wanted.filters.empty() && std::holds_alternative<CropConfig>(wanted.filters.front());
    if (has_crop) {
      wanted.filters.front() = crop;
    } else {
      wanted.filters.insert(wanted.filters.begin(), crop);
    }
    const SetupText result = text_with_setup(text, wanted, {});
    EXPECT_TRUE(result.kept) << text << "\n" << result.text;
    EXPECT_THAT(result.text, HasSubstr("# flow"));
    EXPECT_THAT(result.text, HasSubstr("# block"));
    expect_says(result, wanted);
  }
}

TEST(SetupText, ACropBoxIsTakenAwayAndAllCommentsButItsOwnStay) {
  for (const char* filters :
       {"filters:  # in this order\n  - crop: {min_m: [0, 0, 0], max_m: [1, 1, 1]}\n  # thin\n  - voxel: {leaf_mm: "
        "1}\n",
        "filters:  # in this order\n- voxel: {leaf_mm: 1}\n# thin\n- crop:\n    min_m: [0, 0, 0]\n    max_m: [1, 1, 1]",
        "filters:  # in this order\n  # thin\n  - crop: {min_m: [0, 0, 0], max_m: [1, 1, 1]}\ngrid: {spacing_mm: "
        "1}\n"}) {
    const std::string text = std::string("scans:\n  - file: a.ply  # station\n") + filters;
    Config wanted = wanted_from(text);
    std::erase_if(wanted.filters, [](const FilterConfig& f) { return std::holds_alternative<CropConfig>(f); });
    const SetupText result = text_with_setup(text, wanted, {});
    EXPECT_TRUE(result.kept) << text << "\n" << result.text;
    for (const char* comment : {"# station", "# in this order", "# thin"}) EXPECT_THAT(result.text, HasSubstr(comment));
    EXPECT_THAT(result.text, Not(HasSubstr("crop")));
    expect_says(result, wanted);
  }
}

PartConfig drawn_part(const char* name, double x_m) {
  PartConfig part;
  part.name = part.say = name;
  part.box_m = {x_m, 0.125, x_m + 0.1, 1.0 / 3.0};
  return part;
}

TEST(SetupText, PartsAreMovedRemovedAndAddedAndCommentsStay) {
  const std::string head = "# first\nscans:\n  - file: a.ply  # station\n";
  const std::string block =
      "parts:  # of the plate\n"
      "  - {name: a, say: A, box_m: [0, 0, 1, 1]}  # left\n"
      "  # the nose\n"
      "  - name: b\n    say: \"B: #1\"\n    box_m: [0, 0, 1, 1]  # by eye\n    stiffness_n_per_m: 300\n"
      "  - {name: c, say: C, box_m: [2, 2, 3, 3]}\n";
  const std::string tail = "fill: {max_gap_mm: 3}  # last\n";
  const auto kept = [&](const std::string& text, const std::function<void(std::vector<PartConfig>&)>& edit,
                        std::initializer_list<const char*> comments) {
    Config wanted = wanted_from(text);
    edit(wanted.parts);
    const SetupText result = text_with_setup(text, wanted, {});
    EXPECT_TRUE(result.kept) << result.text;
    for (const char* comment : comments) EXPECT_THAT(result.text, HasSubstr(comment));
    for (const char* comment : {"# first", "# station"}) EXPECT_THAT(result.text, HasSubstr(comment));
    expect_says(result, wanted);
  };
  const auto add = [](std::vector<PartConfig>& parts) {
    parts.push_back(drawn_part("new", 0.1));
    parts.push_back(drawn_part("newer: \"quoted\"", 0.7));
  };
  const std::string text = head + block + tail;
  const auto all = {"# of the plate", "# left", "# the nose", "# by eye", "# last"};
  kept(text, add, all);
  kept(head + tail, add, {"# last"});
  kept(head + "parts: []  # none yet\n" + tail, add, {"# none yet", "# last"});
  kept(head + "parts: [{name: a, say: A, box_m: [0, 0, 1, 1]}]  # flow\n" + tail, add, {"# flow", "# last"});
  kept(head + tail + block, add, all);
  kept(head + tail + block.substr(0, block.size() - 1), add, all);
  kept(
      text, [](auto& parts) { parts[0].box_m[2] = 0.1 + 0.2, parts[1].box_m[0] = -1e-7; }, all);
  kept(text, [](auto& parts) { parts.erase(parts.begin()); }, {"# of the plate", "# the nose", "# by eye", "# last"});
  kept(
      text, [&](auto& parts) { parts.pop_back(), add(parts); }, all);
  kept(text, [&](auto& parts) { parts.erase(parts.begin() + 1), parts[1].box_m[3] = 7.0, add(parts); },
       {"# of the plate", "# left", "# the nose", "# last"});
  kept(text, [](auto& parts) { parts.clear(); }, {"# of the plate", "# the nose", "# last"});
  kept(text, [&](auto& parts) { parts.clear(), add(parts); }, {"# of the plate", "# the nose", "# last"});
}

TEST(SetupText, WhatCannotBeEditedIsWrittenAnewAndSaid) {
  const std::string text = "scans: [{file: a.ply}]  # comment\ngrid: {spacing_mm: 1}\n";
  Config wanted = wanted_from(text);
  wanted.grid.spacing_m = 0.005;
  const SetupText result = text_with_setup(text, wanted, {});
  EXPECT_FALSE(result.kept);
  EXPECT_THAT(result.text, Not(HasSubstr("# comment")));
  expect_says(result, wanted);
  EXPECT_FALSE(text_with_setup("this is: [no configuration", wanted, {}).kept);
}

TEST(SetupText, PlacesOfPartsAreKeptWithTheirFrame) {
  const std::string text = "scans: [{file: a.ply}]\nparts: [{name: a, say: A, box_m: [0, 0, 1, 1]}]  # part\n";
  Config wanted = wanted_from(text);
  wanted.orientation.regions_scan_to_grid = Eigen::Matrix4d::Identity();
  const SetupText result = text_with_setup(text, wanted, {});
  EXPECT_TRUE(result.kept) << result.text;
  const Config again = read(result.text);
  ASSERT_TRUE(again.orientation.regions_scan_to_grid);
  EXPECT_TRUE(again.orientation.regions_scan_to_grid->isIdentity(0.0));
  EXPECT_TRUE(read(to_yaml(again)).orientation.regions_scan_to_grid) << "and in a scene.yaml";
}

}  // namespace
}  // namespace sparsha::scene
