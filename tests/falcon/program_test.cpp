// The program and a Falcon from plug to unplug, and every way out of it, judged from the bytes on the wire.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <thread>
#include <utility>

#include "tests/falcon/wire.h"
#include "tests/support/test_folder.h"

namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

class FalconProgram : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream scan(folder_ / "plane.xyz");
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 60; ++x) scan << x * 1e-3 << ' ' << y * 1e-3 << " 0\n";
  }
  void TearDown() override {
    if (runner_.joinable()) {
      if (explorer() > 0) ::kill(explorer(), SIGKILL);
      runner_.join();
    }
  }

  /// A speech program that writes down what it is to say.
  void install_voice() const {
    fs::create_directory(folder_ / "bin");
    const fs::path voice = folder_ / "bin" / "espeak-ng";
    std::ofstream(voice) << "#!/bin/sh\nexec cat >> '" << (folder_ / "spoken.txt").string() << "'\n";
    fs::permissions(voice, fs::perms::owner_all);
  }
  /// Starts the emulator and, on its bus, an exploration of a plane.
  void start(const std::string& faults, const std::string& more = "") {
    const std::string explore =
        std::string(SPARSHA_PROGRAM) + " explore plane.xyz --device falcon --headless --duration 150 " + more;
    const std::string command = "cd '" + folder_.path().string() + "' && env -u DISPLAY \"PATH=$PWD/bin:$PATH\" '" +
                                SPARSHA_PROGRAM + "' device emulate --log wire.csv " + faults +
                                " -- sh -c 'echo $$ > pid; exec " + explore + "' > out.txt 2> err.txt < /dev/null";
    runner_ = std::thread([this, command] {
      const int status = std::system(command.c_str());
      code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
      ended_ = true;
    });
  }
  [[nodiscard]] pid_t explorer() const {
    pid_t id = 0;
    std::ifstream(folder_ / "pid") >> id;
    return id;
  }
  [[nodiscard]] std::vector<wire::Event> events() const { return wire::read(folder_ / "wire.csv"); }
  [[nodiscard]] std::string text_of(const char* file) const {
    std::stringstream text;
    text << std::ifstream(folder_ / file).rdbuf();
    return text.str();
  }
  [[nodiscard]] std::string messages() const { return text_of("err.txt"); }
  [[nodiscard]] std::string output() const { return text_of("out.txt"); }
  /// `device emulate` with these arguments, to its end; its exit code.
  [[nodiscard]] int run(const std::string& arguments) const {
    const std::string command = "cd '" + folder_.path().string() + "' && XDG_CONFIG_HOME=. '" + SPARSHA_PROGRAM +
                                "' device emulate " + arguments + " > out.txt 2> err.txt < /dev/null";
    return WEXITSTATUS(std::system(command.c_str()));
  }
  /// A hundred packets with force since an event.
  [[nodiscard]] bool presses_since(std::size_t from) const {
    const auto all = events();
    return std::count_if(all.begin() + static_cast<std::ptrdiff_t>(std::min(from, all.size())), all.end(),
                         [](const wire::Event& event) { return event.kind == "out" && event.force(); }) > 100;
  }
  /// Where the first event of a kind is; 0: nowhere.
  [[nodiscard]] std::size_t first(const char* kind) const {
    const auto all = events();
    const auto found = std::find_if(all.begin(), all.end(), [&](const wire::Event& e) { return e.kind == kind; });
    return found == all.end() ? std::size_t{0} : static_cast<std::size_t>(found - all.begin());
  }
  /// True when the motors were last told to be off, or nothing can tell them anything any more.
  [[nodiscard]] bool off() const {
    const auto all = events();
    const auto last = std::find_if(all.rbegin(), all.rend(), [](const wire::Event& e) {
      return (e.kind == "out" && e.packet) || e.kind == "unplugged";
    });
    return last != all.rend() && !last->force();
  }
  /// A loaded machine is slow, and a test that fails may take long.
  [[nodiscard]] bool eventually(const std::function<bool()>& condition) const {
    for (int i = 0; i < 2400; ++i) {
      if (condition()) return true;
      if (ended_) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }
  int finish() {
    runner_.join();
    return code_;
  }
  /// No packet with force as long as not all encoders have said that they are homed, from each plugging in on.
  void expect_no_force_before_homing() const {
    bool homed = false;
    for (const wire::Event& event : events()) {
      if (event.kind == "unplugged") homed = false;
      if (event.kind == "in" && event.packet) homed = (event.flags >> 4U) == 7U;
      if (event.kind == "out" && event.force()) {
        ASSERT_TRUE(homed) << event.time_s;
      }
    }
  }

  const sparsha::test::TestFolder folder_;
  std::thread runner_;
  int code_ = -1;
  std::atomic<bool> ended_{false};
};

