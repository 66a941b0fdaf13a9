// What each line of the table of formats promises elsewhere.
#include "pipeline/scan/formats/formats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "base/files/files.h"
#include "pipeline/scan/foreign.h"
#include "pipeline/scan/read_bytes.h"
#include "tests/fuzz/scan_names.h"
#include "tests/support/wave_files.h"

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;

std::string text_of(const char* file) { return read_file(fs::path(SPARSHA_SOURCE_DIR) / file, std::size_t{1} << 20); }

/// The cells of the document's table of formats, row by row.
std::vector<std::array<std::string, 2>> rows_of(const std::string& document) {
  std::vector<std::array<std::string, 2>> rows;
  const std::size_t table = document.find("| format | endings | what is read |");
  std::istringstream lines(document.substr(std::min(table, document.size())));
  for (std::string line; std::getline(lines, line) && line.starts_with('|');) {
    const std::size_t first = line.find('|', 1), second = line.find('|', first + 1);
    rows.push_back({line.substr(1, first - 1), line.substr(first, second - first)});
  }
  return rows;
}

/// Whether one of them names the format and all of its endings.
bool has_row(const std::vector<std::array<std::string, 2>>& rows, const Format& format) {
  return std::ranges::any_of(rows, [&](const auto& row) {
    const std::size_t at = row[0].find(format.name);
    if (at == std::string::npos) return false;
    return std::ranges::all_of(format.endings, [&](std::string_view ending) {
      return ending.empty() || row[1].find("`." + std::string(ending) + "`") != std::string::npos;
    });
  });
}

TEST(Formats, EachHasReaderEndingMessageRowOfTheDocumentNameForTheFuzzerAndHostileFiles) {
  const std::string known = kKnownFormats;
  const auto rows = rows_of(text_of("docs/formats.md"));
  ASSERT_GT(rows.size(), 10U);
  for (const Format& format : formats()) {
    const std::string name(format.name);
    EXPECT_NE(known.find(name), std::string::npos) << name << " is in no message";
    EXPECT_TRUE(has_row(rows, format)) << name << " has no row with its endings in docs/formats.md";
    EXPECT_TRUE(std::ranges::any_of(format.endings, [](std::string_view ending) { return !ending.empty(); })) << name;
    for (const std::string_view ending : format.endings) {
      EXPECT_TRUE(ending.empty() || std::ranges::count(fuzz::kScanNames, "s." + std::string(ending)) == 1)
          << name << ": ." << ending << " is no name for the fuzzer";
    }
    // Of these, damaged files, seeds of the fuzzer and the bench are made.
    EXPECT_TRUE(
        std::ranges::any_of(testing::wave_files(), [&](const auto& wave) { return wave.format == format.name; }))
        << name << " has no file in tests/support/wave_files.cpp";
    EXPECT_TRUE(format.is != nullptr || format.by_ending) << name;
    EXPECT_NE(format.read, nullptr) << name << " has no reader";
  }
  EXPECT_EQ(formats().back().name, "XYZ") << "rows of numbers are what is left";
}

TEST(Formats, AFileOfEachIsReadAsItAndGivesTheSameSurface) {
  const testing::Waves waves{20};
  for (const testing::WaveFile& wave : testing::wave_files()) {
    const std::string name(wave.name);
    const RawScan scan = read_scan_bytes(wave.bytes(waves), name);
    const std::string format(wave.format == "GLB" ? "glTF" : wave.format);
    EXPECT_TRUE(scan.format.starts_with(format)) << name << ": " << scan.format;
    // A point in the scanner's place is none in PTX.
    EXPECT_EQ(scan.invalid, wave.format == "PTX" ? 1U : 0U) << name;
    ASSERT_EQ(scan.points.size() + scan.invalid, static_cast<std::size_t>(waves.points())) << name;
    const double scale = wave.format == "3MF" ? 1e-3 : 1.0;
    const double origin = 100.0 * std::round(scan.points.front().x() / 100.0);  // LAS files have one
    for (const Eigen::Vector3d& q : scan.points) {
      const Eigen::Vector3d p = q - Eigen::Vector3d::Constant(origin);
      const int n = static_cast<int>(std::lround(1e3 * scale * p.x())) +
                    waves.side * static_cast<int>(std::lround(1e3 * scale * p.y()));
      ASSERT_TRUE(n >= 0 && n < waves.points()) << name;
      constexpr double kSpzStep_m = 0.5 / 4096.0;  // the coarsest; others have a hundredth of a millimetre or less
      EXPECT_NEAR(scale * p.z(), waves.z(n), kSpzStep_m + 1e-6) << name;
    }
  }
}

}  // namespace
}  // namespace sparsha::pipeline
