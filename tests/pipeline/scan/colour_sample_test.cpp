// The scale of colours is that of all of a file, however dark it begins and however it is read.
#include <gmock/gmock.h>

#include <functional>
#include <utility>

#include <fmt/format.h>

#include "pipeline/scan/colour_sample.h"
#include "pipeline/scan/writer.h"
#include "tests/support/las_files.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::ElementsAre;
using testing::las_point;
using testing::LasFile;
using testing::put;
using testing::ScanFolder;
using testing::set;

/// Points of which the first have no light.
struct DarkFirst {
  int points = 2000;
  int dark = 1100;

  [[nodiscard]] int red(int i) const { return i < dark ? 0 : i % 256; }
  [[nodiscard]] int green(int i) const { return i < dark ? 0 : 255; }
  [[nodiscard]] std::vector<std::uint32_t> rgba() const {
    std::vector<std::uint32_t> all;
    for (int i = 0; i < points; ++i) {
      all.push_back(pack_rgba(static_cast<std::uint32_t>(red(i)), static_cast<std::uint32_t>(green(i)), 0));
    }
    return all;
  }
  /// Rows of coordinates and colours, whose largest value is `whole`.
  [[nodiscard]] std::string rows(int whole, const std::string& lead = "", const std::string& end = "") const {
    std::string text;
    const auto channel = [&](int value) {
      if (value == 0 || value == 255) return std::to_string(value == 0 ? 0 : whole);
      return whole == 1 ? fmt::format("{:.6f}", value / 255.0) : std::to_string(value * (whole / 255));
    };
    for (int i = 0; i < points; ++i) {
      text += fmt::format("{}{:.3f} {:.3f} 0.5 {} {} 0{}\n", lead, 0.25 * (i % 40), 0.25 * (i / 40), channel(red(i)),
                          channel(green(i)), end);
    }
    return text;
  }
  /// Three floats and three channels of that type for each.
  template <typename T>
  [[nodiscard]] std::string records(int unit, const std::string& lead = "") const {
    std::string bytes;
    for (int i = 0; i < points; ++i) {
      bytes += lead;
      for (const double x : {0.25 * (i % 40), 0.25 * (i / 40), 0.5}) put(bytes, static_cast<float>(x));
      for (const int value : {red(i), green(i), 0}) put(bytes, static_cast<T>(value * unit));
    }
    return bytes;
  }
};

std::string ply(const std::string& encoding, int points, const std::string& type, const std::string& list = "") {
  return fmt::format(
      "ply\nformat {0} 1.0\nelement vertex {1}\n{3}property float x\nproperty float y\nproperty float z\nproperty {2} "
      "red\nproperty {2} green\nproperty {2} blue\nend_header\n",
      encoding, points, type, list);
}

std::string pcd(int points, const std::string& encoding) {
  return fmt::format(
      "VERSION 0.7\nFIELDS x y z r g b\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F\nCOUNT 1 1 1 1 1 1\nWIDTH {0}\nHEIGHT "
      "1\nPOINTS {0}\nDATA {1}\n",
      points, encoding);
}

std::string las(const DarkFirst& cloud, int unit) {
  LasFile file;
  file.format = 2;
  for (int i = 0; i < cloud.points; ++i) {
    file.points.push_back(las_point(2, i % 40, i / 40, 0));
    set(file.points.back(), 20, static_cast<std::uint16_t>(cloud.red(i) * unit));
    set(file.points.back(), 22, static_cast<std::uint16_t>(cloud.green(i) * unit));
  }
  return file.bytes();
}

void expect_colours(const ScanFolder& folder, const std::string& name, const std::string& bytes,
                    const DarkFirst& cloud) {
  const std::filesystem::path file = folder.write(name, bytes);
  EXPECT_EQ(read_scan(file).rgba, cloud.rgba()) << name;
  std::vector<std::uint32_t> streamed;
  (void)stream_scan(
      file, [&](const PointBlock& block) { streamed.insert(streamed.end(), block.rgba.begin(), block.rgba.end()); });
  EXPECT_EQ(streamed, cloud.rgba()) << name << ", as a stream";
}

