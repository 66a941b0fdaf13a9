// PCD: three encodings, any field types, counts and padding, and headers that lie.
#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "pipeline/scan/formats/pcd/lzf.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::ElementsAre;
using testing::error_of_bytes;
using testing::expect_refused;
using ::testing::HasSubstr;
using testing::put;
using testing::ScanFolder;

std::string header(const std::string& fields, const std::string& sizes, const std::string& types,
                   const std::string& counts, int points, const std::string& data) {
  const std::string n = std::to_string(points);
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + sizes + "\nTYPE " +
         types + "\nCOUNT " + counts + "\nWIDTH " + n + "\nHEIGHT 1\nVIEWPOINT 1 2 3 0.5 0.5 0.5 0.5\nPOINTS " + n +
         "\nDATA " + data + "\n";
}

/// The plainest LZF stream: literals only.
std::string lzf_literals(const std::string& bytes) {
  std::string out;
  for (std::size_t at = 0; at < bytes.size(); at += 32) {
    const std::size_t n = std::min<std::size_t>(32, bytes.size() - at);
    out += static_cast<char>(n - 1);
    out += bytes.substr(at, n);
  }
  return out;
}

TEST(Lzf, ExpandsLiteralsNearAndFarCopiesAndRuns) {
  const auto expand = [](const std::string& in, std::size_t size) {
    std::string out(size, '?');
    return lzf_decompress(in, out) ? out : std::string("damaged");
  };
  EXPECT_EQ(expand(std::string("\x02"
                               "abc",
                               4),
                   3),
            "abc");
  // Copy of length 3 from 3 back; a run of length 5 from 1 back.
  EXPECT_EQ(expand(std::string("\x02"
                               "abc\x20\x02\x60\x00",
                               8),
                   11),
            "abcabcccccc");
  // The longest form: 7 + 1 more + 2 bytes from 1 back.
  EXPECT_EQ(expand(std::string("\x00z\xE0\x01\x00", 5), 11), "zzzzzzzzzzz");
}

TEST(Lzf, RefusesDamagedStreams) {
  std::string out(8, '?');
  EXPECT_FALSE(lzf_decompress(std::string("\x05"
                                          "ab",
                                          3),
                              out));                                       // literals end early
  EXPECT_FALSE(lzf_decompress(std::string("\x00z\x20\x05", 4), out));      // from before the beginning
  EXPECT_FALSE(lzf_decompress(std::string("\x00z\x20", 3), out));          // no distance
  EXPECT_FALSE(lzf_decompress(std::string("\x00z\xE0", 3), out));          // no length
  EXPECT_FALSE(lzf_decompress(std::string("\x00z", 2), out));              // too little
  EXPECT_FALSE(lzf_decompress(std::string("\x00z\xE0\x20\x00", 5), out));  // too much
}

TEST(PcdReader, ReadsAsciiBinaryAndCompressedAlike) {
  const ScanFolder folder;
  std::string rows;
  std::string columns;
  const float x[] = {1, 2, 3};
  const float y[] = {-1, 0.5F, 1e-3F};
  const double z[] = {5412000.25, 0, 7};
  for (int i = 0; i < 3; ++i) {
    put(rows, x[i]);
    put(rows, std::uint8_t{7});
    put(rows, std::uint8_t{8});
    put(rows, y[i]);
    put(rows, z[i]);
  }
  for (const float v : x) put(columns, v);
  columns.append(6, '\7');
  for (const float v : y) put(columns, v);
  for (const double v : z) put(columns, v);
  const auto head = [](const std::string& data) { return header("x _ y z", "4 1 4 8", "F U F F", "1 2 1 1", 3, data); };
  const std::string packed = lzf_literals(columns);
  std::string compressed = head("binary_compressed");
  put(compressed, static_cast<std::uint32_t>(packed.size()));
  put(compressed, static_cast<std::uint32_t>(columns.size()));
  compressed += packed;
  const std::string ascii = head("ascii") + "1 7 8 -1 5412000.25\n2 7 8 0.5 0\n3 7 8 0.001 7\n";
  for (const std::string& bytes : {ascii, head("binary") + rows, compressed}) {
    const RawScan scan = folder.read("a.pcd", bytes);
    ASSERT_EQ(scan.points.size(), 3U) << scan.format;
    EXPECT_EQ(scan.points[0], Eigen::Vector3d(1, -1, 5412000.25));
    EXPECT_EQ(scan.points[1], Eigen::Vector3d(2, 0.5, 0));
    EXPECT_NEAR(scan.points[2].y(), 1e-3, 1e-10);
    EXPECT_THAT(scan.fields, ElementsAre("x", "y", "z"));
    ASSERT_TRUE(scan.viewpoint);
    EXPECT_THAT(*scan.viewpoint, ElementsAre(1, 2, 3, 0.5, 0.5, 0.5, 0.5));
  }
}

