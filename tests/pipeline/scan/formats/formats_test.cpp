// What each line of the table of formats promises elsewhere.
#include "pipeline/scan/formats/formats.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <string>

#include "base/files/files.h"
#include "pipeline/scan/foreign.h"

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;

std::string text_of(const char* file) { return read_file(fs::path(SPARSHA_SOURCE_DIR) / file, std::size_t{1} << 20); }

TEST(Formats, EachIsNamedInMessagesInTheDocumentAndAmongTheFuzzersNames) {
  const std::string known = kKnownFormats, document = text_of("docs/formats.md");
  const std::string fuzzer = text_of("tests/fuzz/scan_fuzz.cpp");
  for (const Format& format : formats()) {
    const std::string name(format.name);
    EXPECT_NE(known.find(name), std::string::npos) << name;
    EXPECT_NE(document.find(name), std::string::npos) << name;
    EXPECT_NE(fuzzer.find("\"s." + std::string(format.endings[0]) + "\""), std::string::npos) << name;
    EXPECT_TRUE(format.is != nullptr || format.by_ending) << name;
    EXPECT_NE(format.read, nullptr) << name;
  }
  EXPECT_EQ(formats().back().name, "XYZ") << "rows of numbers are what is left";
}

}  // namespace
}  // namespace sparsha::pipeline
