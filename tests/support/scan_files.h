// Small scan files that tests write themselves, and the real ones where they are.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "pipeline/scan/read_bytes.h"
#include "pipeline/scan/reader.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline::testing {

/// A folder of its own for each test, removed at the end.
class ScanFolder {
 public:
  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::filesystem::path file = folder_ / name;
    std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return file;
  }
  RawScan read(const std::string& name, std::string_view bytes) const { return read_scan(write(name, bytes)); }

 private:
  test::TestFolder folder_;
};

/// Appends the bytes of a value in either order.
template <typename T>
void put(std::string& bytes, T value, bool big = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (big) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

/// The error that reading gives; nothing when it succeeds. Other exceptions fail the test by passing through.
inline std::optional<Error> error_of(const std::filesystem::path& file) {
  try {
    (void)read_scan(file);
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

/// The same for bytes in memory.
inline std::optional<Error> error_of_bytes(const std::string& name, std::string_view bytes) {
  try {
    (void)read_scan_bytes(bytes, name);
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

/// Reading these bytes must give an input error that holds `message` and, where it is given, names `line`.
inline void expect_refused(const std::string& name, std::string_view bytes, const std::string& message,
                           std::optional<int> line = std::nullopt) {
  const std::optional<Error> error = error_of_bytes(name, bytes);
  ASSERT_TRUE(error) << name << ": " << message;
  EXPECT_EQ(error->kind(), ErrorKind::input);
  EXPECT_THAT(error->what(), ::testing::HasSubstr(message)) << name;
  EXPECT_EQ(error->place().line, line.value_or(error->place().line)) << name << ": " << message;
}

/// Folder of the real scans; skips the test when it is not there.
#define SPARSHA_REAL_SCANS_OR_SKIP(folder)                                                        \
  const char* const folder##_variable = std::getenv("SPARSHA_SCANS_DIR");                         \
  if (folder##_variable == nullptr) GTEST_SKIP() << "SPARSHA_SCANS_DIR names no folder of scans"; \
  const std::filesystem::path folder(folder##_variable)

}  // namespace sparsha::pipeline::testing
