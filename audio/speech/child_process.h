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
  /// Starts `program` without a shell: default signals, no file of ours but its stdin, output discarded, ordinary
  /// priority. `text` waits on its stdin (at most 64 KB). Null when it cannot be started.
  [[nodiscard]] static std::unique_ptr<ChildProcess> start(const std::filesystem::path& program,
                                                           const std::vector<std::string>& arguments,
                                                           std::string_view text);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// False once it has ended.
  [[nodiscard]] bool running();
  /// Ends it and what it has started, and waits for its end.
  void kill();
  /// Asks it to end, and kills it when it has not within `patience_ms`.
  void end(int patience_ms);

 private:
  explicit ChildProcess(int process) : process_(process) {}
  int process_;
};

}  // namespace sparsha::audio
