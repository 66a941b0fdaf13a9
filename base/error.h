// The one exception type of the project: what is wrong, where, and what was expected.
// Thrown by every room, caught once, in app/. Printed as "file:line:column: error: wrong; expected".
#pragma once

#include <stdexcept>
#include <string>

namespace sparsha {

/// What kind of failure it is; the value is the program's exit code.
enum class ErrorKind { failure = 1, usage = 2, input = 3, device = 4 };

/// A place in a text. Lines and columns count from 1; 0 means "none meant".
struct Place {
  std::string file;
  int line = 0;
  int column = 0;
};

/// "file:line:column", "file:line" or "file", as much as is known; empty without a file.
[[nodiscard]] std::string to_string(const Place& place);

class Error : public std::runtime_error {
 public:
  /// `wrong` says what is wrong, `expected` what would have been right; both without a final full stop.
  Error(ErrorKind kind, Place place, std::string wrong, std::string expected = {});

  [[nodiscard]] ErrorKind kind() const noexcept { return kind_; }
  [[nodiscard]] const Place& place() const noexcept { return place_; }
  [[nodiscard]] const std::string& wrong() const noexcept { return wrong_; }
  [[nodiscard]] const std::string& expected() const noexcept { return expected_; }

 private:
  ErrorKind kind_;
  Place place_;
  std::string wrong_;
  std::string expected_;
};

/// Thrown by Progress::throw_if_cancelled(); the work was stopped by request and left nothing behind.
class Cancelled : public Error {
 public:
  Cancelled() : Error(ErrorKind::failure, {}, "cancelled") {}
};

/// Shorthands. `file` is the path as the user gave it.
[[nodiscard]] Error input_error(std::string file, std::string wrong, std::string expected = {});
[[nodiscard]] Error input_error_at(std::string file, int line, std::string wrong, std::string expected = {});
[[nodiscard]] Error usage_error(std::string wrong, std::string expected = {});

}  // namespace sparsha
