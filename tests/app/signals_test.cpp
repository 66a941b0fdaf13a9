// The program under signals at moments drawn from a seed: whatever comes however often, it ends with a code of its own
// and leaves whole files or none. Results that cannot be written to standard output are a failure of any command.
#include <gmock/gmock.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <random>
#include <thread>
#include <vector>

#include "tests/app/program.h"

namespace sparsha {
namespace {

using std::chrono::microseconds;
using ::testing::HasSubstr;

constexpr std::array kSignals = {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGABRT, SIGALRM, SIGXCPU, SIGPIPE, SIGUSR1};

class Signals : public Program {
 protected:
  void simulate_scene() {
    write("simulation.yaml",
          "nodes: 64\nsurface: {form: accuracy, size_m: [0.1, 0.1]}\nsampler: {points_per_node: 3.6}\n");
    ASSERT_EQ(run("simulate simulation.yaml --out scan").code, 0);
    ASSERT_EQ(run("build scan/sparsha.yaml -o scene --quiet").code, 0);
  }
  // In the test's folder, with no display and nothing to read; no program between this one and that.
  pid_t start(const std::vector<std::string>& arguments) {
    const pid_t child = ::fork();
    if (child != 0) return child;
    if (::chdir(folder_.path().c_str()) != 0) ::_exit(127);
    ::unsetenv("DISPLAY");
    ::unsetenv("WAYLAND_DISPLAY");
    ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
    ::dup2(::open(".out", O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
    ::dup2(::open(".err", O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
    std::string program = SPARSHA_PROGRAM;
    std::vector<std::string> words = arguments;
    std::vector<char*> argv{program.data()};
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    ::execv(SPARSHA_PROGRAM, argv.data());
    ::_exit(127);
  }
  [[nodiscard]] static bool ended(pid_t child, int& status) { return ::waitpid(child, &status, WNOHANG) == child; }
  // The process is the program's: it holds or catches what asks it to end. Nothing can do so before it runs.
  [[nodiscard]] static bool has_begun(pid_t child) {
    std::ifstream stream("/proc/" + std::to_string(child) + "/status");
    std::uint64_t set = 0;
    for (std::string line; std::getline(stream, line);) {
      if (line.starts_with("SigBlk:") || line.starts_with("SigCgt:")) set |= std::stoull(line.substr(7), nullptr, 16);
    }
    return (set >> (SIGTERM - 1) & 1U) != 0;
  }
  void expect_a_code_of_the_contract(int status, const std::string& what) {
    ASSERT_TRUE(WIFEXITED(status)) << what << ": signal " << WTERMSIG(status);
    EXPECT_LE(WEXITSTATUS(status), 4) << what << text_of(folder_ / ".err");
  }
  [[nodiscard]] std::vector<std::string> hidden() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with(".") && name != ".out" && name != ".err") names.push_back(name);
    }
    return names;
  }
  microseconds draw(int most_us) { return microseconds(std::uniform_int_distribution<int>(0, most_us)(random_)); }
  int draw_signal() { return kSignals[std::uniform_int_distribution<std::size_t>(0, kSignals.size() - 1)(random_)]; }

  std::mt19937_64 random_{20251125};
};

// At random times from when it records on: the first ends it, and all of the others fall into the writing of its files.
TEST_F(Signals, OfAnyNumberLeaveRecordingSoundAndPictureOfAnExplorationWhole) {
  simulate_scene();
  for (int round = 0; round < 12; ++round) {
    const std::string what = "round " + std::to_string(round);
    const pid_t child = start({"explore", "scene", "--device", "simulated", "--headless", "--duration", "1000",
                               "--record", "run.csv", "--audio-out", "run.wav", "--screenshot", "view.png"});
    const auto records = [&] {
      return std::ranges::any_of(fs::directory_iterator(folder_), [](const auto& entry) {
        std::error_code code;
        return entry.path().filename().string().starts_with(".run.csv.part-") && entry.file_size(code) > 0;
      });
    };
    int status = 0;
    while (!records()) {
      ASSERT_FALSE(ended(child, status)) << text_of(folder_ / ".err");
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    std::this_thread::sleep_for(draw(100'000));
    // Two within 50 ms, a volley, or one after the other until it has ended.
    const int count = round % 3 == 0 ? 2 : round % 3 == 1 ? 20 : 1'000'000;
    const int pause_us = round % 3 == 0 ? 50'000 : 3'000;
    bool over = false;
    for (int k = 0; k < count && !over; ++k) {
      ::kill(child, draw_signal());
      std::this_thread::sleep_for(draw(pause_us));
      over = ended(child, status);
    }
    if (!over) {
      ::kill(child, SIGTERM);  // SIGPIPE asks for nothing
      ::waitpid(child, &status, 0);
    }
    expect_a_code_of_the_contract(status, what);
    EXPECT_EQ(WEXITSTATUS(status), 0) << what << text_of(folder_ / ".err");
    EXPECT_THAT(text_of(folder_ / "run.csv"), ::testing::EndsWith("\n")) << what;
    EXPECT_TRUE(text_of(folder_ / "run.wav").starts_with("RIFF")) << what;
    EXPECT_THAT(text_of(folder_ / "view.png"), HasSubstr("IEND")) << what;
    EXPECT_THAT(hidden(), ::testing::IsEmpty()) << what;
    for (const char* file : {"run.csv", "run.wav", "view.png"}) fs::remove(folder_ / file);
  }
}

// From when the process is the program's on, long before its libraries are loaded.
TEST_F(Signals, OfTheFirstTenthOfASecondEndInACodeOfTheContractAndLeaveWholeFilesOrNone) {
  simulate_scene();
  const std::vector<std::vector<std::string>> commands = {
      {"--version"},
      {"info", "scan/scan.ply"},
      {"new", "scan/scan.ply"},
      {"build", "scan/sparsha.yaml", "--out", "new.scene"},
      {"export", "scene", "--to", "mesh.ply"},
      {"explore", "scene", "--device", "simulated", "--headless", "--duration", "0.2", "--record", "run.csv",
       "--audio-out", "run.wav"},
  };
  for (int round = 0; round < 90; ++round) {
    const std::vector<std::string>& command = commands[static_cast<std::size_t>(round) % commands.size()];
    const std::string what = command.front() + ", round " + std::to_string(round);
    const pid_t child = start(command);
    int status = 0;
    bool over = false;
    while (!has_begun(child) && !(over = ended(child, status))) std::this_thread::yield();
    if (!over) {
      std::this_thread::sleep_for(draw(100'000));
      ::kill(child, draw_signal());
      ::kill(child, draw_signal());
      ::waitpid(child, &status, 0);
    }
    expect_a_code_of_the_contract(status, what);
    EXPECT_THAT(hidden(), ::testing::IsEmpty()) << what;
    if (command.front() == "explore" && WEXITSTATUS(status) == 0) {
      EXPECT_TRUE(text_of(folder_ / "run.csv").starts_with("t_s,")) << what;
      EXPECT_TRUE(text_of(folder_ / "run.wav").starts_with("RIFF")) << what;
    }
    if (command.front() == "export" && WEXITSTATUS(status) == 0) {
      EXPECT_TRUE(fs::exists(folder_ / "mesh.ply")) << what;
    }
    for (const char* file : {"run.csv", "run.wav", "mesh.ply"}) fs::remove(folder_ / file);
  }
}

TEST_F(Signals, AnIgnoredHangupStaysIgnored) {
  simulate_scene();
  const Outcome outcome = run(
      "explore scene --device simulated --headless --duration 0.5 --record run.csv & P=$!; sleep 0.2; kill -HUP $P; "
      "wait $P",
      "/dev/null", "trap '' HUP;");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_GT(std::ranges::count(text_of(folder_ / "run.csv"), '\n'), 400) << "half a second of ticks";
}

#if defined(__linux__)
TEST_F(Signals, NoCommandSucceedsWhoseResultsCannotBeWritten) {
  simulate_scene();
  write("path.csv", "t_s,x_m,y_m,z_m\n0,0.05,0.05,0.01\n0.001,0.05,0.05,-0.001\n");
  for (const std::string command :
       {"--help", "--version", "build --help", "device --help", "device list", "info scan/scan.ply",
        "info scene --json", "new scan/scan.ply", "build scan/sparsha.yaml --out other", "check scene",
        "build scan/sparsha.yaml --validate", "explore scene --device simulated --headless --duration 0.1",
        "explore --list-audio", "trace scene --hip path.csv --out trace.csv", "bench export bench-data",
        "simulate simulation.yaml --out again", "export scene --to mesh.ply"}) {
    const Outcome good = run(command);
    ASSERT_LE(good.code, 0) << command << good.err;
    if (good.out.empty()) continue;  // what it makes are files alone
    for (const char* nowhere : {"/dev/full", "&-"}) {
      const std::string shell = "cd \"" + folder_.path().string() + "\" && env -u DISPLAY -u WAYLAND_DISPLAY \"" +
                                SPARSHA_PROGRAM + "\" " + command + " 2> .err < /dev/null >" + nowhere;
      const int status = std::system(shell.c_str());
      EXPECT_EQ(WEXITSTATUS(status), 1) << command << " >" << nowhere;
      EXPECT_THAT(text_of(folder_ / ".err"), HasSubstr("standard output could not be written")) << command;
    }
  }
}

TEST_F(Signals, AClosedPipeEndsAProgramWithoutAWord) {
  constexpr int kPipe = 9;  // one digit, for every shell
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ::close(ends[0]);
  ASSERT_EQ(::dup2(ends[1], kPipe), kPipe);
  ::close(ends[1]);
  // Above and below what is buffered.
  for (const std::string command : {"config keys", "build --help", "--version", "--help"}) {
    const std::string shell =
        "cd \"" + folder_.path().string() + "\" && \"" + SPARSHA_PROGRAM + "\" " + command + " 2> .err < /dev/null >&9";
    EXPECT_EQ(WEXITSTATUS(std::system(shell.c_str())), 1) << command << ": what was promised is missing";
    EXPECT_EQ(text_of(folder_ / ".err"), "") << command;
  }
  ::close(kPipe);
}

// Else the first file that is opened would be the standard output, and get what is printed.
TEST_F(Signals, NoFileTakesThePlaceOfAStreamThatWasClosed) {
  simulate_scene();
  write("path.csv", "t_s,x_m,y_m,z_m\n0,0.05,0.05,0.01\n0.001,0.05,0.05,-0.001\n");
  ASSERT_EQ(run("trace scene --hip path.csv --out trace.csv").code, 0);
  const std::string shell = "cd \"" + folder_.path().string() + "\" && \"" + SPARSHA_PROGRAM +
                            "\" trace scene --hip path.csv --out closed.csv <&- >&- 2>&-";
  EXPECT_EQ(WEXITSTATUS(std::system(shell.c_str())), 1);
  const auto rows_of = [&](const char* file) {
    const std::string text = text_of(folder_ / file);
    return std::pair(text.substr(0, text.find('\n')), std::ranges::count(text, '\n'));
  };
  EXPECT_EQ(rows_of("closed.csv"), rows_of("trace.csv"));
}
#endif

}  // namespace
}  // namespace sparsha
