#include "app/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <sstream>
#include <utility>

#include "app/terminal/terminal.h"
#include "base/yaml/yaml.h"

namespace sparsha::app {
namespace {

constexpr int kUsage = 2;

// "error: ...; did you mean --headless?" for an option or subcommand that does not exist.
std::string usage_message(const CLI::ParseError& error, const CLI::App& app,
                          const std::vector<std::string>& arguments) {
  std::string text = std::string("error: ") + error.what();
  std::vector<std::string> names;
  for (const CLI::App* subcommand : app.get_subcommands({})) {
    if (!app.got_subcommand(subcommand)) continue;
    for (const CLI::Option* option : subcommand->get_options())
      if (!option->get_lnames().empty()) names.push_back("--" + option->get_lnames().front());
  }
  const bool in_subcommand = !names.empty();
  if (!in_subcommand)
    for (const CLI::App* subcommand : app.get_subcommands({})) names.push_back(subcommand->get_name());
  for (const std::string& argument : arguments) {
    if (in_subcommand != argument.starts_with("--")) continue;
    const std::string word = argument.substr(0, argument.find('='));
    if (std::find(names.begin(), names.end(), word) != names.end()) continue;
    const std::string near = yaml::nearest(word, names);
    if (!near.empty() && near != word) return text + "; did you mean " + near + "?";
  }
  return text + "; sparsha --help lists what there is";
}

}  // namespace

Check::Check(CLI::Validator validator) : validator_(std::make_shared<const CLI::Validator>(std::move(validator))) {}

// CLI::Range takes "nan".
Check between(double least, double most) {
  const auto check = [least, most](const std::string& text) {
    double value = 0.0;
    if (CLI::detail::lexical_cast(text, value) && value >= least && value <= most) return std::string();
    return fmt::format("{} is not a number from {} to {}", text, least, most);
  };
  return Check({check, fmt::format("FLOAT in [{} - {}]", least, most), "between"});
}

template <typename Number>
Check whole_between(Number least, Number most) {
  return Check(CLI::Range(least, most));
}
template Check whole_between(int, int);
template Check whole_between(unsigned, unsigned);
template Check whole_between(std::size_t, std::size_t);

Check positive() { return Check(CLI::PositiveNumber); }

Check one_of(std::vector<std::string> words) { return Check(CLI::IsMember(std::move(words))); }

Option Option::required() {
  option_->required();
  return *this;
}

Option Option::check(const Check& check) {
  option_->check(check.validator());
  return *this;
}

Option Option::shows_default() {
  option_->capture_default_str();
  return *this;
}

Option Option::expects(int count) {
  option_->expected(count);
  return *this;
}

Option Option::expects(int least, int most) {
  option_->expected(least, most);
  return *this;
}

Option Option::collects() {
  option_->take_all();
  return *this;
}

Option Option::takes_one() {
  option_->allow_extra_args(false);
  return *this;
}

Option Option::excludes(const std::vector<std::string>& others) {
  for (const std::string& other : others) option_->excludes(other);
  return *this;
}

Option Option::group(const std::string& heading) {
  option_->group(heading);
  return *this;
}

bool Option::given() const { return option_->count() > 0; }

std::string Option::name() const { return option_->get_name(); }

Command Command::add_subcommand(const std::string& name, const std::string& description) {
  return Command(app_->add_subcommand(name, description));
}

template <typename Value>
Option Command::add_option(const std::string& names, Value& value, const std::string& description) {
  return Option(app_->add_option(names, value, description));
}
template Option Command::add_option(const std::string&, double&, const std::string&);
template Option Command::add_option(const std::string&, int&, const std::string&);
template Option Command::add_option(const std::string&, unsigned&, const std::string&);
template Option Command::add_option(const std::string&, std::int64_t&, const std::string&);
template Option Command::add_option(const std::string&, std::size_t&, const std::string&);
template Option Command::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option Command::add_option(const std::string&, std::string&, const std::string&);
template Option Command::add_option(const std::string&, std::filesystem::path&, const std::string&);
template Option Command::add_option(const std::string&, std::vector<double>&, const std::string&);
template Option Command::add_option(const std::string&, std::vector<std::string>&, const std::string&);

Option Command::add_flag(const std::string& names, bool& value, const std::string& description) {
  return Option(app_->add_flag(names, value, description));
}

void Command::requires_subcommand() { app_->require_subcommand(1); }

void Command::callback(std::function<void()> function) { app_->callback(std::move(function)); }

void Command::footer(const std::string& text) { app_->footer(text); }

CommandLine::CommandLine(const std::string& name, const std::string& description, const std::string& version)
    : app_(std::make_unique<CLI::App>(description, name)) {
  app_->set_version_flag("--version", name + " " + version);
  app_->require_subcommand(1);
  app_->fallthrough();
}

CommandLine::~CommandLine() = default;

Command CommandLine::program() { return Command(app_.get()); }

Run CommandLine::parse(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0)  // --help, --version
      return [this, error] {
        std::ostringstream text, none;
        const int code = app_->exit(error, text, none);
        print(text.str());
        return code;
      };
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    return [message = usage_message(error, *app_, arguments)] {
      print_error(message);
      return kUsage;
    };
  }
  return {};
}

std::string CommandLine::subcommand() const {
  const std::vector<CLI::App*> given = app_->get_subcommands();
  return given.empty() ? std::string() : given.front()->get_name();
}

}  // namespace sparsha::app
