// Linux: what is called `sparsha` lets the signals that ask a program to end wait and becomes the program itself, which
// takes them when it can. The dynamic linker needs tens of milliseconds for fifty libraries, and a signal that came
// meanwhile would end the process by that signal, without a word and with no exit code of ours. Linked statically, so
// that it begins at once; nothing of C++ but its compiler.
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <initializer_list>

#include "base/system/ending_signals.h"

namespace {

constexpr std::size_t kLongest = 4096;

void say(const char* text) {
  const std::size_t size = std::strlen(text);
  if (::write(STDERR_FILENO, text, size) < 0) return;  // nobody is there to be told
}

}  // namespace

int main(int, char** argv) {
  sigset_t set;
  ::sigemptyset(&set);
  for (const int number : sparsha::system::kEndingSignals) ::sigaddset(&set, number);
  ::sigprocmask(SIG_BLOCK, &set, nullptr);
  for (const int number : {SIGXFSZ, SIGPIPE}) std::signal(number, SIG_IGN);  // as in the program

  // From this file's own folder, wherever it is called from.
  static char program[kLongest + sizeof SPARSHA_PROGRAM_FROM_HERE];
  const ssize_t size = ::readlink("/proc/self/exe", program, kLongest);
  if (size > 0) {
    program[size] = '\0';
    std::strcpy(std::strrchr(program, '/') + 1, SPARSHA_PROGRAM_FROM_HERE);
    ::execv(program, argv);
  }
  const char* const why = std::strerror(errno);
  say(program);
  say(": error: cannot start the program: ");
  say(why);
  say("; a whole installation of sparsha\n");
  return 1;
}
