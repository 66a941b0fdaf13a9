// Keys without a window: what they mean, and a terminal that is as it was whichever way the program ends.
#include "app/terminal/terminal_keys.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/app/program.h"
#include "tests/support/sanitized.h"

namespace sparsha {
namespace {

using haptics::Request;
using Kind = Request::Kind;

class Keys : public ::testing::Test {
 protected:
  /// What comes of typing this, one look every 10 ms, for so long.
  std::vector<Kind> type(const std::string& typed, double then_s = 0.01) {
    std::vector<Kind> kinds;
    std::string now = typed;
    for (double t = 0.0; t < then_s; t += 0.01, now.clear(), time_s_ += 0.01)
      for (const Request& request : keys_.take(typed_.take(now, time_s_), time_s_)) {
        kinds.push_back(request.kind);
        last_ = request;
      }
    return kinds;
  }
  /// A key that repeats as keyboards do.
  std::vector<Kind> hold(const std::string& key, double seconds) {
    std::vector<Kind> kinds = type(key, 0.3);
    for (double t = 0.3; t < seconds; t += 0.03)
      for (const Kind kind : type(key, 0.03)) kinds.push_back(kind);
    return kinds;
  }
  app::TypedKeys typed_;
  app::TerminalKeys keys_;
  double time_s_ = 100.0;
  Request last_;
};
using Kinds = std::vector<Kind>;

TEST_F(Keys, LettersActAtOnceAndUnknownOnesDoNothing) {
  EXPECT_EQ(type("+-NpW hR<>vsTq"),
            (Kinds{Kind::zoom_in, Kind::zoom_out, Kind::next_part, Kind::previous_part, Kind::whole_scene,
                   Kind::describe, Kind::help_keys, Kind::repeat, Kind::speak_slower, Kind::speak_faster,
                   Kind::next_voice, Kind::toggle_speech, Kind::tour, Kind::quit}));
  EXPECT_EQ(type("aei\xff\x01\x1b[15~\x1bOP\x1b"), Kinds{});
  EXPECT_EQ(type("\x1b[A"), Kinds{Kind::pan});
  EXPECT_GT(last_.y, 0.0) << "up";
  EXPECT_EQ(type("\x1bOD"), Kinds{Kind::pan});
  EXPECT_LT(last_.x, 0.0) << "left";
}

TEST_F(Keys, FourKeysOfAPadClickWhenPressedOnceAndHoldWhenPressedTwice) {
  EXPECT_EQ(type("1", 1.0), Kinds{Kind::zoom_in});
  EXPECT_EQ(type("4", 1.0), Kinds{Kind::zoom_out});
  EXPECT_EQ(type("2", 1.0), Kinds{Kind::whole_scene});
  EXPECT_EQ(type("3", 1.0), Kinds{Kind::describe});
  type("1", 0.2);
  EXPECT_EQ(type("1", 1.0), Kinds{Kind::next_part});
  type("4", 0.2);
  EXPECT_EQ(type("4", 1.0), Kinds{Kind::previous_part});
  type("3", 0.2);
  EXPECT_EQ(type("3", 1.0), Kinds{Kind::help});
  EXPECT_EQ(type("14", 1.0), (Kinds{Kind::zoom_in, Kind::zoom_out})) << "two keys are two clicks";
}

TEST_F(Keys, AKeyOfAPadThatIsHeldMeansItOnce) {
  EXPECT_EQ(hold("1", 1.5), Kinds{Kind::next_part});
  EXPECT_EQ(type("", 1.0), Kinds{});
  EXPECT_EQ(hold("3", 1.5), Kinds{Kind::help});
  type("", 1.0);
  EXPECT_EQ(hold("3", 4.0), (Kinds{Kind::help, Kind::set_speech})) << "2 s, as on the grip";
  EXPECT_TRUE(last_.on);
  type("", 1.0);
  EXPECT_EQ(hold("3", 6.0), (Kinds{Kind::help, Kind::set_speech, Kind::set_speech})) << "and 5 s";
  EXPECT_FALSE(last_.on);
  type("", 1.0);
  EXPECT_EQ(hold("4", 4.0), (Kinds{Kind::previous_part, Kind::guide})) << "likewise";
  EXPECT_EQ(type("g", 1.0), Kinds{Kind::guide});
}

TEST_F(Keys, ThePadsSecondKeyTakesTheStoneAndLetsItGo) {
  type("2", 0.2);
  EXPECT_EQ(type("2", 1.0), Kinds{Kind::drag});
  EXPECT_TRUE(last_.on);
  EXPECT_EQ(hold("2", 1.0), Kinds{Kind::drag});
  EXPECT_FALSE(last_.on);
  EXPECT_EQ(type("", 1.0), Kinds{});
  EXPECT_EQ(type("2", 1.0), Kinds{Kind::whole_scene});
}

/// The program at a terminal of the test's own.
class AtATerminal : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    master_ = posix_openpt(O_RDWR | O_NOCTTY);
    ASSERT_GE(master_, 0);
    ASSERT_EQ(grantpt(master_), 0);
    ASSERT_EQ(unlockpt(master_), 0);
    slave_ = ptsname(master_);
    kept_ = open(slave_.c_str(), O_RDWR | O_NOCTTY);  // or the terminal goes with the program
    ASSERT_EQ(tcgetattr(kept_, &before_), 0);
    ASSERT_EQ(run("build " + relief_ + " --out scene").code, 0);
  }
  void TearDown() override {
    if (child_ > 0) {
      ::kill(child_, SIGKILL);
      waitpid(shell_ > 0 ? shell_ : child_, nullptr, 0);
    }
    if (reports_ >= 0) close(reports_);
    close(kept_);
    close(master_);
  }
  void start(const char* device = "simulated") {
    const std::string scene = (folder_ / "scene").string();
    child_ = fork();
    ASSERT_GE(child_, 0);
    if (child_ == 0) {
      take_terminal();
      if (studies_ && chdir(folder_.path().c_str()) != 0) _exit(126);
      become_program(scene, device, studies_ ? "--study" : nullptr);
    }
    ASSERT_TRUE(shows("Whole stone")) << seen_;
    ASSERT_FALSE(same_as_before()) << "keys are read one by one";
  }
  /// The program as a job of a shell: in a group of its own, whose parent leads the session and can continue it.
  /// Without one the system does not let a program be stopped from its terminal.
  void start_under_a_shell() {
    const std::string scene = (folder_ / "scene").string();
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    shell_ = fork();
    ASSERT_GE(shell_, 0);
    if (shell_ == 0) {
      close(ends[0]);
      take_terminal();
      std::signal(SIGTTOU, SIG_IGN);  // the terminal may be handed over
      const pid_t program = fork();
      if (program == 0) {
        close(ends[1]);
        setpgid(0, 0);
        tcsetpgrp(0, getpid());
        std::signal(SIGTTOU, SIG_DFL);
        become_program(scene, "simulated");
      }
      int told = program;
      do {
        if (::write(ends[1], &told, sizeof told) != static_cast<ssize_t>(sizeof told)) _exit(1);
      } while (waitpid(program, &told, WUNTRACED) == program);
      _exit(0);
    }
    close(ends[1]);
    reports_ = ends[0];
    child_ = next_report();
    ASSERT_GT(child_, 0);
    ASSERT_TRUE(shows("Whole stone")) << seen_;
    ASSERT_FALSE(same_as_before()) << "keys are read one by one";
  }
  /// What the shell tells next: the program's number, then each status of its; -1 after 20 s without one.
  int next_report() {
    for (int i = 0; i < 2000; ++i) {
      pollfd inputs[2] = {{reports_, POLLIN, 0}, {master_, POLLIN, 0}};
      ::poll(inputs, 2, 10);
      char block[4096];
      if ((inputs[1].revents & POLLIN) != 0 && read(master_, block, sizeof block) < 0) break;
      int told = 0;
      if ((inputs[0].revents & (POLLIN | POLLHUP)) != 0)
        return read(reports_, &told, sizeof told) == static_cast<ssize_t>(sizeof told) ? told : -1;
    }
    return -1;
  }
  void type(const std::string& keys) {
    ASSERT_EQ(::write(master_, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
  }
  /// Waits until the terminal has shown `text`, 20 s at most, or so many times 10 ms.
  bool shows(const std::string& text, int looks = 2000) { return shows_one_of({text}, looks); }
  bool shows_one_of(const std::vector<std::string>& texts, int looks = 2000) {
    const auto shown = [&] {
      return std::any_of(texts.begin(), texts.end(),
                         [&](const std::string& text) { return seen_.find(text) != std::string::npos; });
    };
    for (int i = 0; i < looks && !shown(); ++i) {
      pollfd input{master_, POLLIN, 0};
      char block[4096];
      if (::poll(&input, 1, 10) > 0)
        if (const ssize_t got = read(master_, block, sizeof block); got > 0)
          seen_.append(block, static_cast<std::size_t>(got));
    }
    return shown();
  }
  /// Its status when it has ended, 20 s at most; what it writes meanwhile is read.
  int exit_status() {
    int status = 0;
    for (int i = 0; i < 2000; ++i) {
      if (waitpid(child_, &status, WNOHANG) == child_) {
        child_ = 0;
        return status;
      }
      pollfd input{master_, POLLIN, 0};
      char block[4096];
      if (::poll(&input, 1, 10) > 0 && read(master_, block, sizeof block) < 0) break;
    }
    return -1;
  }
  /// In a new process: the leader of a session whose terminal is the test's.
  void take_terminal() const {
    setsid();
    const int terminal = open(slave_.c_str(), O_RDWR);  // becomes the controlling one
    for (const int stream : {0, 1, 2}) dup2(terminal, stream);
    for (const int other : {terminal, master_, kept_}) close(other);
  }
  [[noreturn]] static void become_program(const std::string& scene, const char* device, const char* study = nullptr) {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    execl(SPARSHA_PROGRAM, SPARSHA_PROGRAM, "explore", scene.c_str(), "--headless", "--device", device, "--duration",
          "1000", study, "visitors", nullptr);
    _exit(127);
  }
  [[nodiscard]] bool same_as_before() const {
    termios now{};
    EXPECT_EQ(tcgetattr(kept_, &now), 0);
    return now.c_lflag == before_.c_lflag && now.c_iflag == before_.c_iflag && now.c_oflag == before_.c_oflag &&
           std::memcmp(now.c_cc, before_.c_cc, sizeof now.c_cc) == 0;
  }

  int master_ = -1;
  int kept_ = -1;
  int reports_ = -1;
  std::string slave_;
  termios before_{};
  pid_t child_ = 0;
  bool studies_ = false;
  pid_t shell_ = 0;  // the child's parent where it has one
  std::string seen_;
};

TEST_F(AtATerminal, KeysExploreAndEveryAnnouncementIsALine) {
  start();
  type("+");
  EXPECT_TRUE(shows("Closer, ")) << seen_;
  type("h");
  EXPECT_TRUE(shows("Plus and minus")) << seen_;
  type(" ");
  EXPECT_TRUE(shows_one_of({"times its size.", "across."})) << seen_;
  type("q");
  EXPECT_EQ(exit_status(), 0);
  EXPECT_TRUE(same_as_before());
}

TEST_F(AtATerminal, TheQuestionOfAStudyIsAnsweredSkippedAndEndedAndKeepsItsRow) {
  studies_ = true;
  const std::string question = "Enter skips the question";
  const auto ask = [&] {
    seen_.clear();
    start();
    type("q");
    ASSERT_TRUE(shows(question)) << seen_;
    EXPECT_TRUE(same_as_before()) << "an answer is typed with echo";
  };
  ask();
  type("eleven\n");
  EXPECT_TRUE(shows("'eleven' is no whole number from 1 to 10")) << seen_;
  type(" 7 \n");
  EXPECT_EQ(exit_status(), 0);
  ask();
  type("\n");
  EXPECT_EQ(exit_status(), 0);
  ask();
  type("\x03");
  EXPECT_EQ(exit_status(), 0);
  for (const int number : {SIGINT, SIGTERM, SIGQUIT, SIGHUP, SIGALRM, SIGUSR1}) {
    ask();
    ::kill(child_, number);
    EXPECT_EQ(exit_status(), 0) << number;
  }
  seen_.clear();
  start();
  ::kill(child_, SIGTERM);
  EXPECT_EQ(exit_status(), 0) << "nobody is there to be asked";
  EXPECT_EQ(seen_.find(question), std::string::npos);
  std::istringstream lines(text_of(folder_ / "visitors.csv"));
  std::vector<std::string> realism;
  for (std::string line; std::getline(lines, line);) realism.push_back(line.substr(0, line.find(',')));
  std::vector<std::string> expected(11, "");
  expected[0] = "realism";
  expected[1] = "7";
  EXPECT_EQ(realism, expected);
}

TEST_F(AtATerminal, IsAsItWasWhicheverWayTheProgramEnds) {
  for (const int number : {SIGINT, SIGTERM, SIGQUIT, SIGHUP, SIGABRT, SIGSEGV}) {
    if (SPARSHA_SANITIZED && number == SIGSEGV) continue;  // sanitizers take it for their own report
    seen_.clear();
    start();
    ::kill(child_, number);
    const int status = exit_status();
    ASSERT_NE(status, -1) << number;
    EXPECT_TRUE(same_as_before()) << "signal " << number;
    EXPECT_EQ(WIFSIGNALED(status), number == SIGSEGV) << number;
  }
}

/// A whole visit by keys: down to the stone, along it to its end, up from it, and how it was at the end.
TEST_F(AtATerminal, KeysMoveAHandOverTheStone) {
  start("keys");
  EXPECT_TRUE(shows("Lotus medallion")) << "it came down by itself: " << seen_;
  type("h");
  EXPECT_TRUE(shows("move the hand by one step")) << seen_;
  type("*");
  EXPECT_TRUE(shows("Steps of 4 centimetres")) << seen_;
  for (int k = 0; k < 60 && seen_.find("The stone ends here") == std::string::npos; ++k) {
    type("\x1b[C");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    shows("The stone ends here", 5);
  }
  EXPECT_TRUE(shows("The stone ends here")) << seen_;
  type("5");
  EXPECT_TRUE(shows("Right, in the middle, touching")) << seen_;
  type("d");
  EXPECT_TRUE(shows("Pressing with 1.6 newtons")) << seen_;
  type("l");
  EXPECT_TRUE(shows("The hand is lifted")) << seen_;
  std::this_thread::sleep_for(std::chrono::milliseconds(1000));
  type("l");
  EXPECT_TRUE(shows("Touching the stone")) << seen_;
  type("q");
  EXPECT_EQ(exit_status(), 0);
  EXPECT_TRUE(same_as_before());
}

TEST_F(AtATerminal, ThatIsClosedEndsARunOfKeys) {
  start("keys");
  close(kept_);
  close(master_);
  int status = -1;
  for (int i = 0; i < 2000 && waitpid(child_, &status, WNOHANG) != child_; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(WIFEXITED(status));
  child_ = 0;
  master_ = kept_ = -1;
}

TEST_F(AtATerminal, WithoutOneThereAreNoKeysToMoveAHand) {
  const Outcome outcome = run("explore scene --headless --device keys");
  EXPECT_EQ(outcome.code, 4);
  EXPECT_NE(outcome.err.find("keys move the hand from a terminal"), std::string::npos) << outcome.err;
  EXPECT_NE(run("explore scene --headless --device auto").err.find("--device keys"), std::string::npos);
}

TEST_F(AtATerminal, IsLentToTheShellWhileTheProgramIsStopped) {
  start_under_a_shell();
  ::kill(child_, SIGTSTP);
  const int stopped = next_report();
  ASSERT_TRUE(WIFSTOPPED(stopped)) << stopped;
  EXPECT_TRUE(same_as_before());
  ::kill(child_, SIGCONT);
  for (int i = 0; i < 1000 && same_as_before(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(same_as_before()) << "keys again";
  type("q");
  const int ended = next_report();
  EXPECT_TRUE(WIFEXITED(ended)) << ended;
  EXPECT_EQ(WEXITSTATUS(ended), 0);
  EXPECT_TRUE(same_as_before());
}

TEST(TerminalKeys, TurnAWholeObjectAboutTheAxesOfTheDevice) {
  const std::vector<std::pair<char, std::array<double, 3>>> turns{
      {'x', {45.0, 0.0, 0.0}}, {'Y', {0.0, -45.0, 0.0}}, {'z', {0.0, 0.0, 45.0}}, {'Z', {0.0, 0.0, -45.0}}};
  app::TerminalKeys keys;
  for (const auto& [letter, degrees] : turns) {
    const auto requests = keys.take({{app::TypedKey::Kind::letter, letter}}, 1.0);
    ASSERT_EQ(requests.size(), 1U) << letter;
    EXPECT_EQ(requests[0].kind, Kind::turn);
    EXPECT_EQ((std::array<double, 3>{requests[0].x, requests[0].y, requests[0].z}), degrees) << letter;
  }
  const auto back = keys.take({{app::TypedKey::Kind::letter, 'b'}}, 1.0);
  ASSERT_EQ(back.size(), 1U);
  EXPECT_EQ(back[0].kind, Kind::turn_back);
}

}  // namespace
}  // namespace sparsha
