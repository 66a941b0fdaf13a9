// A program run beside ours that is fed a text and can be cut short.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sparsha::audio {

/// Full path of the first of `names` that PATH holds as an executable file; none when there is none.
[[nodiscard]] std::optional<std::filesystem::path> find_program(const std::vector<std::string>& names);

/// Running until it ends by itself or is killed; the destructor kills it. One thread.
class ChildProcess {
 public:
  enum class Output { discard, keep };
  /// Starts `program` without a shell: default signals, no file of ours but its stdin, ordinary priority. `text` waits
  /// on its stdin (at most 64 KB). What it writes is discarded, or kept for output(). Null when it cannot be started.
  [[nodiscard]] static std::unique_ptr<ChildProcess> start(const std::filesystem::path& program,
                                                           const std::vector<std::string>& arguments,
                                                           std::string_view text, Output output = Output::discard);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// False once it has ended.
  [[nodiscard]] bool running();
  /// What it has written so far, 64 MB at most; whole once running() is false.
  [[nodiscard]] const std::string& output();
  /// How it ended by itself, known once running() is false: its exit code, or 128 and the signal that ended it; 0 when
  /// it was killed.
  [[nodiscard]] int exit_code() const { return exit_code_; }
  [[nodiscard]] int process_id() const { return process_; }
  /// Ends it and what it has started, and waits for its end.
  void kill();
  /// Asks it to end, and kills it when it has not within `patience_ms`.
  void end(int patience_ms);

 private:
  ChildProcess(int process, int output) : process_(process), output_(output) {}
  void read_output();
  int process_;
  int output_;  ///< to read from; -1: none
  int exit_code_ = 0;
  std::string written_;
};

}  // namespace sparsha::audio
