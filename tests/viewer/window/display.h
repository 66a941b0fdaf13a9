// A virtual display and what a visitor's hands do on it.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace sparsha::viewer::test {

[[nodiscard]] bool on_path(const std::string& program);

/// Xvfb on a display number of its own choice, ended by the destructor.
class VirtualDisplay {
 public:
  /// `number`: a display number of one's own choice, or nothing. `size`: of its screen, pixels.
  explicit VirtualDisplay(const std::string& number = {}, const std::string& size = "1280x800");
  ~VirtualDisplay();
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;
  /// Empty: it did not start.
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  pid_t pid_ = -1;
  std::string name_;
};

/// DISPLAY for the time of a test; null: none.
class DisplayName {
 public:
  explicit DisplayName(const char* name);
  ~DisplayName();
  DisplayName(const DisplayName&) = delete;
  DisplayName& operator=(const DisplayName&) = delete;

 private:
  std::string before_;
};

/// A test with a display of its own; skipped where there is no Xvfb.
class OnADisplay : public testing::Test {
 protected:
  void SetUp() override;

  std::unique_ptr<VirtualDisplay> display_;
  std::optional<DisplayName> name_;
};

/// Whether the condition came true in time.
bool wait_for(const std::function<bool()>& condition, double seconds = 60.0);

/// Keys and clicks, as xdotool's arguments; its exit code.
int xdotool(const std::string& arguments);

/// The window's number in the X server; 0: there is none.
[[nodiscard]] unsigned long window_number();

/// Width and height as the X server has them, pixels.
[[nodiscard]] std::pair<int, int> size_of_window(unsigned long window);

}  // namespace sparsha::viewer::test
