// What the user sees: progress on standard error, results on standard output, Ctrl-C.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "app/commands/commands.h"
#include "base/error.h"
#include "base/threads/progress.h"

namespace sparsha::app {

/// A Progress that draws a bar with the time left on a terminal, plain lines elsewhere, and is cancelled by Ctrl-C.
class Terminal {
 public:
  explicit Terminal(const CommonOptions& options);
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  [[nodiscard]] Progress& progress() { return progress_; }
  /// A message for the user, to standard error; nothing with --quiet.
  void message(std::string_view text) const;

 private:
  void show(const ProgressUpdate& update);

  bool quiet_;
  bool plain_;  ///< sentences
  bool bar_;
  std::chrono::steady_clock::time_point stage_began_;
  std::chrono::steady_clock::time_point last_drawn_;
  std::string stage_;
  Progress progress_;
};

/// Routes the signals that ask a program to end (SIGINT, SIGTERM, SIGHUP, SIGQUIT, ...): the first asks the running
/// Progress to stop. Others change nothing, so that promised files are finished; only one that comes more than ten
/// seconds after the first ends the program, with exit code 1. What is not asked for by a person - a file that may not
/// grow, a closed pipe - becomes an error where it is met. Before main().
void catch_interrupts();
/// True once the user asked to stop.
[[nodiscard]] bool interrupted();
/// For a question to the user: true once the user asks to stop after this call, with ten seconds of patience from then.
[[nodiscard]] std::function<bool()> interruption_from_now();
/// True once somebody asked to stop by another signal than Ctrl-C's: nobody is there to be asked anything.
[[nodiscard]] bool told_to_end();
/// Leaves an unfinished progress line.
void end_progress_line();

/// A result, to standard output, with a final line feed; control characters as printable() shows them.
void print(std::string_view text);
/// The same on standard error, for one line.
void print_error(std::string_view text);
/// Nobody reads standard output any more: the other end of its pipe is closed.
class ReaderGone : public Error {
 public:
  ReaderGone() : Error(ErrorKind::failure, {}, "nobody reads standard output any more") {}
};
/// Throws Error{failure} when results could not be written (a full disk), ReaderGone behind a closed pipe.
void flush_output();

}  // namespace sparsha::app
