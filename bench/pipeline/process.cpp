// fork, exec, wait4: the kernel's own account of the child.
#include "bench/pipeline/process.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <exception>
#include <sstream>

namespace sparsha::bench {

namespace {

// What a child that ends in `body` took.
template <typename Body>
ProcessResult measured(const Body& body) {
  const auto began = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) body();
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  ProcessResult result;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  constexpr std::uint64_t kBlock = 512;
  result.cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  result.peak_rss_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024U;
  result.read_bytes = static_cast<std::uint64_t>(usage.ru_inblock) * kBlock;
  result.written_bytes = static_cast<std::uint64_t>(usage.ru_oublock) * kBlock;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

}  // namespace

ProcessResult run_process(const std::vector<std::string>& command) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  return measured([&] {
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    setenv("QT_QPA_PLATFORM", "offscreen", 1);
    execvp(arguments[0], arguments.data());
    _exit(127);
  });
}

ProcessResult run_child(const std::function<void()>& work) {
  return measured([&] {
    try {
      work();
    } catch (const std::exception&) {
      _exit(1);
    }
    _exit(0);
  });
}

void forget_pages(const std::filesystem::path& file) {
  const int opened = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (opened < 0) return;
  fsync(opened);
  posix_fadvise(opened, 0, 0, POSIX_FADV_DONTNEED);
  close(opened);
}

bool on_path(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((folder + "/" + name).c_str(), X_OK) == 0) return true;
  }
  return false;
}

}  // namespace sparsha::bench
