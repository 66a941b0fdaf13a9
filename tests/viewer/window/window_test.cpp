// A real window on a virtual display, driven by real key and mouse events.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "base/error.h"
#include "scene/folder/folder.h"
#include "tests/support/test_folder.h"
#include "tests/viewer/cloud/points.h"
#include "tests/viewer/relief_scene.h"
#include "tests/viewer/window/display.h"
#include "tests/viewer/window/drop.h"
#include "viewer/cloud/orientation.h"
#include "viewer/marks/notes.h"
#include "viewer/viewer.h"
#include "viewer/window/glfw_window.h"

namespace sparsha::viewer::test {
namespace {

class Window : public OnADisplay {};

/// Runs a window until it is closed; what it threw, empty when nothing.
template <typename Connections>
std::string problem_of_window(Connections& connections) {
  try {
    run_window(connections, {});
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

TEST(WindowWithoutDisplay, IsFoundOutCheaplyAndSaid) {
  const auto began = std::chrono::steady_clock::now();
  {
    const DisplayName none(nullptr);
    EXPECT_FALSE(display_available());
    const auto scene = scene_of(lotus, {51, 51, 0.008, 1});
    Connections connections;
    connections.scene = [&] { return scene; };
    try {
      run_window(connections, {});
      FAIL() << "there is no display";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::failure);
      EXPECT_NE(std::string(error.what()).find("display"), std::string::npos) << error.what();
    }
  }
  {
    const DisplayName wrong(":47113");
    EXPECT_FALSE(display_available());
  }
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(10));
}

TEST(WindowSize, IsWhatTheWorkAreaHasRoomForWithinTheFrame) {
  const std::array<int, 4> frame{2, 28, 2, 2};
  EXPECT_EQ(fitted_window(1280, 720, {0, 0, 1920, 1080}, frame), (Rect{2, 28, 1280, 720}));
  EXPECT_EQ(fitted_window(1280, 720, {0, 0, 1024, 768}, {}), (Rect{0, 0, 1024, 720}));
  EXPECT_EQ(fitted_window(1280, 720, {60, 24, 964, 744}, frame), (Rect{62, 52, 960, 714}));
  EXPECT_EQ(fitted_window(2560, 1440, {0, 32, 1366, 736}, frame), (Rect{2, 60, 1362, 706}));
  EXPECT_EQ(fitted_window(1280, 720, {}, {}), (Rect{0, 0, 1280, 720})) << "an unknown area limits nothing";
}

TEST(WindowSize, IsNoLargerThanTheScreen) {
  if (!on_path("Xvfb")) GTEST_SKIP() << "Xvfb is not installed (package xvfb)";
  ASSERT_TRUE(on_path("xdotool")) << "package xdotool";
  for (const auto& [size, width, height] :
       {std::tuple{"1024x768", 1024, 720}, std::tuple{"800x600", 800, 600}, std::tuple{"1920x1080", 1280, 720}}) {
    SCOPED_TRACE(size);
    const VirtualDisplay display({}, size);
    ASSERT_FALSE(display.name().empty()) << "Xvfb did not start";
    const DisplayName name(display.name().c_str());
    const GlfwLibrary library;
    WindowHandle window;
    open_window(window, {});
    EXPECT_EQ(size_of_window(window_number()), std::pair(width, height));
  }
}

TEST_F(Window, KeysAndMouseReachTheSession) {
  ASSERT_TRUE(display_available());

  const auto scene = scene_of(lotus, {201, 201, 0.002, 2});
  haptics::Seqlock<haptics::State> state;
  haptics::State at = touching(*scene, 0.2, 0.2, 0.01, 0.2, 0.2);
  state.publish(at);
  haptics::RequestQueue requests;
  haptics::AnnouncementBoard board;
  board.say("Welcome");
  Connections connections;
  connections.state = &state;
  connections.requests = &requests;
  connections.announcements = &board;
  connections.pointer = std::make_shared<haptics::Seqlock<haptics::PointerSample>>();
  std::atomic<int> frames{0};
  connections.poll = [&] { ++frames; };
  std::atomic<bool> finished{false};
  connections.finished = [&] { return finished.load(); };
  connections.scene = [&] { return scene; };

  std::string problem;
  std::thread visitor([&] {
    const auto expect = [&](const std::string& keys, haptics::Request::Kind kind) {
      if (!problem.empty()) return;
      xdotool("key " + keys);
      const bool came = wait_for([&] {
        const auto request = requests.take();
        return request && request->kind == kind;
      });
      if (!came) problem = "no request after " + keys;
    };
    using Kind = haptics::Request::Kind;
    if (!wait_for([&] { return frames.load() > 3; })) problem = "no frames";
    if (problem.empty() && xdotool("search --sync --name Sparsha windowfocus") != 0) problem = "no window";
    expect("plus", Kind::zoom_in);
    expect("minus", Kind::zoom_out);
    expect("Left", Kind::pan);
    expect("t", Kind::set_texture);
    expect("f", Kind::set_friction);
    expect("space", Kind::describe);
    xdotool("key F1 c l s s s s Escape");  // the help has a page or two, Escape closes either
    xdotool("search --name Sparsha mousemove --window %1 454 330");
    const auto sample = [&] { return connections.pointer->read(); };
    if (problem.empty() && !wait_for([&] { return sample().sequence > 0 && std::abs(sample().device_m[0]) < 0.02; }))
      problem = "the mouse does not move the hand: " + std::to_string(sample().sequence) + ", " +
                std::to_string(sample().device_m[0]);
    const double above_m = sample().device_m[2];
    xdotool("mousedown 1");
    if (problem.empty() && !wait_for([&] { return sample().device_m[2] < above_m - 0.003; }))
      problem = "the button does not press";
    xdotool("mouseup 1");
    xdotool("search --name Sparsha windowsize %1 900 600");
    const int before = frames.load();
    if (problem.empty() && !wait_for([&] { return frames.load() > before + 3; })) problem = "no frames after a resize";
    expect("q", Kind::quit);
    finished = true;
  });
  const std::string window_problem = problem_of_window(connections);
  finished = true;
  visitor.join();
  EXPECT_EQ(window_problem, "");
  EXPECT_EQ(problem, "");
}

TEST_F(Window, MeasuresPinsAndSectionsAreMadeWithRealKeysAndClicksAndKept) {
  const sparsha::test::TestFolder folder;
  std::filesystem::create_directories(folder / "scene");
  scene::write_scene(*scene_of(lotus, {201, 201, 0.002, 2},
                               [](scene::SceneDescription& d) {
                                 d.config.scans.resize(1);
                                 d.config.scans[0].file = "scan.ply";
                                 d.sources = {{"scan.ply", "abc", 1}};
                               }),
                     folder / "scene");
  const auto scene = scene::open_scene(folder / "scene");
  haptics::RequestQueue requests;
  std::atomic<int> frames{0};
  std::atomic<bool> finished{false};
  Connections connections;
  connections.scene = [&] { return scene; };
  connections.requests = &requests;
  connections.poll = [&] { ++frames; };
  connections.finished = [&] { return finished.load(); };
  std::string problem;
  std::thread visitor([&] {
    const auto notes = [&] { return read_notes(folder / "scene" / "notes.yaml"); };
    const auto pictures = [&] { wait_for([&, before = frames.load()] { return frames.load() > before + 5; }); };
    const auto expect = [&](const char* what, const std::function<bool()>& condition) {
      if (problem.empty() && !wait_for(condition)) problem = what;
    };
    const auto click = [&](int x, int y) {
      xdotool("search --name Sparsha mousemove --window %1 " + std::to_string(x) + " " + std::to_string(y));
      xdotool("click 1");
      pictures();
    };
    if (!wait_for([&] { return frames.load() > 3; })) problem = "no frames";
    if (problem.empty() && xdotool("search --sync --name Sparsha windowfocus") != 0) problem = "no window";
    xdotool("key u");
    click(400, 300);
    click(500, 360);
    expect("no measure is kept", [&] { return notes().measures.size() == 1; });
    xdotool("search --name Sparsha mousemove --window %1 450 200");
    pictures();
    xdotool("key k");
    pictures();
    xdotool("type --delay 60 'a chip'");
    xdotool("key Return");
    expect("no pin is kept", [&] { return notes().pins.size() == 1; });
    xdotool("key z");
    expect("no section is kept", [&] { return notes().section.has_value(); });
    xdotool("key i");
    expect("the parallel view is not kept", [&] { return notes().parallel; });
    xdotool("key Delete");
    expect("nothing is removed", [&] { return notes().pins.empty(); });
    xdotool("key Escape q");
    expect("q does not leave", [&] {
      const auto got = requests.take();
      return got && got->kind == haptics::Request::Kind::quit;
    });
    finished = true;
  });
  run_window(connections, {});
  finished = true;
  visitor.join();
  EXPECT_EQ(problem, "");
  const Notes kept = read_notes(folder / "scene" / "notes.yaml");
  ASSERT_EQ(kept.measures.size(), 1U);
  EXPECT_GT(value_of(kept.measures[0]), 0.02);
}

TEST_F(Window, OpensOnTheRawCloudScansAndGoesBackToIt) {
  Workshop workshop(square(150, 1.0));
  std::mutex mutex;  // of the workshop, which both threads look at
  const auto made = scene_of(lotus, {201, 201, 0.002, 2});
  scene::ScenePointer scene;
  haptics::Seqlock<haptics::State> state;
  state.publish(touching(*made, 0.2, 0.2, 0.01, 0.2, 0.2));
  haptics::RequestQueue requests;
  haptics::AnnouncementBoard board;
  std::atomic<int> frames{0};
  std::atomic<bool> finished{false};
  Connections connections;
  connections.scene = [&] { return scene; };
  connections.finished = [&] { return finished.load(); };
  const Orienting orienting = workshop.orienting();
  connections.orienting = orienting;
  const auto locked = [&](const auto& work) {
    const std::lock_guard lock(mutex);
    return work();
  };
  connections.orienting.open = [&] { locked([&] { ++workshop.opened; }); };
  connections.orienting.status = [&] { return locked([&] { return workshop.status; }); };
  connections.orienting.save = [&](const ScanSetup& setup) { locked([&] { workshop.saves.push_back(setup); }); };
  connections.orienting.scan = [&](const ScanSetup& setup) { locked([&] { workshop.scans.push_back(setup); }); };
  connections.poll = [&] {
    ++frames;
    if (scene || locked([&] { return workshop.scans.empty(); })) return;
    scene = made;  // the depth scan is done: the session begins
    connections.state = &state;
    connections.requests = &requests;
    connections.announcements = &board;
  };

  std::string problem;
  std::thread visitor([&] {
    const auto expect = [&](const char* what, const std::function<bool()>& condition) {
      if (problem.empty() && !wait_for([&] { return locked(condition); })) problem = what;
    };
    if (!wait_for([&] { return frames.load() > 3; })) problem = "no frames";
    if (problem.empty() && xdotool("search --sync --name Sparsha windowfocus") != 0) problem = "no window";
    expect("the scans are not opened", [&] { return workshop.opened == 1; });
    xdotool("search --name Sparsha mousemove --window %1 400 300");
    xdotool("mousedown 1");
    xdotool("search --name Sparsha mousemove --window %1 470 300");
    xdotool("mouseup 1");
    xdotool("key Left Up comma ctrl+s");
    expect("nothing is saved", [&] { return !workshop.saves.empty(); });
    xdotool("key Return");
    expect("no depth scan", [&] { return !workshop.scans.empty(); });
    // In the scene, the same keys are the session's.
    const auto request = [&](const std::string& keys, haptics::Request::Kind kind) {
      xdotool("key " + keys);
      expect(("no request after " + keys).c_str(), [&] {
        const auto got = requests.take();
        return got && got->kind == kind;
      });
    };
    if (problem.empty() && !wait_for([&, before = frames.load()] { return frames.load() > before + 5; }))
      problem = "no frames in the scene";
    request("plus", haptics::Request::Kind::zoom_in);
    xdotool("key o");
    expect("the scans are not shown again", [&] { return workshop.opened == 2; });
    xdotool("key 5 ctrl+s");
    expect("nothing is saved after coming back", [&] { return workshop.saves.size() == 2; });
    xdotool("key Escape");
    request("minus", haptics::Request::Kind::zoom_out);
    request("q", haptics::Request::Kind::quit);
    finished = true;
  });
  const std::string window_problem = problem_of_window(connections);
  finished = true;
  visitor.join();
  EXPECT_EQ(window_problem, "");
  ASSERT_EQ(problem, "");
  // 70 pixels of the mouse, then the keys: turn by -5, tilt by -5, roll by 5 degrees.
  const double step = 3.14159265358979 / 36.0;
  Eigen::Matrix4d truth = turned(Eigen::Matrix4d::Identity(), false, 70.0 * 0.008, 0.0);
  truth = rolled(turned(turned(truth, false, -step, 0.0), false, 0.0, -step), 0.0, 0.0, step);
  EXPECT_TRUE(workshop.saves[0].scan_to_grid.isApprox(truth, 1e-9));
  EXPECT_EQ(workshop.scans[0].scan_to_grid, workshop.saves[0].scan_to_grid);
  EXPECT_TRUE(workshop.saves[1].scan_to_grid.isApprox(seen_from(Face::top, false, truth), 1e-9));
}

#ifdef SPARSHA_HAS_X11
TEST_F(Window, FilesDroppedIntoItAreOpenedByTheirNames) {
  const auto scene = scene_of(lotus, {101, 101, 0.004, 1});
  std::atomic<int> frames{0};
  std::atomic<bool> finished{false};
  std::mutex mutex;
  std::vector<std::filesystem::path> dropped;
  Connections connections;
  connections.scene = [&] { return scene; };
  connections.poll = [&] { ++frames; };
  connections.finished = [&] { return finished.load(); };
  connections.drop = [&](const std::vector<std::filesystem::path>& files) {
    const std::lock_guard lock(mutex);
    dropped = files;
  };
  std::string problem;
  std::thread visitor([&] {
    if (!wait_for([&] { return frames.load() > 3; })) problem = "no frames";
    const unsigned long id = window_number();
    if (problem.empty() && id == 0) problem = "no window";
    if (problem.empty() && !drop_files(id, "file:///tmp/left%20lion.ply\r\nfile:///tmp/right.las\r\n"))
      problem = "the window does not take what is dropped";
    if (problem.empty() && !wait_for([&] {
          const std::lock_guard lock(mutex);
          return dropped.size() == 2;
        }))
      problem = "nothing is opened";
    finished = true;
  });
  run_window(connections, {});
  finished = true;
  visitor.join();
  ASSERT_EQ(problem, "");
  EXPECT_EQ(dropped[0], "/tmp/left lion.ply");
  EXPECT_EQ(dropped[1], "/tmp/right.las");
}
#endif

}  // namespace
}  // namespace sparsha::viewer::test
