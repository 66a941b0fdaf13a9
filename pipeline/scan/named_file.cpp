#include "pipeline/scan/named_file.h"

#include <algorithm>
#include <system_error>
#include <vector>

#include "base/error.h"

namespace sparsha::pipeline {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kShown = 3;

std::string first_of(const std::vector<std::string>& names, const char* separator) {
  std::string text;
  for (std::size_t k = 0; k < std::min(names.size(), kShown); ++k) text += (k > 0 ? separator : "") + names[k];
  if (names.size() > kShown) text += " and " + std::to_string(names.size() - kShown) + " more";
  return text;
}

}  // namespace

std::string names_together(const std::vector<std::string>& files) { return first_of(files, ", "); }

std::string scans_in(const fs::path& folder) {
  constexpr std::size_t kMost = 10'000;
  std::vector<std::string> names;
  std::error_code code;
  fs::directory_iterator entry(folder, code);
  for (std::size_t seen = 0; !code && entry != fs::directory_iterator() && seen < kMost; entry.increment(code), ++seen)
    if (std::error_code none; entry->is_regular_file(none) && has_ending_of_scan(entry->path()))
      names.push_back(entry->path().string());
  std::sort(names.begin(), names.end());
  return first_of(names, " ");
}

void require_file_name(const fs::path& file) {
  std::error_code code;
  if (fs::is_directory(file, code)) {
    const std::string scans = scans_in(file);
    throw input_error(file.string(), "this is a folder, and no scan",
                      scans.empty() ? "the files of scans by their names" : "the scans in it by their names: " + scans);
  }
  if (file.string().find_first_of("*?[{") != std::string::npos && !fs::exists(fs::symlink_status(file, code))) {
    throw input_error(file.string(), "no file has this name, and patterns are not replaced by names here",
                      "the files of scans by their names; at a prompt, a pattern without quotes that some file fits");
  }
}

}  // namespace sparsha::pipeline
