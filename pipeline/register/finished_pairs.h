// Results of pairs of scans, kept in a file until all poses are found: a registration that was ended goes on from them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace sparsha::pipeline {

/// A text file: a line that names its format, then a line for each pair: its key, the numbers of its result, and a
/// SHA-256 of both. A pair whose key is another one (other scans, another rough pose, another program) is not found,
/// and stays in the file.
class FinishedPairs {
 public:
  /// Opens the file, or makes it; a line that was being written is left out. `program` is part of every key. Throws
  /// Error{failure} when it cannot be written, or is a file of something else.
  FinishedPairs(std::filesystem::path file, std::string program);

  /// The key of a result: a SHA-256 of `kind`, the program, the scans' digests and all numbers that decide it.
  [[nodiscard]] std::string key_of(const char* kind, std::span<const std::string> digests,
                                   std::span<const double> numbers) const;
  /// The numbers under a key; false when there are none. Thread-safe.
  [[nodiscard]] bool find(const std::string& key, std::vector<double>& numbers);
  /// Throws Error{failure} when the disk is full. Thread-safe.
  void add(const std::string& key, const std::vector<double>& numbers);

  /// How many results were found under their keys.
  [[nodiscard]] std::size_t taken() const;

 private:
  std::filesystem::path file_;
  std::string program_;
  mutable std::mutex mutex_;
  std::map<std::string, std::vector<double>> results_;
  std::size_t taken_ = 0;
  std::ofstream stream_;
};

/// Removes a file of finished pairs; any other file, a folder or a link stays.
void remove_finished_pairs(const std::filesystem::path& file);

}  // namespace sparsha::pipeline
