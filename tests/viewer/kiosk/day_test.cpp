// Many visitors one after the other: nothing is left behind. A whole day with SPARSHA_NIGHTLY=1.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "tests/support/sanitized.h"
#include "tests/support/test_folder.h"
#include "tests/viewer/relief_scene.h"
#include "tests/viewer/studio.h"
#include "viewer/kiosk/attract.h"

namespace sparsha::viewer::test {
namespace {

std::ptrdiff_t open_files() {
  const std::filesystem::directory_iterator list("/proc/self/fd");
  return std::distance(begin(list), end(list));
}

double resident_mb() {
  std::ifstream file("/proc/self/statm");
  double size = 0.0, resident = 0.0;
  file >> size >> resident;
  return resident * 4096.0 / 1e6;
}

/// What visitors save goes to the present folder: one of its own.
class PresentFolder {
 public:
  PresentFolder() { std::filesystem::current_path(folder_.path()); }
  ~PresentFolder() { std::filesystem::current_path(before_); }
  PresentFolder(const PresentFolder&) = delete;
  PresentFolder& operator=(const PresentFolder&) = delete;

 private:
  std::filesystem::path before_ = std::filesystem::current_path();
  sparsha::test::TestFolder folder_;
};

TEST(Kiosk, ADayOfVisitorsLeavesNothingBehind) {
  if (!std::filesystem::exists("/proc/self/statm")) GTEST_SKIP() << "memory is read from /proc";
  const PresentFolder present;
  const int visitors = std::getenv("SPARSHA_NIGHTLY") != nullptr ? 600 : 12;  // a minute each
  const std::array<scene::ScenePointer, 3> scenes{
      scene_of(lotus, {201, 201, 0.002, 2}),
      scene_of([](double x_m, double) { return 0.1 * x_m; }, {101, 151, 0.003, 1}),
      scene_of([](double, double y_m) { return 0.05 * y_m; }, {301, 61, 0.002, 2})};
  std::size_t shown = 0;
  haptics::RequestQueue requests;
  haptics::AnnouncementBoard board;
  ViewSettings settings;
  settings.kiosk = true;
  Connections connections;
  connections.requests = &requests;
  connections.announcements = &board;
  connections.pointer = std::make_shared<haptics::Seqlock<haptics::PointerSample>>();
  connections.next_scene = [&](int step) { shown = (shown + 3 + static_cast<std::size_t>(step + 3)) % 3; };
  Studio studio(scenes[0], settings, connections);
  std::mt19937 random(4);
  std::vector<Action> list;
  for (const ActionInfo& info : all_actions())
    if (info.action != Action::quit && info.action != Action::rescan && info.action != Action::orient)
      list.push_back(info.action);
  const auto visit = [&](int number) {
    for (int k = 0; k < 15; ++k) studio.act(list[random() % list.size()]);
    studio.act(Action::next_scene);
    if (studio.picture().scene() != scenes[shown]) {
      studio.picture().set_scene(scenes[shown]);
      studio.controller().set_scene(scenes[shown]);
    }
    board.say("Visitor " + std::to_string(number));
    const double at = 0.05 + 0.001 * (number % 50);
    studio.shoot(touching(*scenes[shown], at, at, 0.01, at, at), 640, 400);
    while (requests.take()) {
      // The session is not here.
    }
  };
  for (int k = 0; k < std::max(12, visitors / 6); ++k) visit(k);  // drivers and caches fill
  const int objects = gl::living_objects();
  const std::ptrdiff_t files = open_files();
  const double memory_mb = resident_mb();
  int most_objects = 0;
  for (int k = 0; k < visitors; ++k) {
    visit(k);
    most_objects = std::max(most_objects, gl::living_objects());
  }
  // Detail pieces and the second eye come and go with what a visitor looks at.
  constexpr int kCaches = 24;
  EXPECT_LE(most_objects, objects + kCaches);
  EXPECT_LE(open_files(), files + 1);
  constexpr double kNoise_mb = 24.0;  // the allocator's, whatever the number of visitors
  if (!SPARSHA_SANITIZED) {           // sanitizers keep for a while what was given back
    EXPECT_LT(resident_mb(), memory_mb + kNoise_mb);
  }
  EXPECT_TRUE(studio.gl_errors().empty()) << studio.gl_errors().front();
  EXPECT_FALSE(studio.controller().wants_to_leave());
}

}  // namespace
}  // namespace sparsha::viewer::test
