// Which of the windows that are asked for are loaded, and in what order.
#include "haptics/session/window_loader.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "tests/support/scenes.h"

namespace sparsha::haptics {
namespace {

void doze() { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }

/// A scene whose first window does not come before the gate opens.
class GatedScene final : public scene::Scene {
 public:
  [[nodiscard]] const scene::SceneDescription& description() const override { return inner_->description(); }
  [[nodiscard]] scene::Layers read(int level, int i0, int j0, int nx, int ny) const override {
    reading_.store(true);
    while (!open_.load()) doze();
    return inner_->read(level, i0, j0, nx, ny);
  }
  [[nodiscard]] std::filesystem::path folder() const override { return {}; }
  void open() { open_.store(true); }
  void wait_for_reader() const {
    while (!reading_.load()) doze();
  }

 private:
  scene::ScenePointer inner_ = sparsha::test::flat_scene();
  mutable std::atomic<bool> reading_{false};
  std::atomic<bool> open_{false};
};

WindowLoader::Job job_on(const scene::ScenePointer& scene, std::uint64_t id, bool own_place) {
  WindowLoader::Job job;
  job.scene = scene;
  job.plan = plan_window(scene->description(), 0, {0.05, 0.05}, 0.1);
  job.command.move = own_place;
  job.id = id;
  return job;
}

/// Asks for the first window, for the others while it is being loaded, and tells which came. `own_place`: of each.
std::vector<std::uint64_t> loaded(const std::vector<bool>& own_place) {
  const auto scene = std::make_shared<GatedScene>();
  WindowLoader loader;
  for (std::size_t k = 0; k < own_place.size(); ++k) {
    loader.request(job_on(scene, k + 1, own_place[k]));
    if (k == 0) scene->wait_for_reader();
  }
  scene->open();
  std::vector<std::uint64_t> ids;
  while (loader.busy()) {
    if (const auto result = loader.take()) {
      EXPECT_EQ(result->error, "");
      EXPECT_NE(result->job.command.window.surface, nullptr);
      ids.push_back(result->job.command.window.id);
    } else {
      doze();
    }
  }
  return ids;
}

using Ids = std::vector<std::uint64_t>;

TEST(WindowLoader, LoadsOffTheCallersThreadTheFirstWindowAndTheLastOfThoseThatWait) {
  EXPECT_EQ(loaded({true, true, true, true}), (Ids{1, 4}));
  EXPECT_EQ(loaded({false, false, false}), (Ids{1, 3}));
}

TEST(WindowLoader, AWindowUnderTheHandDoesNotOvertakeThePlaceThatTheHandIsToBeAt) {
  EXPECT_EQ(loaded({false, true, false}), (Ids{1, 2, 3}));
  EXPECT_EQ(loaded({false, true, false, false}), (Ids{1, 2, 4}));
  EXPECT_EQ(loaded({false, true, false, true}), (Ids{1, 4}));
}

TEST(WindowLoader, EndsWithoutTheWindowsThatNobodyWaitsFor) {
  const auto scene = std::make_shared<GatedScene>();
  std::thread opens;
  {
    WindowLoader loader;
    for (std::uint64_t id = 1; id <= 3; ++id) loader.request(job_on(scene, id, true));
    scene->wait_for_reader();
    opens = std::thread([&] { scene->open(); });
  }
  opens.join();
}

}  // namespace
}  // namespace sparsha::haptics
