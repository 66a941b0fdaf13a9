// --set: what a setting overrides, and what it does not.
#include "scene/config/override.h"
#include "scene/config/config.h"

#include <gtest/gtest.h>

namespace sparsha::scene {
namespace {

Config with(const std::string& text, const std::vector<std::string>& settings) {
  yaml::Node root = yaml::parse_text("scans: [{file: a.ply, pose: {euler_deg: [1, 2, 3]}}]\n" + text, "test");
  override_keys(root, settings);
  return parse_config(root, {});
}

TEST(OverrideKeys, LetsAGridSizeTakeThePlaceOfASpacingAndTheOtherWayRound) {
  const Config size = with("grid: {spacing_mm: 2}\n", {"grid.size=800"});
  EXPECT_EQ(size.grid.size, 800);
  EXPECT_EQ(size.grid.spacing_m, 0.0);
  const Config spacing = with("grid: {size: 800}\n", {"grid.spacing_mm=2"});
  EXPECT_EQ(spacing.grid.size, 0);
  EXPECT_DOUBLE_EQ(spacing.grid.spacing_m, 0.002);
}

TEST(OverrideKeys, LetsOneWayToOrientTakeThePlaceOfAnother) {
  EXPECT_NO_THROW(
      (void)with("orientation: {look_from: [0, 0, 1], up: [0, 1, 0]}\n", {"orientation.quaternion=[0, 0, 0, 1]"}));
  EXPECT_NO_THROW((void)with("orientation: {euler_deg: [0, 0, 90]}\n", {"orientation.look_from=[1, 0, 0]"}));
  EXPECT_NO_THROW((void)with("", {"scans.0.pose.quaternion=[0, 0, 0, 1]"}));
}

TEST(OverrideKeys, TakesAPlaceInAListInBracketsAsDocumentsWriteIt) {
  EXPECT_EQ(with("", {"scans[0].units=mm"}).scans.at(0).units.unit, LengthUnit::mm);
  EXPECT_NO_THROW((void)with("", {"scans[0].pose.quaternion=[0, 0, 0, 1]"})) << "the angles make way";
  for (const char* setting : {"scans[].units=mm", "scans[1].units=mm", "scans[0.units=mm", "scans[a].units=mm"})
    EXPECT_THROW((void)with("", {setting}), Error) << setting;
}

TEST(OverrideKeys, LeavesTwoSettingsThatContradictToBeRefused) {
  EXPECT_THROW((void)with("", {"grid.size=800", "grid.spacing_mm=2"}), Error);
  EXPECT_THROW((void)with("grid: {spacing_mm: 2}\n", {"grid.sise=800"}), Error);
}

TEST(ConfigText, WritesRoundNumbersPlainly) {
  const std::string text = to_yaml(with("fill: {max_gap_mm: 20}\nfilters: [{voxel: {leaf_mm: 300}}]\n", {}));
  EXPECT_NE(text.find("max_gap_mm: 20}"), std::string::npos) << text;
  EXPECT_NE(text.find("leaf_mm: 300}"), std::string::npos) << text;
}

TEST(ConfigText, OfTwoDocumentsIsRefused) {
  try {
    (void)yaml::parse_text("grid: {size: 8}\n---\ngrid: {size: 9}\n", "two.yaml");
    FAIL() << "the second document was passed over";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_EQ(error.place().line, 2);
  }
  EXPECT_NO_THROW((void)yaml::parse_text("---\ngrid: {size: 8}\n...\n", "one.yaml"));
}

}  // namespace
}  // namespace sparsha::scene
