// Plug-ins that crash, hang and lie, under the servo. The judge is a motor that holds its last force.
#include "haptics/device/plugin/plugin.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/error.h"
#include "haptics/conformance/conformance.h"
#include "haptics/servo/servo.h"
#include "tests/support/servo_parts.h"
#include "tests/support/test_folder.h"

namespace sparsha::haptics::plugin {
namespace {
using ::testing::HasSubstr;

struct Motor {
  std::atomic<std::uint64_t> micronewtons, strongest, opened, closed, zeros, faults, reads;
};

class Plugin : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string file = (folder_.path() / "motor").string();
    const int number = ::open(file.c_str(), O_RDWR | O_CREAT, 0600);
    ASSERT_GE(number, 0);
    ASSERT_EQ(::ftruncate(number, 4096), 0);
    motor_ = static_cast<Motor*>(::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, number, 0));
    ::close(number);
    ::setenv("SPARSHA_TEST_MOTOR", file.c_str(), 1);
  }
  void TearDown() override {
    ::munmap(motor_, 4096);
    ::unsetenv("SPARSHA_TEST_PLUGIN");
  }
  static std::unique_ptr<Device> faulty(const char* fault) {
    ::setenv("SPARSHA_TEST_PLUGIN", fault, 1);
    return make_plugin_device(FAULTY_PLUGIN);
  }
  static std::string refusal(const char* fault) {
    try {
      static_cast<void>(faulty(fault));
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::device);
      return error.wrong();
    }
    return "it was taken";
  }
  [[nodiscard]] bool off() const {
    return eventually([&] { return motor_->micronewtons.load() == 0; });
  }

  sparsha::test::TestFolder folder_;
  Motor* motor_ = nullptr;
};

/// A servo on a plane, with a motor that pushes.
struct Running {
  explicit Running(Device& device)
      : servo(device, patient(0.2), window_on(sparsha::test::flat_scene()), state, {}, nullptr) {
    servo.start();
  }
  ~Running() { servo.stop(); }
  Seqlock<State> state;
  Servo servo;
};