TEST(PcdReader, ReadsUpperCaseIntegerCoordinatesCommasAndCrlf) {
  const ScanFolder folder;
  std::string text = header("X Y Z", "4 2 1", "I U I", "1 1 1", 2, "ascii") + "1,2,3\n-4 , 5 ,6\n";
  std::string crlf;
  for (const char c : text) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_THAT(folder.read("c.pcd", crlf).points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(-4, 5, 6)));
}

TEST(PcdReader, ReadsLinesThatEndWithCrAlone) {
  const ScanFolder folder;
  const auto with_cr = [](std::string text) {
    std::replace(text.begin(), text.end(), '\n', '\r');
    return text;
  };
  const std::string head = header("x y z", "4 4 4", "F F F", "1 1 1", 2, "ascii");
  EXPECT_THAT(folder.read("c.pcd", with_cr(head + "1 2 3\n-4 5 6\n")).points,
              ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(-4, 5, 6)));
  // A header that was rewritten before bytes that hold line feeds.
  std::string body;
  for (const std::uint32_t bits : {0x3F800A0AU, 0x40000A0DU, 0x40400D0AU}) put(body, bits);
  const RawScan binary = folder.read("b.pcd", with_cr(header("x y z", "4 4 4", "F F F", "1 1 1", 1, "binary")) + body);
  EXPECT_THAT(binary.points,
              ElementsAre(Eigen::Vector3d(std::bit_cast<float>(0x3F800A0AU), std::bit_cast<float>(0x40000A0DU),
                                          std::bit_cast<float>(0x40400D0AU))));
}

TEST(PcdReader, ReadsOldHeadersWithoutSizesCountsOrPoints) {
  const ScanFolder folder;
  EXPECT_THAT(
      folder.read("o.pcd", "# .PCD v.5\nVERSION .5\nCOLUMNS x y z\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 3\n").points,
      ElementsAre(Eigen::Vector3d(1, 2, 3)));
}

TEST(PcdReader, UnpacksColoursFromFloatsIntegersAndChannels) {
  const ScanFolder folder;
  std::string bytes = header("x y z rgb", "4 4 4 4", "F F F F", "1 1 1 1", 1, "binary");
  for (int i = 0; i < 3; ++i) put(bytes, 0.0F);
  put(bytes, std::uint32_t{0x00010203});
  EXPECT_THAT(folder.read("f.pcd", bytes).rgba, ElementsAre(0xFF030201U));
  EXPECT_THAT(
      folder.read("i.pcd", header("x y z rgb", "4 4 4 4", "F F F I", "1 1 1 1", 1, "ascii") + "0 0 0 -16711165\n").rgba,
      ElementsAre(0xFF030201U));
  EXPECT_THAT(
      folder.read("u.pcd", header("x y z rgba", "4 4 4 4", "F F F U", "1 1 1 1", 1, "ascii") + "0 0 0 2130772483\n")
          .rgba,
      ElementsAre(0x7F030201U));
  // 0x010203 as the bits of a float
  EXPECT_THAT(
      folder.read("t.pcd", header("x y z rgb", "4 4 4 4", "F F F F", "1 1 1 1", 1, "ascii") + "0 0 0 9.2557e-41\n")
          .rgba,
      ElementsAre(::testing::_));
  EXPECT_THAT(folder
                  .read("c.pcd", header("x y z red green blue intensity", "4 4 4 1 1 1 4", "F F F U U U F",
                                        "1 1 1 1 1 1 1", 1, "ascii") +
                                     "0 0 0 1 2 3 0.25\n")
                  .rgba,
              ElementsAre(0xFF030201U));
}

