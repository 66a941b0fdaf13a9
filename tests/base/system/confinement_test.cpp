// What a confined process is refused, as it finds out itself, and as the system tells of it.
#include "base/system/confinement.h"

#include <gtest/gtest.h>

#if defined(__linux__) && (defined(__x86_64__) || defined(__aarch64__))

#include <fcntl.h>
#include <sys/mount.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <fstream>
#include <string>

#include "tests/support/test_folder.h"

namespace sparsha::system {
namespace {

/// The value of a line of /proc/PID/status.
std::string status_of(long process, const std::string& name) {
  std::ifstream file("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(name + ":\t")) return line.substr(name.size() + 2);
  return {};
}

/// Bits of what went through where it should not have, and of what did not where it should have.
enum Fault : int { kRan = 1, kCreated = 2, kRemoved = 4, kConnected = 8, kTraced = 16, kNeeded = 32, kUnconfined = 64 };

bool is_refused(long result) { return result == -1 && errno == EPERM; }

int faults_of(Confinement what, const std::string& folder) {
  const std::string there = folder + "/there";
  const std::string created = folder + "/created";
  if (!confine_thread(what)) return kUnconfined;
  const bool watch = what == Confinement::watch;
  int faults = 0;
  char* none[] = {nullptr};
  // Of no such program, so that a helper, which may run programs, is told so.
  if (is_refused(::execve("/no/such/program", none, none)) != watch) faults |= kRan;
  if (is_refused(::open(created.c_str(), O_CREAT | O_WRONLY, 0600)) != watch) faults |= kCreated;
  if (is_refused(::unlink(there.c_str())) != watch) faults |= kRemoved;
  const int network = ::socket(AF_INET, SOCK_DGRAM, 0);
  if (is_refused(network) != watch) faults |= kConnected;
  if (!is_refused(::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr))) faults |= kTraced;
  const int own = ::socket(AF_UNIX, SOCK_STREAM, 0);
  const int reading = ::open("/dev/null", O_RDWR);
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  if (own < 0 || reading < 0 || child < 0) faults |= kNeeded;
  return faults;
}

TEST(Confinement, RefusesWhatIsGivenUpAndNothingElse) {
  for (const Confinement what : {Confinement::helper, Confinement::watch}) {
    const test::TestFolder folder;
    std::ofstream((folder / "there").string()) << "x";
    const pid_t child = ::fork();
    if (child == 0) ::_exit(faults_of(what, folder.path().string()));
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0) << "for " << (what == Confinement::helper ? "a helper" : "a watch");
  }
}

TEST(Confinement, IsOfTheCallingThreadAndSeenByTheSystem) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const char done = confine_thread(Confinement::watch) ? 'y' : 'n';
    ::_exit(::write(ends[1], &done, 1) == 1 && ::pause() != 0 ? 0 : 1);
  }
  char done = 0;
  ASSERT_EQ(::read(ends[0], &done, 1), 1);
  EXPECT_EQ(done, 'y');
  EXPECT_EQ(status_of(child, "NoNewPrivs"), "1");
  EXPECT_EQ(status_of(child, "Seccomp"), "2");
  EXPECT_EQ(status_of(::getpid(), "Seccomp"), status_of(::getppid(), "Seccomp")) << "this program is as it was";
  limit_helper(child);
  std::ifstream limits("/proc/" + std::to_string(child) + "/limits");
  const std::string text{std::istreambuf_iterator<char>(limits), {}};
  EXPECT_NE(text.find("Max open files            256                  256"), std::string::npos) << text;
  EXPECT_NE(text.find("Max core file size        0                    0"), std::string::npos) << text;
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  for (const int end : ends) ::close(end);
}

}  // namespace
}  // namespace sparsha::system

#endif
