// An event device as the kernel shows it, made of a pair of sockets and an ioctl() of this program: the codes, sizes
// and structures are those of linux/input.h.
#if defined(__linux__)
#include <gtest/gtest.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/system/gamepad.h"
#include "haptics/device/gamepad/gamepad.h"
#include "haptics/servo/servo.h"
#include "tests/support/sanitized.h"
#include "tests/support/servo_parts.h"

namespace {

/// What the kernel would know of the device.
struct EventDevice {
  int file = -1;
  bool tablet = false, rumbles = true, south = false;
  int trigger = 0;
  std::mutex mutex;
  std::vector<ff_effect> uploaded;
  std::vector<int> removed;
};
EventDevice* device = nullptr;

void set_bit(void* bits, std::size_t size, int bit) {
  if (static_cast<std::size_t>(bit) / 8 < size) static_cast<unsigned char*>(bits)[bit / 8] |= 1U << (bit % 8);
}

[[maybe_unused]] int answer(unsigned long request, void* argument) {
  const auto size = static_cast<std::size_t>(_IOC_SIZE(request));
  const auto number = static_cast<unsigned>(_IOC_NR(request));
  if (number == _IOC_NR(EVIOCGNAME(0))) {
    std::snprintf(static_cast<char*>(argument), size, "made of sockets");
    return 16;
  }
  if (number == _IOC_NR(EVIOCGBIT(EV_KEY, 0))) {
    std::memset(argument, 0, size);
    set_bit(argument, size, device->tablet ? BTN_TOOL_PEN : BTN_SOUTH);
    return static_cast<int>(size);
  }
  if (number == _IOC_NR(EVIOCGKEY(0))) {
    std::memset(argument, 0, size);
    if (device->south) set_bit(argument, size, BTN_SOUTH);
    return static_cast<int>(size);
  }
  if (number == _IOC_NR(EVIOCGBIT(EV_FF, 0))) {
    std::memset(argument, 0, size);
    if (device->rumbles) set_bit(argument, size, FF_RUMBLE);
    return static_cast<int>(size);
  }
  if (number >= _IOC_NR(EVIOCGABS(0)) && number < _IOC_NR(EVIOCGABS(0)) + 64) {
    const auto axis = static_cast<unsigned>(number - _IOC_NR(EVIOCGABS(0)));
    input_absinfo info{};
    info.maximum = axis == ABS_PRESSURE ? 8191 : axis == ABS_RZ ? 1023 : 32767;
    info.minimum = axis <= ABS_Y && !device->tablet ? -32768 : 0;
    if (axis == ABS_GAS) info.maximum = 0;
    info.value = axis == ABS_RZ ? device->trigger : 0;
    std::memcpy(argument, &info, sizeof info);
    return 0;
  }
  const std::lock_guard lock(device->mutex);
  if (request == EVIOCSFF) {
    ff_effect effect{};
    std::memcpy(&effect, argument, sizeof effect);
    if (effect.id == -1) effect.id = 3;
    std::memcpy(argument, &effect, sizeof effect);
    device->uploaded.push_back(effect);
    return 0;
  }
  if (request == EVIOCRMFF) {
    device->removed.push_back(static_cast<int>(reinterpret_cast<std::intptr_t>(argument)));
    return 0;
  }
  errno = ENOTTY;
  return -1;
}

}  // namespace

#if !SPARSHA_SANITIZED
extern "C" int ioctl(int file, unsigned long request, ...) noexcept {
  std::va_list rest;
  va_start(rest, request);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  if (device != nullptr && file == device->file) return answer(request, argument);
  return static_cast<int>(::syscall(SYS_ioctl, file, request, argument));
}
#endif

namespace sparsha::haptics {
namespace {

using system::PadKind;
using system::PadState;

class EventPad : public testing::Test {
 protected:
  void SetUp() override {
    if (SPARSHA_SANITIZED) GTEST_SKIP() << "sanitizers bring their own ioctl";
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends_), 0);
    made_.file = ends_[0];
    device = &made_;
  }
  void TearDown() override {
    device = nullptr;
    if (ends_[1] >= 0) ::close(ends_[1]);
  }
  void happen(const std::vector<std::array<int, 3>>& events) const {
    std::vector<input_event> all;
    for (const auto& [type, code, value] : events) {
      input_event event{};
      event.type = static_cast<__u16>(type);
      event.code = static_cast<__u16>(code);
      event.value = value;
      all.push_back(event);
    }
    all.push_back({});  // EV_SYN
    ASSERT_GT(::write(ends_[1], all.data(), all.size() * sizeof(input_event)), 0);
  }
  /// The next event that was written to the device.
  [[nodiscard]] bool written(input_event& event) const {
    return ::read(ends_[1], &event, sizeof event) == static_cast<ssize_t>(sizeof event);
  }
  [[nodiscard]] std::vector<ff_effect> uploaded() {
    const std::lock_guard lock(made_.mutex);
    return made_.uploaded;
  }

  EventDevice made_;
  int ends_[2] = {-1, -1};
};

