// A file that is written by the megabyte.
#pragma once

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"

namespace sparsha::pipeline {

/// Collects bytes and hands them to the file by the megabyte.
class Output {
 public:
  Output(const std::filesystem::path& file, std::string shown)
      : stream_(file, std::ios::binary), shown_(std::move(shown)) {
    check();
  }
  template <typename Word>
  void put(Word word) {
    static_assert(std::endian::native == std::endian::little, "PLY files are written little-endian");
    const std::size_t at = buffer_.size();
    buffer_.resize(at + sizeof(word));
    std::memcpy(&buffer_[at], &word, sizeof(word));
    flush(kBuffer);
  }
  template <typename... Values>
  void print(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(buffer_), format, std::forward<Values>(values)...);
    flush(kBuffer);
  }
  void close() {
    flush(0);
    stream_.close();
    check();
  }

 private:
  static constexpr std::size_t kBuffer = 1U << 20;  // bytes
  void flush(std::size_t limit) {
    if (buffer_.size() <= limit) return;
    stream_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
    check();
  }
  void check() {
    if (!stream_) {
      throw Error(ErrorKind::failure, {shown_, 0, 0}, "cannot be written: the disk may be full or the folder read-only",
                  "expected a folder that can be written to");
    }
  }
  std::ofstream stream_;
  std::string shown_;
  std::vector<char> buffer_;
};

}  // namespace sparsha::pipeline
