// Rows are appended whole; rewriting the file keeps it valid when the disk is full.
#include "app/study.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "pipeline/base/error.h"
#include "pipeline/base/files.h"

namespace sparsha::app {

void check_study_name(const std::string& name) {
  if (name.find_first_of("/\\:*?\"<>|,\n") != std::string::npos || name == "." || name == "..") {
    throw usage_error("--study '" + name + "' cannot be the name of a file", "a plain name");
  }
}

int ask_realism() {
  for (int attempt = 0; attempt < 3; ++attempt) {
    std::fputs("How real did it feel, from 1 (not at all) to 10 (like the object itself)? ", stderr);
    std::string answer;
    if (!std::getline(std::cin, answer)) return 0;
    int value = 0;
    const auto [end, code] = std::from_chars(answer.data(), answer.data() + answer.size(), value);
    if (code == std::errc{} && end == answer.data() + answer.size() && value >= 1 && value <= 10) return value;
  }
  return 0;
}

void append_study(const std::string& name, const haptics::SessionSummary& s, int realism) {
  const std::filesystem::path file = name + ".csv";
  constexpr std::size_t kLimit = std::size_t{1} << 28U;
  std::error_code code;
  std::string text =
      std::filesystem::exists(file, code)
          ? read_file(file, kLimit)
          : std::string("realism,duration_s,contact_s,contacts,path_m,mean_force_n,peak_force_n,area_m2,levels\n");
  std::string levels;
  for (const int level : s.levels) levels += (levels.empty() ? "" : " ") + std::to_string(level);
  text += fmt::format("{},{},{},{},{},{},{},{},{}\n", realism > 0 ? std::to_string(realism) : "", s.duration_s,
                      s.contact_s, s.contacts, s.path_m, s.mean_force_n, s.peak_force_n, s.area_m2, levels);
  write_file(file, text);
}

}  // namespace sparsha::app
