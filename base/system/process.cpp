// POSIX: posix_spawn.
#include "base/system/process.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "base/error.h"

#if !defined(_WIN32)
#include <sched.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

extern char** environ;
#endif

namespace sparsha::system {

#if defined(_WIN32)

std::filesystem::path program_file() { return {}; }
int run_program(const std::vector<std::string>&, const std::vector<std::pair<std::string, std::string>>&,
                const std::function<bool()>&) {
  throw Error(ErrorKind::failure, {}, "this system starts no programs", "a POSIX system");
}

#else

std::filesystem::path program_file() {
  std::error_code code;
  return std::filesystem::read_symlink("/proc/self/exe", code);
}

namespace {

using Steady = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kLook{10};
constexpr std::chrono::seconds kGrace{10};

std::vector<std::string> environment_with(const std::vector<std::pair<std::string, std::string>>& more) {
  std::vector<std::string> result;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    const std::string name = text.substr(0, text.find('='));
    if (std::none_of(more.begin(), more.end(), [&](const auto& one) { return one.first == name; }))
      result.push_back(text);
  }
  for (const auto& [name, value] : more) result.push_back(name + "=" + value);
  return result;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

pid_t spawn(std::vector<std::string> command, const std::vector<std::pair<std::string, std::string>>& more) {
  std::vector<std::string> variables = environment_with(more);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t all, none;
  ::sigfillset(&all);
  ::sigemptyset(&none);
  ::posix_spawnattr_setsigdefault(&attributes, &all);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSCHEDULER);
  const sched_param ordinary{};
  ::posix_spawnattr_setschedpolicy(&attributes, SCHED_OTHER);
  ::posix_spawnattr_setschedparam(&attributes, &ordinary);
  pid_t id = 0;
  const int error = ::posix_spawnp(&id, command.front().c_str(), nullptr, &attributes, pointers(command).data(),
                                   pointers(variables).data());
  ::posix_spawnattr_destroy(&attributes);
  if (error != 0)
    throw usage_error("cannot run " + command.front() + ": " + std::strerror(error), "a program and its arguments");
  return id;
}

}  // namespace

int run_program(const std::vector<std::string>& command, const std::vector<std::pair<std::string, std::string>>& more,
                const std::function<bool()>& stop) {
  const pid_t id = spawn(command, more);
  Steady::time_point asked{};
  int status = 0;
  for (;;) {
    const pid_t ended = ::waitpid(id, &status, WNOHANG);
    if (ended == id) break;
    if (ended < 0 && errno != EINTR) return 1;
    if (asked == Steady::time_point{} && stop()) {
      asked = Steady::now();
      // A terminal has told the program too, which would take a second word for impatience.
      if (::isatty(STDIN_FILENO) == 0) ::kill(id, SIGTERM);
    } else if (asked != Steady::time_point{} && Steady::now() - asked > kGrace) {
      ::kill(id, SIGKILL);
    }
    std::this_thread::sleep_for(kLook);
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

#endif

}  // namespace sparsha::system