TEST_F(EventPad, AGamepadIsReadByItsRangesAndItsMotorsAreDrivenByForceFeedback) {
  auto pad = system::pad_of_file(made_.file, PadKind::gamepad);
  ASSERT_NE(pad, nullptr);
  EXPECT_EQ(pad->name(), "made of sockets");
  PadState state;
  pad->read(state);
  EXPECT_NEAR(state.left_x, 0.0, 1e-4);
  happen({{EV_ABS, ABS_X, 32767}, {EV_ABS, ABS_Y, 32767}, {EV_ABS, ABS_RZ, 1023}, {EV_KEY, BTN_WEST, 1}});
  pad->read(state);
  EXPECT_EQ(state.left_x, 1.0);
  EXPECT_EQ(state.left_y, -1.0) << "the kernel's y is down";
  EXPECT_EQ(state.right_trigger, 1.0);
  EXPECT_EQ(state.buttons, 4U);
  ASSERT_TRUE(pad->rumble(1.0, 0.5, 0.06));
  ASSERT_TRUE(pad->rumble(0.0, 0.0, 0.06));
  const auto effects = uploaded();
  ASSERT_EQ(effects.size(), 2U);
  EXPECT_EQ(effects[0].type, FF_RUMBLE);
  EXPECT_EQ(effects[0].u.rumble.strong_magnitude, 65535);
  EXPECT_NEAR(effects[0].u.rumble.weak_magnitude, 32767, 1);
  EXPECT_EQ(effects[0].replay.length, 60) << "a program that dies shakes for no longer";
  EXPECT_EQ(effects[1].id, 3) << "the same effect, changed: a device holds few";
  EXPECT_EQ(effects[1].u.rumble.strong_magnitude, 0);
  input_event play{};
  ASSERT_TRUE(written(play));
  EXPECT_EQ(play.type, EV_FF);
  EXPECT_EQ(play.code, 3);
  EXPECT_EQ(play.value, 1);
  pad.reset();
  EXPECT_EQ(made_.removed, std::vector<int>{3});
}

TEST_F(EventPad, OneThatIsPulledOutIsNoticedAndOneOfAnotherKindOrWithoutMotorsIsSo) {
  made_.rumbles = false;
  EXPECT_EQ(system::pad_of_file(made_.file, PadKind::tablet), nullptr);
  const auto pad = system::pad_of_file(made_.file, PadKind::gamepad);
  ASSERT_NE(pad, nullptr);
  EXPECT_FALSE(pad->rumble(1.0, 1.0, 0.1));
  EXPECT_TRUE(uploaded().empty());
  PadState state;
  pad->read(state);
  EXPECT_TRUE(state.connected);
  // A read of an event device that is gone fails with ENODEV, one of a pipe's writing end with EBADF.
  int pipe[2] = {-1, -1};
  ASSERT_EQ(::pipe(pipe), 0);
  ASSERT_EQ(::dup2(pipe[1], made_.file), made_.file);
  pad->read(state);
  EXPECT_FALSE(state.connected);
  for (const int end : pipe) ::close(end);
}

TEST_F(EventPad, WhatIsHeldFromTheBeginningOrWasDroppedByTheKernelIsAskedFor) {
  made_.south = true;
  made_.trigger = 1023;
  const auto pad = system::pad_of_file(made_.file, PadKind::gamepad);
  PadState state;
  pad->read(state);
  EXPECT_EQ(state.buttons, 1U);
  EXPECT_EQ(state.right_trigger, 1.0);
  made_.south = false;
  made_.trigger = 0;
  pad->read(state);
  EXPECT_EQ(state.buttons, 1U) << "nobody has told";
  happen({{EV_SYN, SYN_DROPPED, 0}});
  pad->read(state);
  EXPECT_EQ(state.buttons, 0U);
  EXPECT_EQ(state.right_trigger, 0.0);
}

TEST_F(EventPad, AGamepadOnTheServoShakesWhenTheStoneIsMet) {
  auto pad = system::pad_of_file(made_.file, PadKind::gamepad);
  ASSERT_NE(pad, nullptr);
  const auto pad_device = make_pad_device(std::move(pad), PadKind::gamepad);
  Seqlock<State> state;
  Servo servo(*pad_device, patient(), window_on(sparsha::test::flat_scene()), state, {}, nullptr);
  servo.start();
  ASSERT_TRUE(eventually([&] { return (state.read().flags & kFlagArmed) != 0; }));
  EXPECT_TRUE(uploaded().empty()) << "in the air nothing shakes";
  happen({{EV_ABS, ABS_RZ, 900}});
  EXPECT_TRUE(eventually([&] {
    return std::ranges::any_of(uploaded(), [](const ff_effect& one) { return one.u.rumble.strong_magnitude > 13000; });
  }));
  servo.stop();
}

TEST_F(EventPad, ATabletsPenPressesByItsPressure) {
  made_.tablet = true;
  const auto pad = system::pad_of_file(made_.file, PadKind::tablet);
  ASSERT_NE(pad, nullptr);
  happen({{EV_KEY, BTN_TOOL_PEN, 1}, {EV_ABS, ABS_X, 16384}, {EV_ABS, ABS_Y, 0}, {EV_ABS, ABS_PRESSURE, 4096}});
  PadState state;
  pad->read(state);
  EXPECT_TRUE(state.pen_near);
  EXPECT_NEAR(state.pen_x, 0.5, 1e-4);
  EXPECT_EQ(state.pen_y, 1.0);
  EXPECT_NEAR(state.pressure, 0.5, 1e-3);
}

}  // namespace
}  // namespace sparsha::haptics
#endif
