// Progress on terminals: narrow ones, and such as know no commands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <future>
#include <sstream>
#include <string>

#include "tests/app/program.h"

namespace sparsha {
namespace {
using ::testing::HasSubstr;
using ::testing::Not;

class ProgressOnATerminal : public Program {
 protected:
  /// What a build shows at a terminal with these variables.
  std::string shown(const std::string& variables) {
    const int master = posix_openpt(O_RDWR | O_NOCTTY);
    EXPECT_GE(master, 0);
    EXPECT_EQ(grantpt(master), 0);
    EXPECT_EQ(unlockpt(master), 0);
    const std::string terminal = ptsname(master);
    const int kept = open(terminal.c_str(), O_RDWR | O_NOCTTY);  // or the terminal goes with the program
    const std::string command = "cd \"" + folder_.path().string() + "\" && env " + variables + " \"" + SPARSHA_PROGRAM +
                                "\" build " + relief_ + " --out scene > .out 2> " + terminal + " < /dev/null";
    std::future<int> status = std::async(std::launch::async, [&] { return std::system(command.c_str()); });
    std::string text;
    for (bool ended = false;;) {
      pollfd input{master, POLLIN, 0};
      char block[4096];
      if (::poll(&input, 1, 10) > 0) {
        if (const ssize_t got = ::read(master, block, sizeof block); got > 0)
          text.append(block, static_cast<std::size_t>(got));
      } else if (ended) {
        break;
      }
      ended = status.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    }
    EXPECT_EQ(status.get(), 0) << text;
    close(kept);
    close(master);
    return text;
  }
};

TEST_F(ProgressOnATerminal, SendsNoCommandsToADumbOne) {
  EXPECT_THAT(shown("TERM=dumb"), Not(HasSubstr("\x1b")));
  EXPECT_THAT(shown("TERM=xterm"), HasSubstr("\x1b[K"));
}

TEST_F(ProgressOnATerminal, IsNoWiderThanColumnsSays) {
  std::string text = shown("TERM=xterm COLUMNS=10");
  std::ranges::replace(text, '\r', '\n');
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(!line.starts_with("\x1b[K") || line.size() - 3 < 10U) << line;
}

}  // namespace
}  // namespace sparsha