TEST_F(Plugin, IsFeltAndEndsInZero) {
  const auto device = faulty("");
  EXPECT_EQ(device->info().name, "faulty");
  EXPECT_EQ(device->info().limits.max_force_n, 4.0);
  EXPECT_NEAR(device->info().limits.encoder_step_m, 150e-6, 1e-12);
  {
    Running run(*device);
    ASSERT_TRUE(eventually([&] { return motor_->micronewtons.load() > 300'000; }));
    EXPECT_EQ(device->advice(), nullptr);
  }
  EXPECT_TRUE(off());
  EXPECT_LE(motor_->strongest.load(), 4'000'000U);
}

TEST_F(Plugin, TheExampleIsFelt) {
  const auto device = make_plugin_device(EXAMPLE_PLUGIN);
  EXPECT_EQ(device->info().name, "a hand in a plug-in");
  const Running run(*device);
  EXPECT_TRUE(eventually([&] { return run.state.read().commanded_force_n[2] > 0.2; }));
  EXPECT_EQ(run.servo.jumps(), 0U);
}

TEST_F(Plugin, AClosedDeviceHasBeenToldSo) {
  faulty("").reset();
  EXPECT_EQ(motor_->closed.load(), 1U);
  EXPECT_GE(motor_->zeros.load(), 1U);
  EXPECT_EQ(motor_->opened.load(), 1U);
}

TEST_F(Plugin, OneThatCannotBeUsedSaysWhy) {
  EXPECT_THAT(refusal("wrong-version"), HasSubstr("written for version 99 of sparsha/device_plugin.h, and this is 1"));
  EXPECT_THAT(refusal("refuses"), HasSubstr("the plug-in cannot open its device: its cable is not plugged in"));
  EXPECT_THAT(refusal("no-table"), HasSubstr("sparsha_device_plugin_entry"));
  EXPECT_THAT(refusal("no-zero"), HasSubstr("a function of its table is missing"));
  EXPECT_THAT(refusal("no-info"), HasSubstr("info() fails"));
  EXPECT_THAT(refusal("odd-rate"), HasSubstr("its rate of 50 Hz"));
  EXPECT_THAT(refusal("crashes-at-open"), HasSubstr("crashed while it was opened (signal 6)"));
  EXPECT_THROW(static_cast<void>(make_plugin_device("no-such.so")), Error);
  EXPECT_THROW(static_cast<void>(make_plugin_device(__FILE__)), Error) << "no library";
}

TEST_F(Plugin, ItsWordsAreTextAndWhatItPrintsIsNoOutputOfTheProgram) {
  EXPECT_EQ(faulty("odd-name")->info().name, "no\\xff name\\u000aerror: at all");
  ::testing::internal::CaptureStdout();
  {
    const auto device = faulty("prints");
    const Running run(*device);
    EXPECT_TRUE(eventually([&] { return motor_->reads.load() > 50; }));
  }
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}

TEST_F(Plugin, ForcesThatItDoesNotTakeEndAndAreTold) {
  const auto device = faulty("refuses-forces");
  Running run(*device);
  ASSERT_TRUE(eventually([&] { return device->advice() != nullptr; }));
  EXPECT_STREQ(device->advice()->phrase, "plugin_refuses");
  EXPECT_TRUE(eventually([&] { return (run.state.read().flags & kFlagHomed) == 0; }));
  // Nothing is asked for while it is told.
  const std::uint64_t refused = motor_->faults.load();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_LE(motor_->faults.load(), refused + 2);
}

TEST_F(Plugin, ACrashEndsInAMotorThatIsOffAndInWords) {
  const bool nightly = std::getenv("SPARSHA_NIGHTLY") != nullptr;
  const std::vector<const char*> some{"crashes", "ends"}, all{"crashes", "crashes-in-write", "ends"};
  for (const char* fault : nightly ? all : some) {
    SCOPED_TRACE(fault);
    new (motor_) Motor{};
    const auto device = faulty(fault);
    Running run(*device);
    ASSERT_TRUE(eventually([&] { return run.servo.unplugged(); }));
    EXPECT_TRUE(off()) << "the motor held its force: another process has opened it and switched it off";
    EXPECT_TRUE(eventually([&] { return motor_->opened.load() == 2; }));
    ASSERT_NE(device->advice(), nullptr);
    EXPECT_STREQ(device->advice()->phrase, "plugin_ended");
    EXPECT_TRUE(device->advice()->needed);
  }
}

TEST_F(Plugin, AHangEndsInAMotorThatIsOffBeforeItsProcessIsKilled) {
  const auto device = faulty("hangs");
  Running run(*device);
  ASSERT_TRUE(eventually([&] { return motor_->faults.load() > 0; }));
  ASSERT_TRUE(eventually([&] { return motor_->zeros.load() > 0; }));
  EXPECT_TRUE(off());
  ASSERT_TRUE(eventually([&] { return run.servo.unplugged(); })) << "killed";
  EXPECT_STREQ(device->advice()->phrase, "plugin_silent");
  EXPECT_EQ(motor_->micronewtons.load(), 0U);
}

/// A process that this one, or that one, has started.
pid_t child_of(pid_t parent) {
  for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(parent) + "/task")) {
    pid_t child = 0;
    if (std::ifstream(task.path() / "children") >> child) return child;
  }
  return 0;
}

TEST_F(Plugin, ASupervisorThatIsKilledLeavesAMotorThatIsOffAndNoProcess) {
  for (const char* fault : {"", "hangs"}) {
    SCOPED_TRACE(fault);
    new (motor_) Motor{};
    const auto device = faulty(fault);
    Running run(*device);
    const pid_t supervisor = child_of(::getpid());
    const pid_t worker = child_of(supervisor);
    if (supervisor == 0 || worker == 0) GTEST_SKIP() << "this kernel does not tell the children of a process";
    const bool hangs = *fault != '\0';
    ASSERT_TRUE(eventually([&] { return hangs ? motor_->faults.load() > 0 : motor_->micronewtons.load() > 300'000; }));
    ASSERT_EQ(::kill(supervisor, SIGKILL), 0);
    EXPECT_TRUE(off());
    EXPECT_TRUE(eventually([&] { return run.servo.unplugged(); }));
    ASSERT_NE(device->advice(), nullptr);
    // One that hangs may have been killed before its supervisor was.
    EXPECT_THAT(device->advice()->phrase, ::testing::AnyOf(::testing::StrEq("plugin_ended"),
                                                           ::testing::StrEq(hangs ? "plugin_silent" : "plugin_ended")));
    EXPECT_TRUE(eventually([&] { return ::kill(worker, 0) != 0; })) << "the worker is left";
    EXPECT_EQ(motor_->micronewtons.load(), 0U);
  }
}

TEST_F(Plugin, OneThatLiesGetsNoForceAndIsNamed) {
  for (const char* fault : {"no-number", "jumps", "stands-still", "fails"}) {
    SCOPED_TRACE(fault);
    new (motor_) Motor{};
    const auto device = faulty(fault);
    Running run(*device);
    ASSERT_TRUE(eventually([&] { return motor_->faults.load() > 0; }));
    EXPECT_TRUE(off());
    const std::string name = fault;
    EXPECT_TRUE(eventually([&] {
      return (name != "no-number" || run.servo.bad_positions() > 0) && (name != "jumps" || run.servo.jumps() > 0) &&
             (name != "fails" || run.servo.unplugged());
    }));
  }
}

TEST_F(Plugin, AnotherRateThanItSaysEndsTheForce) {
  const auto device = faulty("wrong-rate");
  Running run(*device);
  ASSERT_TRUE(eventually([&] { return device->advice() != nullptr; }));
  EXPECT_STREQ(device->advice()->phrase, "plugin_wrong");
  EXPECT_TRUE(off());
  EXPECT_TRUE(eventually([&] { return (run.state.read().flags & kFlagHomed) == 0; }));
}

TEST_F(Plugin, AWorkspaceThatCannotBeIsNoForce) {
  const auto device = faulty("no-workspace");
  EXPECT_EQ(device->info().limits.max_force_n, 0.0);
  EXPECT_THAT(device->info().warning, HasSubstr("workspace"));
}

/// Another program that presses, for a minute unless it is ended.
pid_t program_with_a_hand_in_the_stone() {
  ::setenv("SPARSHA_TEST_PLUGIN", "", 1);
  const pid_t program = ::fork();
  if (program != 0) return program;
  const auto device = make_plugin_device(FAULTY_PLUGIN);
  const Running run(*device);
  std::this_thread::sleep_for(std::chrono::seconds(60));
  ::_exit(0);
}

TEST_F(Plugin, AProgramThatIsKilledLeavesTheMotorOff) {
  const pid_t program = program_with_a_hand_in_the_stone();
  ASSERT_TRUE(eventually([&] { return motor_->micronewtons.load() > 300'000; }));
  ::kill(program, SIGKILL);
  int status = 0;
  ::waitpid(program, &status, 0);
  EXPECT_TRUE(off());
  EXPECT_TRUE(eventually([&] { return motor_->closed.load() == 1; }));
}

TEST_F(Plugin, AProgramThatIsStoppedHoldsNoForce) {
  const pid_t program = program_with_a_hand_in_the_stone();
  ASSERT_TRUE(eventually([&] { return motor_->micronewtons.load() > 300'000; }));
  ::kill(program, SIGSTOP);
  EXPECT_TRUE(off());
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(motor_->micronewtons.load(), 0U);
  ::kill(program, SIGKILL);
  int status = 0;
  ::waitpid(program, &status, 0);
}

TEST_F(Plugin, OneThatDoesRightConforms) {
  if (std::getenv("SPARSHA_NIGHTLY") == nullptr) GTEST_SKIP() << "three seconds, with SPARSHA_NIGHTLY=1";
  ::setenv("SPARSHA_TEST_PLUGIN", "", 1);
  const std::shared_ptr<Device> device = make_plugin_device(FAULTY_PLUGIN);
  ConformanceOptions options;
  options.watch_s = 0.5;
  options.patience_s = 0.3;
  for (const ConformanceStep& step : watch_device(device, options))
    EXPECT_EQ(step.result, ConformanceStep::Result::passed) << step.name << ": " << step.found;
  options.faults = {Fault::early, Fault::silent};
  for (const ConformanceStep& step : try_faults(*device, options))
    EXPECT_EQ(step.result, ConformanceStep::Result::passed) << step.name << ": " << step.found << step.to_a_hand;
}

}  // namespace
}  // namespace sparsha::haptics::plugin