TEST(ColourScale, IsThatOfAllOfAFileThatBeginsBlack) {
  const ScanFolder folder;
  const DarkFirst cloud;
  const int n = cloud.points;
  constexpr int kWord = 65535;
  for (const int whole : {1, 255, kWord}) {
    const std::string scale = "_" + std::to_string(whole);
    expect_colours(folder, "named" + scale + ".txt", "X Y Z R G B\n" + cloud.rows(whole), cloud);
    expect_colours(folder, "rows" + scale + ".xyz", cloud.rows(whole), cloud);
    expect_colours(folder, "v" + scale + ".obj", cloud.rows(whole, "v "), cloud);
    expect_colours(folder, "c" + scale + ".off",
                   fmt::format("COFF\n{} 0 0\n", n) + cloud.rows(whole, "", " " + std::to_string(whole)), cloud);
    expect_colours(folder, "ascii" + scale + ".ply", ply("ascii", n, "float") + cloud.rows(whole), cloud);
    expect_colours(folder, "ascii" + scale + ".pcd", pcd(n, "ascii") + cloud.rows(whole), cloud);
  }
  for (const int unit : {1, 257}) {
    const std::string scale = "_" + std::to_string(unit);
    expect_colours(folder, "words" + scale + ".las", las(cloud, unit), cloud);
    expect_colours(folder, "words" + scale + ".ply",
                   ply("binary_little_endian", n, "ushort") + cloud.records<std::uint16_t>(unit), cloud);
    expect_colours(folder, "floats" + scale + ".ply",
                   ply("binary_little_endian", n, "float") + cloud.records<float>(unit), cloud);
    expect_colours(folder, "list" + scale + ".ply",
                   ply("binary_little_endian", n, "ushort", "property list uchar uchar tags\n") +
                       cloud.records<std::uint16_t>(unit, "\x02??"),
                   cloud);
    expect_colours(folder, "floats" + scale + ".pcd", pcd(n, "binary") + cloud.records<float>(unit), cloud);
  }
}

TEST(ColourScale, OfALongFileIsFoundInItsLastTenth) {
  const ScanFolder folder;
  const DarkFirst cloud{250'000, 240'000};
  constexpr int kWord = 65535;
  const std::string rows = cloud.rows(kWord);
  ASSERT_GT(rows.size(), std::size_t{4} << 20);
  expect_colours(folder, "long.xyz", rows, cloud);
  expect_colours(folder, "long.obj", cloud.rows(kWord, "v "), cloud);
  expect_colours(folder, "ascii.ply", ply("ascii", cloud.points, "float") + rows, cloud);
  expect_colours(folder, "long.ply",
                 ply("binary_little_endian", cloud.points, "ushort") + cloud.records<std::uint16_t>(257), cloud);
  expect_colours(folder, "long.las", las(cloud, 257), cloud);
}

TEST(ColourScale, AllowsForInterpolationThatOvershoots) {
  EXPECT_EQ(colour_scale(1.04, true), ColourScale::unit);
  EXPECT_EQ(colour_scale(258.0, true), ColourScale::byte);
  EXPECT_EQ(colour_scale(256.0, false), ColourScale::word);
}

TEST(SampledRecords, AreAllOfFewAndReachFromTheFirstToTheLastOfMany) {
  for (const std::uint64_t records :
       {std::uint64_t{0}, std::uint64_t{1}, kColourSample, kColourSample + 1, std::uint64_t{123'456'789'012}}) {
    std::vector<std::uint64_t> seen;
    at_sampled_records(records, [&](std::uint64_t i) {
      seen.push_back(i);
      return true;
    });
    ASSERT_EQ(seen.size(), std::min(records, kColourSample)) << records;
    EXPECT_TRUE(std::ranges::is_sorted(seen)) << records;
    EXPECT_TRUE(std::ranges::adjacent_find(seen) == seen.end()) << records;
    EXPECT_TRUE(records == 0 || (seen.front() == 0 && seen.back() == records - 1)) << records;
  }
}

TEST(SampledLines, AreWholeOnes) {
  EXPECT_THAT(sampled_lines("1 2\n3 4"), ElementsAre("1 2\n3 4"));
  std::string text;
  for (int i = 0; text.size() < std::size_t{6} << 20; ++i) text += std::to_string(1'000'000 + i) + "\r\n";
  const std::vector<std::string_view> parts = sampled_lines(text);
  EXPECT_EQ(parts.size(), 256U);
  for (const std::string_view part : parts) {
    const std::string_view line = part.substr(part.find_first_not_of("\r\n"), 8);
    EXPECT_TRUE(line.front() == '1' && line.back() == '\r') << line;
    EXPECT_TRUE(part.ends_with('\n') || part.ends_with('\r'));
  }
}

}  // namespace
}  // namespace sparsha::pipeline
