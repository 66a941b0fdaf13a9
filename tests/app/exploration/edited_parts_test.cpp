// Parts that are edited while they are touched: felt, spoken and written, or nothing of all that.
#include "app/exploration/edited_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "base/error.h"
#include "base/files/files.h"
#include "haptics/device/pointer/pointer_device.h"
#include "haptics/session/session.h"
#include "tests/support/changing_scenes.h"
#include "tests/support/servo_parts.h"
#include "tests/support/test_folder.h"

namespace sparsha::app {
namespace {

namespace fs = std::filesystem;
using scene::ScenePointer;

constexpr std::size_t kMost = 1U << 20U;

std::vector<scene::PartConfig> nose() {
  scene::PartConfig part;
  part.name = "nose";
  part.say = "The nose";
  part.box_m = {2.0, -3.0, 2.1, -2.9};
  part.touch.stiffness_n_per_m = 320.0;
  return {part};
}

class EditedParts : public ::testing::Test {
 protected:
  EditedParts() : scene_(sparsha::test::in_folder(sparsha::test::stone(101), folder_ / "statue")) {}
  [[nodiscard]] std::string yaml() const { return read_file(folder_ / "statue" / "scene.yaml", kMost); }

  const sparsha::test::TestFolder folder_;
  ScenePointer scene_;
};

TEST_F(EditedParts, AreFeltSpokenAndWritten) {
  const auto hand = std::make_shared<haptics::Seqlock<haptics::PointerSample>>();
  hand->publish({{0.0, 0.0, 0.02}, 0, 1});
  haptics::SessionOptions options = sparsha::test::options_of(scene_, {});
  haptics::Session session(scene_, haptics::make_pointer_device(hand), options);
  const auto until = [&](const std::function<bool(const haptics::State&)>& so) {
    return haptics::eventually([&] {
      session.poll();
      return so(session.state().read());
    });
  };
  session.start();
  ASSERT_TRUE(until([](const haptics::State& now) { return now.tick > 100; }));
  hand->publish({{0.0, 0.0, -0.002}, 0, 2});
  ASSERT_TRUE(until([](const haptics::State& now) { return now.contact != 0; }));
  const std::uint64_t heard = session.announcements().since(0).back().sequence;

  const ScenePointer edited = with_parts(scene_, nose());
  session.set_scene(edited);
  EXPECT_EQ(session.scene(), edited) << "what the viewer asks for";
  ASSERT_TRUE(until([](const haptics::State& now) { return now.stiffness_n_per_m == 320.0; })) << "felt";
  const auto said = [&] {
    const auto all = session.announcements().since(heard);
    return std::any_of(all.begin(), all.end(), [](const auto& a) { return a.text == "The nose"; });
  };
  EXPECT_TRUE(until([&](const haptics::State&) { return said(); })) << "spoken";
  session.stop();
  const ScenePointer again = scene::open_scene(folder_ / "statue");
  ASSERT_EQ(again->description().config.parts.size(), 1U);
  EXPECT_EQ(again->description().config.parts[0].say, "The nose");
  EXPECT_EQ(again->description().config.parts[0].touch.stiffness_n_per_m, 320.0);
}

TEST_F(EditedParts, ThatCannotBeWrittenAreAnErrorAndLeaveSceneAndFileAsTheyWere) {
  // Whoever may write everywhere can still not put a file where a folder is.
  const std::string before = yaml();
  fs::rename(folder_ / "statue" / "scene.yaml", folder_ / "scene.yaml");
  fs::create_directory(folder_ / "statue" / "scene.yaml");
  try {
    static_cast<void>(with_parts(scene_, nose()));
    FAIL() << "nothing was written";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::failure);
    EXPECT_NE(std::string(error.what()).find((folder_ / "statue" / "scene.yaml").string()), std::string::npos)
        << error.what();
    EXPECT_FALSE(error.wrong().empty()) << "what the visitor is told";
  }
  EXPECT_EQ(scene_->description().config.parts.front().name, "middle");
  fs::remove(folder_ / "statue" / "scene.yaml");
  fs::rename(folder_ / "scene.yaml", folder_ / "statue" / "scene.yaml");
  EXPECT_EQ(yaml(), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "statue"), fs::directory_iterator()), 2)
      << "scene.yaml, level-0 and nothing half written";
  // Once it can be written, the same edit goes through.
  static_cast<void>(with_parts(scene_, nose()));
  EXPECT_NE(yaml().find("The nose"), std::string::npos);
}

TEST_F(EditedParts, OfASceneInMemoryAreFeltAndWrittenNowhere) {
  const ScenePointer edited = with_parts(sparsha::test::stone(101), nose());
  EXPECT_TRUE(edited->folder().empty());
  EXPECT_EQ(edited->description().config.parts.front().name, "nose");
}

}  // namespace
}  // namespace sparsha::app