/// Ends an exploration that presses, by signals in this order.
class FalconWayOut : public FalconProgram, public testing::WithParamInterface<std::vector<int>> {};

TEST_P(FalconWayOut, EndsInZeroForceOnTheWire) {
  start("--fault warm-start");
  ASSERT_TRUE(eventually([&] { return presses_since(0); })) << messages();
  for (const int number : GetParam()) ::kill(explorer(), number);
  static_cast<void>(finish());
  EXPECT_TRUE(off());
  EXPECT_THAT(messages(), HasSubstr("motors off at the end"));
  expect_no_force_before_homing();
}

std::string name_of(const testing::TestParamInfo<std::vector<int>>& info) {
  std::string name;
  for (const int number : info.param) name += std::string("Sig") + ::sigabbrev_np(number);
  return name;
}

// SIGABRT is also how an exception that nobody catches ends.
INSTANTIATE_TEST_SUITE_P(falcon, FalconWayOut,
                         testing::Values(std::vector{SIGHUP}, std::vector{SIGQUIT}, std::vector{SIGTERM},
                                         std::vector{SIGINT, SIGINT}, std::vector{SIGABRT}, std::vector{SIGKILL}),
                         name_of);

TEST_F(FalconProgram, AStoppedProgramHoldsNoForceAndGoesOnAfterwards) {
  start("--fault warm-start");
  ASSERT_TRUE(eventually([&] { return presses_since(0); })) << messages();
  // A program that is stopped in the middle of a request holds umockdev up, as it never does a kernel: then once more.
  bool off_while_stopped = false;
  for (int attempt = 0; attempt < 10 && !off_while_stopped; ++attempt) {
    ::kill(explorer(), SIGSTOP);
    for (int look = 0; look < 20 && !off_while_stopped; ++look) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      off_while_stopped = off();
    }
    const std::size_t stopped = events().size();
    ::kill(explorer(), SIGCONT);
    EXPECT_TRUE(eventually([&] { return presses_since(stopped); })) << messages();
  }
  EXPECT_TRUE(off_while_stopped);
  ::kill(explorer(), SIGTERM);
  EXPECT_EQ(finish(), 0);
  EXPECT_TRUE(off());
}

