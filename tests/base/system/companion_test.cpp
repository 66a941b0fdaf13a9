// The process that watches over this one goes on whichever of its two processes somebody kills.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "base/system/process.h"
#include "tests/support/test_folder.h"

namespace sparsha {
namespace {

enum Word : std::size_t { kWatch, kParent, kLooks };

bool comes_true(const std::function<bool()>& condition) {
  for (int k = 0; k < 1000; ++k) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// Ends the process of that word in whatever way `number` is, and says whether the watch goes on.
bool goes_on_without(system::Companion& companion, Word word, int number) {
  system::SharedWords& words = companion.words();
  if (!comes_true([&] { return words[word] != 0; })) return false;
  const std::uint64_t ended = words[word];
  if (::kill(static_cast<pid_t>(ended), number) != 0) return false;
  if (word == kWatch && !comes_true([&] { return words[kWatch] != ended; })) return false;
  const std::uint64_t looks = words[kLooks];
  return comes_true([&] { return words[kLooks] > looks + 3; });
}

TEST(Companion, GoesOnWhicheverOfItsProcessesIsKilledAndLooksOnceMoreAtTheEnd) {
  for (const Word killed : {kWatch, kParent}) {
    const test::TestFolder folder;
    const std::string last = (folder / "last").string();
    {
      system::Companion companion(
          [last](system::SharedWords& words, bool alive) {
            words[kWatch] = static_cast<std::uint64_t>(::getpid());
            words[kParent] = static_cast<std::uint64_t>(::getppid());
            ++words[kLooks];
            if (!alive) std::ofstream(last) << "seen";
          },
          2);
      for (int times = killed == kWatch ? 3 : 1; times > 0; --times)
        EXPECT_TRUE(goes_on_without(companion, killed, SIGKILL)) << killed;
    }
    EXPECT_TRUE(comes_true([&] { return std::filesystem::exists(last); })) << killed;
  }
}

}  // namespace
}  // namespace sparsha
