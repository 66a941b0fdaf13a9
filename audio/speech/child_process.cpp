// posix_spawn with a socket for stdin: a socket, unlike a pipe, can be written to without SIGPIPE.
#include "audio/speech/child_process.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <sched.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/system/confinement.h"

extern char** environ;  // NOLINT(readability-redundant-declaration): not every system's unistd.h has it

namespace sparsha::audio {
namespace {

constexpr std::size_t kMostText = 65536;
constexpr std::size_t kMostOutput = std::size_t{64} << 20U;

/// Attributes and file actions, freed in every case.
struct SpawnSetup {
  posix_spawnattr_t attributes{};
  posix_spawn_file_actions_t files{};
  SpawnSetup() {
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_init(&files);
  }
  ~SpawnSetup() {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSetup(const SpawnSetup&) = delete;
  SpawnSetup& operator=(const SpawnSetup&) = delete;
};

/// As posix_spawn. What a thread has given up its children lack, too, and the program's own threads keep it.
int spawn_confined(pid_t& process, const std::filesystem::path& program, const SpawnSetup& setup, char** argv) {
  int status = EAGAIN;
  try {
    std::thread([&] {
      system::confine_thread(system::Confinement::helper);
      status = posix_spawn(&process, program.c_str(), &setup.files, &setup.attributes, argv, environ);
    }).join();
  } catch (const std::system_error&) {  // no thread is to be had
  }
  if (status == 0) system::limit_helper(process);
  return status;
}

}  // namespace

std::optional<std::filesystem::path> find_program(const std::vector<std::string>& names) {
  const char* path = std::getenv("PATH");
  if (path == nullptr) return std::nullopt;
  const std::string_view folders(path);
  for (const std::string& name : names) {
    for (std::size_t begin = 0; begin <= folders.size();) {
      const std::size_t end = std::min(folders.find(':', begin), folders.size());
      const std::filesystem::path file = std::filesystem::path(folders.substr(begin, end - begin)) / name;
      std::error_code status;
      if (end > begin && std::filesystem::is_regular_file(file, status) && access(file.c_str(), X_OK) == 0) return file;
      begin = end + 1;
    }
  }
  return std::nullopt;
}

std::unique_ptr<ChildProcess> ChildProcess::start(const std::filesystem::path& program,
                                                  const std::vector<std::string>& arguments, std::string_view text,
                                                  Output output) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return nullptr;
  int written[2] = {-1, -1};
  if (output == Output::keep && pipe2(written, O_CLOEXEC) != 0) {
    close(ends[0]);
    close(ends[1]);
    return nullptr;
  }
  SpawnSetup setup;
  posix_spawn_file_actions_adddup2(&setup.files, ends[1], STDIN_FILENO);
  if (output == Output::keep) {
    fcntl(written[0], F_SETFL, O_NONBLOCK);
    posix_spawn_file_actions_adddup2(&setup.files, written[1], STDOUT_FILENO);
  } else {
    posix_spawn_file_actions_addopen(&setup.files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  }
  posix_spawn_file_actions_addopen(&setup.files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 34)
  posix_spawn_file_actions_addclosefrom_np(&setup.files, STDERR_FILENO + 1);
#endif
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&setup.attributes, &none);
  posix_spawnattr_setsigdefault(&setup.attributes, &all);
  posix_spawnattr_setpgroup(&setup.attributes, 0);
  const sched_param ordinary{};
  posix_spawnattr_setschedparam(&setup.attributes, &ordinary);
  posix_spawnattr_setschedpolicy(&setup.attributes, SCHED_OTHER);
  posix_spawnattr_setflags(&setup.attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP |
                                                  POSIX_SPAWN_SETSCHEDULER);

  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t process = 0;
  const int status = spawn_confined(process, program, setup, argv.data());
  close(ends[1]);
  if (status == 0) {
    std::string_view rest = text.substr(0, kMostText);
    while (!rest.empty()) {
      const ssize_t sent = send(ends[0], rest.data(), rest.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent < 0 && errno == EINTR) continue;
      if (sent <= 0) break;
      rest.remove_prefix(static_cast<std::size_t>(sent));
    }
  }
  close(ends[0]);
  if (written[1] >= 0) close(written[1]);
  if (status == 0) return std::unique_ptr<ChildProcess>(new ChildProcess(process, written[0]));
  if (written[0] >= 0) close(written[0]);
  return nullptr;
}

ChildProcess::~ChildProcess() {
  kill();
  if (output_ >= 0) close(output_);
}

void ChildProcess::read_output() {
  char block[65536];
  while (output_ >= 0 && written_.size() < kMostOutput) {
    const ssize_t got = read(output_, block, sizeof block);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return;
    written_.append(block, static_cast<std::size_t>(got));
  }
}

const std::string& ChildProcess::output() {
  read_output();
  return written_;
}

bool ChildProcess::running() {
  read_output();  // a full pipe would keep it waiting
  if (process_ <= 0) return false;
  int status = 0;
  const pid_t ended = waitpid(process_, &status, WNOHANG);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return true;
  if (ended > 0) exit_code_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  process_ = 0;
  return false;
}

void ChildProcess::kill() {
  if (process_ <= 0) return;
  ::kill(-process_, SIGKILL);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
  process_ = 0;
}

void ChildProcess::end(int patience_ms) {
  if (process_ > 0) ::kill(-process_, SIGTERM);
  for (int i = 0; i < patience_ms && running(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  kill();
}

}  // namespace sparsha::audio