// As when a lid is closed: the program and the guard of its force stop and go on together, and nothing has sent zeros.
TEST_F(FalconProgram, AMachineThatSleptInContactWakesWithZeroForceAndGoesOn) {
  start("--fault warm-start");
  ASSERT_TRUE(eventually([&] { return presses_since(0); })) << messages();
  std::vector<pid_t> sleepers{explorer()};
  const std::string id = std::to_string(explorer());
  std::ifstream children("/proc/" + id + "/task/" + id + "/children");
  for (pid_t child = 0; children >> child;) sleepers.push_back(child);
  ASSERT_GE(sleepers.size(), 2U) << "the guard";
  for (auto sleeper = sleepers.rbegin(); sleeper != sleepers.rend(); ++sleeper) ::kill(*sleeper, SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  const std::size_t asleep = events().size();
  for (const pid_t sleeper : sleepers) ::kill(sleeper, SIGCONT);
  EXPECT_TRUE(eventually([&] { return presses_since(asleep); })) << messages();
  int forces = 0;  // what was on its way when the machine fell asleep
  const auto all = events();
  for (std::size_t i = asleep; i < all.size(); ++i) {
    if (all[i].kind != "out" || !all[i].packet) continue;
    if (!all[i].force()) break;
    ++forces;
  }
  EXPECT_LE(forces, 1);
  ::kill(explorer(), SIGTERM);
  EXPECT_EQ(finish(), 0);
  EXPECT_TRUE(off());
}

TEST_F(FalconProgram, IsLoadedHomedTouchedUnpluggedInContactPluggedInAgainAndTouchedAgain) {
  install_voice();
  start("--fault unplug --fault bad-echo --fault deaf --fault late-arm", "--speech");
  ASSERT_TRUE(eventually([&] { return first("plugged") > 0; })) << messages();
  const std::size_t plugged = first("plugged");
  EXPECT_TRUE(eventually([&] { return presses_since(plugged); })) << messages();
  // The person clicks the grip's centre between two touches.
  EXPECT_TRUE(eventually([&] { return text_of("spoken.txt").find("of the stone") != std::string::npos; }))
      << text_of("spoken.txt");
  EXPECT_THAT(text_of("spoken.txt"), HasSubstr("the right arm is missing"));
  ::kill(explorer(), SIGTERM);
  EXPECT_EQ(finish(), 0);
  EXPECT_TRUE(off());
  expect_no_force_before_homing();
  const std::string said = messages();
  EXPECT_THAT(said, HasSubstr("loading the Falcon's firmware"));
  EXPECT_THAT(said, HasSubstr("pull the grip fully out"));
  EXPECT_THAT(said, HasSubstr("the right arm is missing"));
  EXPECT_THAT(said, HasSubstr("unplugged; forces are off"));
  EXPECT_THAT(said, Not(HasSubstr("Another program holds the Falcon")));
}

TEST_F(FalconProgram, ItsPowerSupplyIsPulledInContactAndPluggedInAgainAndItIsTouchedAgain) {
  start("--fault power-cut");
  ASSERT_TRUE(eventually([&] { return first("power-on") > 0; })) << messages();
  const std::size_t back = first("power-on");
  EXPECT_TRUE(eventually([&] { return presses_since(back); })) << messages();
  ::kill(explorer(), SIGTERM);
  EXPECT_EQ(finish(), 0);
  EXPECT_TRUE(off());
  const std::string said = messages();
  EXPECT_THAT(said, HasSubstr("The Falcon does not answer: check its power"));
  EXPECT_THAT(said, Not(HasSubstr("plug in its USB cable"))) << "that is in";
}

TEST_F(FalconProgram, KilledWhileTheMotorsCannotBeReachedLeavesAGuardThatEndsTheirForce) {
  start("--fault warm-start --fault dead-port");
  ASSERT_TRUE(eventually([&] { return messages().find("unplugged; forces are off") != std::string::npos; }))
      << messages();
  ::kill(explorer(), SIGKILL);
  static_cast<void>(finish());
  EXPECT_THAT(messages(), HasSubstr("motors off at the end"));
}

TEST_F(FalconProgram, EndedWhileTheMotorsCannotBeReachedLeavesTheirForceToTheGuard) {
  start("--fault warm-start --fault dead-port");
  ASSERT_TRUE(eventually([&] { return presses_since(0); })) << messages();
  std::size_t seen = 0;
  ASSERT_TRUE(eventually([&] {  // nothing passes for a quarter of a second
    std::this_thread::sleep_for(std::chrono::milliseconds(250));
    const std::size_t now = events().size();
    return std::exchange(seen, now) == now;
  }));
  ::kill(explorer(), SIGTERM);
  EXPECT_EQ(finish(), 0);
  EXPECT_THAT(messages(), HasSubstr("motors off at the end"));
}

TEST_F(FalconProgram, IsFeltThroughABadLink) {
  start(
      "--fault warm-start --fault split-packets --fault garbage --fault lost-bytes --fault failed-transfers "
      "--fault second-falcon");
  EXPECT_TRUE(eventually([&] { return presses_since(0); })) << messages();
  ::kill(explorer(), SIGTERM);
  EXPECT_EQ(finish(), 0);
  EXPECT_TRUE(off());
}

TEST_F(FalconProgram, AnotherProgramOnPlainLibusbNamesLoadsHomesItAndReadsItsButtons) {
  EXPECT_EQ(run(std::string("-- '") + PLAIN_USB + "'"), 0) << output();
  EXPECT_EQ(output(), "product FALCON HAPTIC\nlatency 1\nhomed\nbuttons 4\n");
}

TEST_F(FalconProgram, AProgramThatLeavesTheMotorsOnIsADeviceErrorWhateverItReturns) {
  EXPECT_EQ(run(std::string("-- '") + PLAIN_USB + "' leave-force"), 4) << output();
  EXPECT_THAT(messages(), HasSubstr("motors ON at the end"));
}

TEST_F(FalconProgram, HomingIsGuidedByWordsThatNameTheMissingArm) {
  EXPECT_EQ(run("--fault late-arm -- '" + std::string(SPARSHA_PROGRAM) + "' device home"), 0) << messages();
  EXPECT_EQ(output(), "homed\n");
  EXPECT_THAT(messages(), HasSubstr("Homing: pull the grip fully out, then push it fully in"));
  EXPECT_THAT(messages(), HasSubstr("Homing: the right arm is missing"));
}

TEST_F(FalconProgram, TheCheckEndsInAVerdictAsJson) {
  const int code = run("--fault warm-start -- '" + std::string(SPARSHA_PROGRAM) + "' --json device check --duration 1");
  const std::string json = output();
  for (const char* step : {"USB", "permission", "power", "firmware", "homing", "link"})
    EXPECT_THAT(json, HasSubstr("\"step\": \"" + std::string(step) + "\"")) << json;
  const bool insufficient = json.find("\"verdict\": \"insufficient\"") != std::string::npos;  // a loaded machine
  EXPECT_EQ(code, insufficient ? 4 : 0) << json;
  EXPECT_EQ(json.find("\"passed\": true") != std::string::npos, !insufficient) << json;
}

TEST_F(FalconProgram, WithoutPowerARunOfFixedLengthEndsWithTheRemedy) {
  EXPECT_EQ(run("--fault no-power -- '" + std::string(SPARSHA_PROGRAM) +
                "' explore plane.xyz --device falcon --headless --duration 1"),
            4);
  EXPECT_THAT(messages(), HasSubstr("the Falcon's own power supply plugged in"));
}

TEST_F(FalconProgram, AnInterruptEndsTheAttemptsToLoadFirmware) {
  start("--fault no-power");
  ASSERT_TRUE(eventually([&] { return messages().find("loading the Falcon's firmware") != std::string::npos; }));
  ::kill(explorer(), SIGINT);
  EXPECT_EQ(finish(), 1);
  EXPECT_THAT(messages(), Not(HasSubstr("attempts)"))) << "all ten of them";
}

TEST_F(FalconProgram, TheEmulatorRunsAnyProgramWithItsDashesAndGivesItsExitCode) {
  EXPECT_EQ(run("-- sh -c 'exit 7'"), 7);
  EXPECT_EQ(run("-- sh -c 'kill -TERM $$'"), 128 + SIGTERM);
  EXPECT_EQ(run("-- ./no-such-program"), 2);
  // ALSA looks for more sound cards than umockdev has room for.
  EXPECT_EQ(run("-- '" + std::string(SPARSHA_PROGRAM) + "' explore --list-audio"), 0);
  EXPECT_EQ(run("--fault sparks -- true"), 2);
  EXPECT_THAT(messages(), HasSubstr("lost-bytes | "));
  ::setenv("TMPDIR", "/no-such-folder", 1);
  EXPECT_EQ(run("-- true"), 1);
  ::unsetenv("TMPDIR");
  EXPECT_THAT(messages(), HasSubstr("no folder for temporary files"));
  EXPECT_EQ(run("--log /dev/full -- true"), 1) << "a promised log that is not there";
  EXPECT_EQ(run("-- sh -c 'test -s \"$SPARSHA_FALCON_FIRMWARE\"'"), 0);
  EXPECT_EQ(run("--fault second-falcon -- '" + std::string(SPARSHA_PROGRAM) + "' device list"), 0);
  EXPECT_THAT(output(), HasSubstr("address 5"));
  EXPECT_THAT(output(), HasSubstr("address 6"));
}

TEST_F(FalconProgram, AKilledProgramHoldsTheEmulatedFalconNoLonger) {
  const std::string monitor = "'" + std::string(SPARSHA_PROGRAM) + "' device monitor";
  std::ofstream(folder_ / "twice.sh") << monitor
                                      << " --duration 60 > first.txt & while ! test -s first.txt; do sleep 0.05; done\n"
                                      << "kill -9 $!; wait $!; exec " << monitor << " --duration 0.2\n";
  EXPECT_EQ(run("-- sh twice.sh"), 0) << messages();
}

TEST_F(FalconProgram, TheMonitorEndsWhenNobodyReadsAnyMore) {
  // Without an end of its own: it must not go on for ever behind `head`.
  EXPECT_EQ(run("--fault warm-start -- sh -c \"'" + std::string(SPARSHA_PROGRAM) + "' device monitor | head -1\""), 0);
  EXPECT_THAT(output(), HasSubstr("answers/s"));
  EXPECT_THAT(messages(), Not(HasSubstr("standard output"))) << "who closes a pipe has what was wanted";
}

/// That the emulator tells of the last command; not a number where it tells none.
double requests_of(const std::string& messages) {
  const std::size_t end = messages.find(" requests of the bus for each");
  if (end == std::string::npos) return std::numeric_limits<double>::quiet_NaN();
  return std::stod(messages.substr(messages.rfind(' ', end - 1) + 1));
}

TEST_F(FalconProgram, InTurnsWithALoopLikeLibnifalconsExploreIsNoSlowerAndAsksLessOfTheBus) {
  if (std::getenv("SPARSHA_NIGHTLY") == nullptr) GTEST_SKIP() << "half a minute, with SPARSHA_NIGHTLY=1";
  double other_hz = 0.0, own_hz = 0.0;
  constexpr int kTurns = 3;
  for (int turn = 0; turn < kTurns; ++turn) {
    ASSERT_EQ(run("-- " PLAIN_USB " turn"), 0) << output();
    double rate_hz = 0.0;
    const std::string told = output();
    ASSERT_EQ(std::sscanf(told.c_str() + std::min(told.size(), told.find("turn ")), "turn %lf", &rate_hz), 1) << told;
    other_hz += rate_hz / kTurns;
    const double other_requests = requests_of(messages());
    ASSERT_EQ(run("--fault warm-start -- '" + std::string(SPARSHA_PROGRAM) +
                  "' explore plane.xyz --device falcon --headless --duration 4 --json"),
              0)
        << messages();
    const std::string summary = output();
    ASSERT_EQ(
        std::sscanf(summary.c_str() + std::min(summary.size(), summary.find("\"ticks\"")), "\"ticks\": %lf", &rate_hz),
        1)
        << summary;
    own_hz += rate_hz / 4.0 / kTurns;
    EXPECT_LT(requests_of(messages()), other_requests) << "an answer";
  }
  EXPECT_GE(own_hz, 0.9 * other_hz);
  std::printf("%.0f ticks/s, the other %.0f answers/s\n", own_hz, other_hz);
}

TEST_F(FalconProgram, ACalibrationThatCannotBeKeptIsNotBegun) {
  std::ofstream(folder_ / "sparsha") << "in the way";  // of the folder of that name
  EXPECT_EQ(run("--weight-g 200 -- '" + std::string(SPARSHA_PROGRAM) + "' device calibrate"), 1);
  EXPECT_THAT(messages(), HasSubstr("cannot create the folder"));
  EXPECT_THAT(messages(), HasSubstr(" 0 commands"));
}

/// Each fault by itself: the stone is felt all the same, and no force is left.
class FalconFault : public FalconProgram, public testing::WithParamInterface<const char*> {};

TEST_P(FalconFault, IsLivedThroughAndLeavesNoForce) {
  if (std::getenv("SPARSHA_NIGHTLY") == nullptr) GTEST_SKIP() << "each fault only with SPARSHA_NIGHTLY=1";
  start(std::string("--fault ") + GetParam());
  // Of answers that are 1 to 20 ms late, each on its own, some come more than 10 ms after the one before: the force is
  // off then, and the visitor is told.
  const bool late = std::string(GetParam()) == "late-answers";
  EXPECT_TRUE(eventually([&] {
    return presses_since(0) || (late && messages().find("The stone went soft for a moment") != std::string::npos);
  })) << messages();
  ::kill(explorer(), SIGTERM);
  EXPECT_EQ(finish(), 0) << messages();
  EXPECT_TRUE(off());
  expect_no_force_before_homing();
}

INSTANTIATE_TEST_SUITE_P(falcon, FalconFault,
                         testing::Values("bad-echo", "lost-bytes", "lost-answers", "split-packets", "garbage", "stall",
                                         "silence", "failed-transfers", "late-answers", "unplug", "three-tries", "deaf",
                                         "second-falcon", "power-cut", "dead-port", "late-arm"),
                         [](const auto& fault) {
                           std::string name = fault.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
