// Subcommands and their options. CLI11 reads the command line, in one file: each file that sees its headers compiles
// all of it.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace sparsha::app {

/// Runs a subcommand after parsing; throws Error. Returns the exit code.
using Run = std::function<int()>;

/// What an option's value must be; --help says it.
class Check {
 public:
  explicit Check(CLI::Validator validator);
  [[nodiscard]] const CLI::Validator& validator() const { return *validator_; }

 private:
  std::shared_ptr<const CLI::Validator> validator_;
};

/// A number from `least` to `most`: never "nan".
[[nodiscard]] Check between(double least, double most);
/// A whole number from `least` to `most`, of the option's type: int, unsigned, std::size_t.
template <typename Number>
[[nodiscard]] Check whole_between(Number least, Number most);
[[nodiscard]] Check positive();
[[nodiscard]] Check one_of(std::vector<std::string> words);

/// An option of a subcommand; the command line owns it.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option required();
  Option check(const Check& check);
  /// --help says the value that the variable has now.
  Option shows_default();
  /// How many values it takes each time it is given; `most` below 0: any number.
  Option expects(int count);
  Option expects(int least, int most);
  /// May be given more than once: each adds its values.
  Option collects();
  /// Takes one value each time it is given; what follows is no other value of it.
  Option takes_one();
  Option excludes(const std::vector<std::string>& others);
  /// Its heading in --help.
  Option group(const std::string& heading);

  [[nodiscard]] bool given() const;
  /// As --help has it: "--size-mm".
  [[nodiscard]] std::string name() const;

 private:
  CLI::Option* option_;
};

/// A subcommand, or the program itself; the command line owns it.
class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}

  [[nodiscard]] Command add_subcommand(const std::string& name, const std::string& description);
  /// `names` as "--out,-o", or a word for an argument without dashes. `value` is set by parsing and must live until
  /// then. For strings, numbers, paths, and vectors of them: command_line.cpp has the list.
  template <typename Value>
  Option add_option(const std::string& names, Value& value, const std::string& description);
  Option add_flag(const std::string& names, bool& value, const std::string& description);
  /// One of its own subcommands must follow.
  void requires_subcommand();
  /// Called when the subcommand is given, after all its options are set.
  void callback(std::function<void()> function);
  void footer(const std::string& text);

 private:
  CLI::App* app_;
};

/// The whole command line of a program.
class CommandLine {
 public:
  CommandLine(const std::string& name, const std::string& description, const std::string& version);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  [[nodiscard]] Command program();
  /// Empty when all was understood. Else what is to be done instead: --help and --version print, and anything wrong is
  /// an error message with the option that was perhaps meant.
  [[nodiscard]] Run parse(int argc, char** argv);
  /// The subcommand that was given, after parse(); empty when none was.
  [[nodiscard]] std::string subcommand() const;

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace sparsha::app
