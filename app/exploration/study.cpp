// Rows are appended whole, also when several stations share a study.
#include "app/exploration/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "app/terminal/terminal.h"
#include "base/error.h"
#include "base/system.h"
#include "base/system/terminal.h"
#include "base/text/csv.h"

namespace sparsha::app {
namespace {

constexpr std::string_view kHeader =
    "realism,duration_s,contact_s,contacts,path_m,mean_force_n,peak_force_n,area_m2,levels";

}  // namespace

std::filesystem::path study_file(const std::string& name) {
  return name.empty() || std::filesystem::path(name).extension() == ".csv" ? name : name + ".csv";
}

void check_study(const std::string& name) {
  constexpr std::size_t kLongestName = 200;
  const bool control = std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; });
  if (control || name.find_first_of("/\\:*?\"<>|,") != std::string::npos || name == "." || name == ".." ||
      name.size() > kLongestName) {
    throw usage_error("--study '" + name + "' cannot be the name of a file", "a plain name");
  }
  const std::filesystem::path file = study_file(name);
  std::error_code code;
  if (!std::filesystem::exists(file, code)) return;
  std::string header;
  if (std::filesystem::is_regular_file(file, code)) std::getline(std::ifstream(file), header);
  if (csv::trimmed(header) != kHeader && std::filesystem::file_size(file, code) != 0) {
    throw usage_error("--study " + name + ": " + file.string() + " holds something else than a study", "another name");
  }
}

int ask_realism() {
  if (!system::stdin_is_terminal() || told_to_end()) return 0;
  const std::function<bool()> stop = interruption_from_now();
  system::forget_typed();  // keys of the run; what is typed from the question on is an answer
  for (int attempt = 0; attempt < 3; ++attempt) {
    end_progress_line();
    std::fputs("How real did it feel, from 1 (not at all) to 10 (like the object itself)? Enter skips the question. ",
               stderr);
    const std::optional<std::string> line = system::typed_line(stop);
    if (!line) {
      std::fputc('\n', stderr);
      return 0;
    }
    const std::string_view answer = csv::trimmed(*line);
    if (answer.empty()) return 0;
    int value = 0;
    const auto [end, code] = std::from_chars(answer.data(), answer.data() + answer.size(), value);
    if (code == std::errc{} && end == answer.data() + answer.size() && value >= 1 && value <= 10) return value;
    print_error(
        fmt::format("'{}' is no whole number from 1 to 10{}", answer, attempt == 2 ? "; no answer is kept" : ""));
  }
  return 0;
}

void append_study(const std::string& name, const haptics::SessionSummary& s, int realism) {
  std::string levels;
  for (const int level : s.levels) levels += (levels.empty() ? "" : " ") + std::to_string(level);
  const std::string row =
      fmt::format("{},{},{},{},{},{},{},{},{}\n", realism > 0 ? std::to_string(realism) : "", s.duration_s, s.contact_s,
                  s.contacts, s.path_m, s.mean_force_n, s.peak_force_n, s.area_m2, levels);
  system::append_line(study_file(name), std::string(kHeader) + "\n", row);
}

}  // namespace sparsha::app
