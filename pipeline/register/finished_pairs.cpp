// What was written by a process that was killed is in the file as far as the system took it; the sum of each line tells
// whether it is whole.
#include "pipeline/register/finished_pairs.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/files/files.h"
#include "base/text/csv.h"

namespace sparsha::pipeline {
namespace {

constexpr std::string_view kFormat = "sparsha pairs 1\n";
constexpr std::size_t kMostBytes = std::size_t{256} << 20U;

std::string sum_of(std::string_view text) { return sha256(std::as_bytes(std::span<const char>(text))); }

Error cannot_write(const std::filesystem::path& file) {
  return {ErrorKind::failure,
          {file.string(), 0, 0},
          "finished pairs cannot be kept",
          "room on the disk, a folder that can be written to, and no other file of that name"};
}

// The key and the numbers of a line without its end; nothing of one that is not whole.
std::optional<std::pair<std::string, std::vector<double>>> result_in(std::string_view line) {
  const std::size_t sum = line.rfind(',') + 1;
  if (sum == 0 || sum_of(line.substr(0, sum)) != line.substr(sum)) return std::nullopt;
  line = line.substr(0, sum - 1);
  std::pair<std::string, std::vector<double>> result(std::string(csv::take_field(line)), {});
  while (!line.empty()) {
    double number = 0.0;
    if (!csv::to_number(csv::take_field(line), number) || !std::isfinite(number)) return std::nullopt;
    result.second.push_back(number);
  }
  return result;
}

}  // namespace

FinishedPairs::FinishedPairs(std::filesystem::path file, std::string program)
    : file_(std::move(file)), program_(std::move(program)) {
  namespace fs = std::filesystem;
  std::error_code code;
  const fs::file_status status = fs::symlink_status(file_, code);
  std::string text;
  if (fs::exists(status)) {
    if (!fs::is_regular_file(status)) throw cannot_write(file_);
    text = read_file(file_, kMostBytes);
    if (!kFormat.starts_with(text.substr(0, kFormat.size()))) throw cannot_write(file_);
  }
  code.clear();
  const std::size_t whole = text.rfind('\n') + 1;  // 0 of a file without a line
  std::string_view rest = std::string_view(text).substr(0, whole);
  rest.remove_prefix(std::min(rest.size(), kFormat.size()));
  while (!rest.empty())
    if (auto result = result_in(csv::take_line(rest))) results_.insert(*std::move(result));
  if (whole < text.size()) fs::resize_file(file_, whole, code);
  stream_.open(file_, std::ios::binary | std::ios::app);
  if (whole == 0) stream_ << kFormat << std::flush;
  if (!stream_ || code) throw cannot_write(file_);
}

std::string FinishedPairs::key_of(const char* kind, std::span<const std::string> digests,
                                  std::span<const double> numbers) const {
  std::string text = std::string(kind) + "\n" + program_ + "\n";
  for (const std::string& digest : digests) text += digest + "\n";
  for (const double number : numbers) csv::append(text, number);
  return sum_of(text);
}

bool FinishedPairs::find(const std::string& key, std::vector<double>& numbers) {
  const std::lock_guard lock(mutex_);
  const auto found = results_.find(key);
  if (found == results_.end()) return false;
  numbers = found->second;
  ++taken_;
  return true;
}

void FinishedPairs::add(const std::string& key, const std::vector<double>& numbers) {
  std::string line = key + ",";
  for (const double number : numbers) csv::append(line, number);
  line += sum_of(line) + "\n";
  const std::lock_guard lock(mutex_);
  stream_ << line << std::flush;
  if (!stream_) throw cannot_write(file_);
}

std::size_t FinishedPairs::taken() const {
  const std::lock_guard lock(mutex_);
  return taken_;
}

void remove_finished_pairs(const std::filesystem::path& file) { remove_own_file(file, kFormat); }

}  // namespace sparsha::pipeline
