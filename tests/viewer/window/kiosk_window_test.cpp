// The window of an exhibit on a virtual display: what ends it, what does not, and what it does without visitors.
#include <gtest/gtest.h>

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "base/system/library.h"
#include "tests/viewer/relief_scene.h"
#include "tests/viewer/window/display.h"
#include "tests/viewer/window/drop.h"
#include "viewer/viewer.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace sparsha::viewer::test {
namespace {

class KioskWindow : public OnADisplay {};

TEST_F(KioskWindow, TheSessionsEndClosesAKiosk) {
  const auto scene = scene_of(lotus, {101, 101, 0.004, 1});
  Connections connections;
  connections.scene = [&] { return scene; };
  int polls = 0;
  connections.poll = [&] { ++polls; };
  connections.finished = [&] { return polls > 5; };
  ViewerOptions options;
  options.kiosk = true;
  run_window(connections, options);
  EXPECT_GT(polls, 5);
}

#ifdef SPARSHA_HAS_X11
TEST_F(KioskWindow, AKioskIsNotClosedByTheDesktopAndFillsTheScreenAgain) {
  const auto scene = scene_of(lotus, {101, 101, 0.004, 1});
  Connections connections;
  connections.scene = [&] { return scene; };
  int polls = 0;
  bool asked = false, small = false, full = false;
  GLFWwindow* window = nullptr;
  connections.poll = [&] {
    ++polls;
    window = glfwGetCurrentContext();
    if (polls == 5) asked = ask_to_close(window_number());
    // As GLFW does when a monitor is unplugged.
    if (polls == 20) {
      glfwSetWindowMonitor(window, nullptr, 10, 10, 320, 200, GLFW_DONT_CARE);
      small = glfwGetWindowMonitor(window) == nullptr;
    }
    full = small && glfwGetWindowMonitor(window) != nullptr;
  };
  const auto began = std::chrono::steady_clock::now();
  connections.finished = [&] { return full || std::chrono::steady_clock::now() - began > std::chrono::seconds(60); };
  ViewerOptions options;
  options.kiosk = true;
  EXPECT_EQ(run_window(connections, options), WindowEnd::closed);
  EXPECT_TRUE(asked);
  EXPECT_GT(polls, 20) << "the desktop has closed it";
  EXPECT_TRUE(small);
  EXPECT_TRUE(full);
}

TEST_F(KioskWindow, OutsideOfAKioskTheDesktopClosesIt) {
  const auto scene = scene_of(lotus, {101, 101, 0.004, 1});
  Connections connections;
  connections.scene = [&] { return scene; };
  int polls = 0;
  bool asked = false;
  connections.poll = [&] {
    if (++polls == 5) asked = ask_to_close(window_number());
  };
  connections.finished = [&] { return polls > 1000; };
  EXPECT_EQ(run_window(connections, {}), WindowEnd::closed);
  EXPECT_TRUE(asked);
  EXPECT_LT(polls, 1000);
}
#endif

TEST_F(KioskWindow, ALostDisplayEndsTheWindowAndNotTheProgramAndItComesBack) {
  // Far from the lowest free numbers, which other tests take: while it is gone nobody else may have it.
  const std::string number = ":" + std::to_string(200 + ::getpid() % 1000);
  display_ = std::make_unique<VirtualDisplay>(number);
  ASSERT_EQ(display_->name(), number);
  name_.emplace(number.c_str());
  const auto scene = scene_of(lotus, {101, 101, 0.004, 1});
  Connections connections;
  connections.scene = [&] { return scene; };
  int polls = 0;
  connections.poll = [&] {
    if (++polls == 6) display_.reset();
  };
  ViewerOptions options;
  options.kiosk = true;
  EXPECT_EQ(run_window(connections, options), WindowEnd::display_lost);
  EXPECT_FALSE(display_available());
  display_ = std::make_unique<VirtualDisplay>(number);
  ASSERT_EQ(display_->name(), number);
  ASSERT_TRUE(display_available());
  polls = 100;
  connections.finished = [&] { return polls > 110; };
  EXPECT_EQ(run_window(connections, options), WindowEnd::closed);
}

#ifdef SPARSHA_HAS_X11
TEST_F(KioskWindow, ALostDisplayTellsDriversTheSizeThatTheWindowHad) {
  using XDrawable = unsigned long;  // NOLINT(google-runtime-int): Xlib's type
  using Ask = int(void*, XDrawable, XDrawable*, int*, int*, unsigned*, unsigned*, unsigned*, unsigned*);
  // As the linker finds it for a driver.
  auto* const ask = reinterpret_cast<Ask*>(system::find_symbol("XGetGeometry"));
  auto* const x_display = reinterpret_cast<void* (*)()>(system::find_symbol("glfwGetX11Display"));
  ASSERT_NE(ask, nullptr);
  ASSERT_NE(x_display, nullptr);
  struct Answer {
    int answered = -1;
    unsigned width = 123456, height = 654321;  // what lay there before
  };
  Answer before, after;
  const auto asked = [&](XDrawable window) {
    Answer answer;
    XDrawable root = 0;
    int x = 0, y = 0;
    unsigned border = 0, depth = 0;
    answer.answered = ask(x_display(), window, &root, &x, &y, &answer.width, &answer.height, &border, &depth);
    return answer;
  };
  const auto scene = scene_of(lotus, {101, 101, 0.004, 1});
  Connections connections;
  connections.scene = [&] { return scene; };
  int polls = 0;
  connections.poll = [&] {
    if (++polls != 6) return;
    const XDrawable window = window_number();
    before = asked(window);
    display_.reset();
    after = asked(window);
  };
  ViewerOptions options;
  options.width = 800;
  options.height = 500;
  EXPECT_EQ(run_window(connections, options), WindowEnd::display_lost);
  EXPECT_NE(before.answered, 0);
  EXPECT_EQ(before.width, 800U);
  EXPECT_EQ(before.height, 500U);
  EXPECT_EQ(after.answered, 0);
  EXPECT_EQ(after.width, before.width);
  EXPECT_EQ(after.height, before.height);
}
#endif

TEST_F(KioskWindow, AnExhibitWithoutVisitorsShowsItselfAndListensAgain) {
  const auto scene = scene_of(lotus, {101, 101, 0.004, 1});
  haptics::RequestQueue requests;
  std::atomic<int> steps{0};
  std::atomic<bool> finished{false};
  Connections connections;
  connections.scene = [&] { return scene; };
  connections.requests = &requests;
  connections.next_scene = [&](int step) { steps += step; };
  connections.finished = [&] { return finished.load(); };
  ViewerOptions options;
  options.kiosk = true;
  options.idle_s = 1.0;
  std::string problem;
  std::thread visitor([&] {
    const auto request = [&](const char* what, haptics::Request::Kind kind) {
      const bool came = problem.empty() && wait_for([&] {
                          const auto got = requests.take();
                          return got && got->kind == kind;
                        });
      if (problem.empty() && !came) problem = what;
    };
    request("it does not go back to its beginning", haptics::Request::Kind::whole_scene);
    if (xdotool("search --sync --name Sparsha windowfocus") != 0) problem = "no window";
    xdotool("key q Escape r o e");
    if (problem.empty() && !wait_for([&] { return steps == 1; })) problem = "no other scene";
    request("it does not go back a second time", haptics::Request::Kind::whole_scene);
    xdotool("key ctrl+q");
    request("staff cannot leave", haptics::Request::Kind::quit);
    finished = true;
  });
  EXPECT_EQ(run_window(connections, options), WindowEnd::closed);
  finished = true;
  visitor.join();
  EXPECT_EQ(problem, "");
}

}  // namespace
}  // namespace sparsha::viewer::test
