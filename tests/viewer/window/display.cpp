#include "tests/viewer/window/display.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

namespace sparsha::viewer::test {

bool on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string rest = path != nullptr ? path : "";
  while (!rest.empty()) {
    const std::size_t colon = rest.find(':');
    if (::access((rest.substr(0, colon) + "/" + program).c_str(), X_OK) == 0) return true;
    rest = colon == std::string::npos ? "" : rest.substr(colon + 1);
  }
  return false;
}

VirtualDisplay::VirtualDisplay(const std::string& number, const std::string& size) {
  int ends[2];
  if (::pipe(ends) != 0) return;
  pid_ = ::fork();
  if (pid_ == 0) {
    const int quiet = ::open("/dev/null", O_RDWR);
    ::dup2(quiet, 1);
    ::dup2(quiet, 2);
    ::close(ends[0]);
    const std::string fd = std::to_string(ends[1]);
    const std::string screen = size + "x24";
    // A server that begins anew whenever its last client has gone, as after a look whether it is there, refuses others
    // meanwhile.
    if (!number.empty())
      ::execlp("Xvfb", "Xvfb", number.c_str(), "-noreset", "-displayfd", fd.c_str(), "-screen", "0", screen.c_str(),
               "-nolisten", "tcp", static_cast<char*>(nullptr));
    ::execlp("Xvfb", "Xvfb", "-noreset", "-displayfd", fd.c_str(), "-screen", "0", screen.c_str(), "-nolisten", "tcp",
             static_cast<char*>(nullptr));
    ::_exit(127);
  }
  ::close(ends[1]);
  char c = 0;
  while (::read(ends[0], &c, 1) == 1 && c != '\n') name_ += c;
  ::close(ends[0]);
  if (!name_.empty()) name_ = ":" + name_;
}

VirtualDisplay::~VirtualDisplay() {
  if (pid_ <= 0) return;
  ::kill(pid_, SIGTERM);
  ::waitpid(pid_, nullptr, 0);
}

DisplayName::DisplayName(const char* name) {
  if (const char* old = std::getenv("DISPLAY")) before_ = old;
  ::unsetenv("WAYLAND_DISPLAY");
  if (name != nullptr)
    ::setenv("DISPLAY", name, 1);
  else
    ::unsetenv("DISPLAY");
}

DisplayName::~DisplayName() {
  if (before_.empty())
    ::unsetenv("DISPLAY");
  else
    ::setenv("DISPLAY", before_.c_str(), 1);
}

void OnADisplay::SetUp() {
  if (!on_path("Xvfb")) GTEST_SKIP() << "Xvfb is not installed (package xvfb)";
  ASSERT_TRUE(on_path("xdotool")) << "package xdotool";
  display_ = std::make_unique<VirtualDisplay>();
  ASSERT_FALSE(display_->name().empty()) << "Xvfb did not start";
  name_.emplace(display_->name().c_str());
}

bool wait_for(const std::function<bool()>& condition, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return condition();
}

int xdotool(const std::string& arguments) { return std::system(("xdotool " + arguments + " >/dev/null 2>&1").c_str()); }

unsigned long window_number() {
  unsigned long window = 0;
  if (FILE* pipe = ::popen("xdotool search --sync --name Sparsha", "r")) {
    if (std::fscanf(pipe, "%lu", &window) != 1) window = 0;
    ::pclose(pipe);
  }
  return window;
}

std::pair<int, int> size_of_window(unsigned long window) {
  std::pair<int, int> size;
  if (FILE* pipe = ::popen(("xdotool getwindowgeometry --shell " + std::to_string(window)).c_str(), "r")) {
    std::array<char, 256> line{};
    while (std::fgets(line.data(), line.size(), pipe) != nullptr) {
      std::sscanf(line.data(), "WIDTH=%d", &size.first);
      std::sscanf(line.data(), "HEIGHT=%d", &size.second);
    }
    ::pclose(pipe);
  }
  return size;
}

}  // namespace sparsha::viewer::test
