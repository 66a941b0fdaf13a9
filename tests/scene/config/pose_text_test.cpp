// New poses in the text of a configuration: all else stays.
#include "scene/config/pose_text.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "base/yaml/yaml.h"
#include "scene/config/config.h"
#include "tests/support/test_folder.h"

namespace sparsha::scene {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

Eigen::Matrix4d some_pose(double angle) {
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  pose.topLeftCorner<3, 3>() = Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  pose.topRightCorner<3, 1>() = Eigen::Vector3d(5e5 + angle, 4e6, -angle);
  return pose;
}

struct Written {
  std::string text;
  Config config;  ///< read from it
};
Written write_poses(const test::TestFolder& folder, const std::string& text, const std::vector<Eigen::Matrix4d>& poses,
                    const fs::path& to = {}) {
  const fs::path file = folder / "statue.yaml";
  std::ofstream(file) << text;
  Written written;
  const fs::path target = to.empty() ? folder.path() : to;
  written.text = text_with_poses(file, load_config(file), poses, target);
  written.config = parse_config(yaml::parse_text(written.text, "written"), target);
  for (std::size_t s = 0; s < poses.size(); ++s)
    EXPECT_LT((written.config.scans[s].pose - poses[s]).cwiseAbs().maxCoeff(), 1e-8) << written.text;  // of 4e6 m
  return written;
}

TEST(PoseText, PosesOfEveryFormAreReplacedAndCommentsStay) {
  const test::TestFolder folder;
  const Written written = write_poses(folder,
                                      "# a statue\n"
                                      "scans:               # three stations\n"
                                      "  - file: a.ply      # the first\n"
                                      "    pose: {translate: [1, 2, 3], quaternion: [0, 0, 0, 1]}  # rough\n"
                                      "    units: m\n"
                                      "  - pose:\n"
                                      "      translate: [1, 2, 3]\n"
                                      "      # by eye\n"
                                      "      euler_deg: [1, 2, 3]\n"
                                      "    file: \"b.ply\"\n"
                                      "  - {file: 'c.ply', units: mm}\n"
                                      "  - file: d.ply      # the last\n"
                                      "grid: {size: 100}    # small\n",
                                      {some_pose(0.1), some_pose(0.2), some_pose(0.3), some_pose(0.4)});
  for (const char* kept :
       {"# a statue", "# three stations", "# the first", "# rough", "# the last", "# small", "units: mm"})
    EXPECT_THAT(written.text, HasSubstr(kept));
  EXPECT_THAT(written.text, Not(HasSubstr("euler_deg")));
  EXPECT_EQ(written.config.grid.size, 100);
}

TEST(PoseText, APoseThatDidNotChangeStaysAsItIsWritten) {
  const test::TestFolder folder;
  const Written written =
      write_poses(folder, "scans:\n  - file: a.ply\n    pose: {euler_deg: [0, 0, 0]}\n  - file: b.ply\n",
                  {Eigen::Matrix4d::Identity(), some_pose(0.2)});
  EXPECT_THAT(written.text, HasSubstr("pose: {euler_deg: [0, 0, 0]}"));
}

TEST(PoseText, PathsAreMadeRelativeToTheFolderThatTheTextGoesTo) {
  const test::TestFolder folder;
  fs::create_directories(folder / "out");
  const Written written = write_poses(folder,
                                      "scans:\n  - file: scans/a.ply  # first\n  - file: \"b.ply\"\naudio:\n  "
                                      "regions:\n    - {name: x, box_m: [0, 0, 1, "
                                      "1], clip: bell.wav}\n  labels: {file: labels.png}\n",
                                      {some_pose(0.0), some_pose(0.2)}, folder / "out");
  EXPECT_THAT(written.text, HasSubstr("\"../scans/a.ply\"  # first"));
  EXPECT_THAT(written.text, HasSubstr("\"../b.ply\""));
  EXPECT_THAT(written.text, HasSubstr("clip: \"../bell.wav\""));
  EXPECT_THAT(written.text, HasSubstr("labels: {file: \"../labels.png\"}"));
}

TEST(PoseText, TextThatCannotBeEditedIsWrittenAnewWithTheSameMeaning) {
  const test::TestFolder folder;
  const Written written = write_poses(folder,
                                      "scans:\n  - file: a.ply\n    pose: &rough {translate: [1, 2, 3]}\n"
                                      "  - file: b.ply\n    pose: *rough\n",
                                      {some_pose(0.1), some_pose(0.2)});
  EXPECT_EQ(written.config.scans.size(), 2U);
}

}  // namespace
}  // namespace sparsha::scene
