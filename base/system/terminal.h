// Keys of a terminal as they are pressed, for programs without a window.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace sparsha::system {

/// Reads standard input key by key, without echo, where that is a terminal in whose foreground this program runs. What
/// ends the program (Ctrl-C, Ctrl-\) and what stops it (Ctrl-Z) work as ever. The terminal is as it was when the object
/// goes, when the program exits, is stopped, or is ended by a fault of its own; a program that ends another way calls
/// restore_terminal(). One object at a time.
class TerminalInput {
 public:
  TerminalInput();
  ~TerminalInput();
  TerminalInput(const TerminalInput&) = delete;
  TerminalInput& operator=(const TerminalInput&) = delete;

  /// False when standard input is no terminal of this program's: then there are no keys.
  [[nodiscard]] bool active() const { return active_; }
  /// True once the terminal has been closed: nothing will be typed any more.
  [[nodiscard]] bool gone() const { return gone_; }
  /// What has been typed since the last call; never waits.
  [[nodiscard]] std::string read();

 private:
  bool active_ = false;
  bool gone_ = false;
};

/// The file that standard output was redirected to, absolute; empty when it is none or its name is not to be had.
[[nodiscard]] std::filesystem::path standard_output_file();

/// Whether standard input is a terminal in whose foreground this program runs.
[[nodiscard]] bool stdin_is_terminal();

/// Gives the terminal back as it was before any TerminalInput, and forgets what was typed until now. To be called
/// before a question is shown: what is typed after it is an answer.
void forget_typed() noexcept;

/// The next line that is typed, without its line feed. Nothing at the end of input, or once `stop`, asked twenty times
/// a second, is true; nothing at once where standard input is no terminal of this program's.
[[nodiscard]] std::optional<std::string> typed_line(const std::function<bool()>& stop);

/// Whether standard error is a terminal on which a line can be drawn anew: TERM is not "dumb".
[[nodiscard]] bool redraws_lines() noexcept;

/// Columns of the terminal of standard error: COLUMNS where that is a number from 1 on, else as the system says, else
/// 80.
[[nodiscard]] int terminal_columns() noexcept;

/// Gives the terminal back as it was; safe in a signal handler, harmless when nothing was changed.
void restore_terminal() noexcept;

}  // namespace sparsha::system