TEST(PcdReader, CountsInvalidPointsOfAnOrganisedCloud) {
  const ScanFolder folder;
  const RawScan scan = folder.read("n.pcd",
                                   "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 2\n"
                                   "POINTS 4\nDATA ascii\n0 0 0\nnan nan nan\n1 inf 2\n1 1 1\n");
  EXPECT_EQ(scan.records, 4U);
  EXPECT_EQ(scan.invalid, 2U);
}

TEST(PcdReader, RefusesLies) {
  const ScanFolder folder;
  const auto refuse = [](const std::string& bytes, const char* message) { expect_refused("lie.pcd", bytes, message); };
  const std::string one(12, '\0');
  refuse("1 2 3\n", "no PCD header");
  refuse(header("rgba", "4", "U", "1", 1, "ascii") + "5\n", "no x, y and z");
  refuse(header("x y z", "4 4 4", "F F F", "1 1 0", 1, "ascii") + "1 2\n", "no x, y and z");
  refuse(header("x y z", "4 4 4", "F F F", "1 1 1", 2000000000, "binary") + one, "2000000000 points cannot be");
  refuse(header("x y z", "4 4 4", "F F F", "1 1 1", 2000000000, "ascii") + "1 2 3\n", "2000000000 points cannot be");
  refuse(header("x y z", "4 4 4", "F F F", "1 1 4000000000", 1, "binary") + one, "more values than the file has bytes");
  refuse(header("x y z", "4 4", "F F F", "1 1 1", 1, "binary") + one, "SIZE has 2 entries");
  refuse(header("x y z", "4 4 3", "F F F", "1 1 1", 1, "binary") + one, "impossible TYPE and SIZE");
  refuse(header("x y z", "4 4 4", "F F Q", "1 1 1", 1, "binary") + one, "impossible TYPE and SIZE");
  refuse(header("x y z", "4 4 4", "F F F", "1 1 1", 1, "zip") + one, "unknown PCD data kind");
  refuse(header("x y z", "4 4 4", "F F F", "1 1 1", 1, "ascii") + "1 2\n    \n", "2 values in a line");
  refuse(header("x y z", "4 4 4", "F F F", "1 1 1", 2, "ascii") + "1.00000 2.00000 3.00000\n", "ends after 1 of 2");
  refuse(header("x y z", "4 4 4", "F F F", "1 1 1", 1, "ascii") + "1 two 3\n", "not a line of numbers");
  refuse("VERSION .7\nFIELDS x y z\nWIDTH 3\nHEIGHT 2\nPOINTS 5\nDATA ascii\n", "POINTS is 5 but WIDTH x HEIGHT is 6");
  refuse("VERSION .7\nFIELDS x y z\nWIDTH 9223372036854775807\nHEIGHT 9\nDATA binary\n", "beyond any file");
  refuse("VERSION .7\nFIELDS x y z\nWIDTH 1\n", "breaks off");
  std::string damaged = header("x y z", "4 4 4", "F F F", "1 1 1", 1, "binary_compressed");
  refuse(damaged, "breaks off");
  put(damaged, std::uint32_t{2});
  put(damaged, std::uint32_t{12});
  refuse(damaged + "\x01z", "damaged");
  refuse(damaged, "should have 2 bytes");
}

TEST(PcdReader, RefusesATruncationAtEveryByteOfABinaryFile) {
  const ScanFolder folder;
  std::string bytes = header("x y z", "4 4 4", "F F F", "1 1 1", 2, "binary") + std::string(24, '\1');
  ASSERT_FALSE(error_of_bytes("whole.pcd", bytes));
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    EXPECT_TRUE(error_of_bytes("cut.pcd", std::string_view(bytes).substr(0, n))) << n;
  }
}

}  // namespace
}  // namespace sparsha::pipeline
