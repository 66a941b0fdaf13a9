// PLY: every encoding, type and order, and every lie a header can tell.
#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using testing::error_of_bytes;
using ::testing::HasSubstr;
using testing::put;
using testing::ScanFolder;

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

std::string header(const std::string& format, const std::string& rest) {
  return "ply\nformat " + format + " 1.0\n" + rest + "end_header\n";
}

TEST(PlyReader, ReadsAsciiFloats) {
  const ScanFolder folder;
  const RawScan scan = folder.read("a.ply", header("ascii", "element vertex 2\n" + kXyz) + "0 0.5 -1e-3\n1 2 3\n");
  EXPECT_EQ(scan.format, "PLY ascii");
  EXPECT_THAT(scan.fields, ElementsAre("x", "y", "z"));
  EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(0, 0.5, -1e-3), Eigen::Vector3d(1, 2, 3)));
  EXPECT_EQ(scan.records, 2U);
  EXPECT_EQ(scan.invalid, 0U);
}

TEST(PlyReader, RefusesABodyThatIsNotAsItsHeaderSays) {
  const std::string vertices = "element vertex 3\n" + kXyz;
  std::string bytes;
  for (const float value : {0.0F, 0.5F, -0.25F, 1.0F, 2.0F, 3.0F, 0.1F, 0.2F, 0.3F}) put(bytes, value);
  const std::string text = "0 0.5 -0.25\n1 2 3\n0.1 0.2 3e-1\n";
  const auto wrong = [&](const std::string& format, const std::string& body) {
    const std::optional<Error> error = error_of_bytes("a.ply", header(format, vertices) + body);
    return error ? std::string(error->what()) : "";
  };
  for (const std::string format : {"binary_little_endian", "binary_big_endian"}) {
    EXPECT_THAT(wrong(format, text + text), HasSubstr("numbers in text"));
    EXPECT_EQ(wrong(format, bytes), "");
  }
  EXPECT_THAT(wrong("ascii", bytes), HasSubstr("what follows it is binary"));
  EXPECT_EQ(wrong("ascii", text), "");
  EXPECT_THAT(wrong("ascii", "0 0.5 x\n1 2 3\n4 5 6\n"), HasSubstr("is not a number"));
}

TEST(PlyReader, SaysThatColoursOfFacesAreNotUsed) {
  const ScanFolder folder;
  const std::string mesh = "element vertex 3\n" + kXyz + "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string rows = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2";
  EXPECT_THAT(
      folder
          .read("a.ply", header("ascii", mesh + "property uchar red\nproperty uchar green\nproperty uchar blue\n") +
                             rows + " 9 8 7\n")
          .warnings,
      ElementsAre(HasSubstr("colour of 1 face is not used")));
  EXPECT_TRUE(folder.read("b.ply", header("ascii", mesh) + rows + "\n").warnings.empty());
}

TEST(PlyReader, AgreesWithIostreamOnRandomAsciiNumbers) {
  const ScanFolder folder;
  std::mt19937_64 random(42);
  std::uniform_real_distribution<double> mantissa(-10.0, 10.0);
  std::uniform_int_distribution<int> exponent(-30, 30);
  std::ostringstream text;
  text.precision(17);
  constexpr int kCount = 3000;
  for (int i = 0; i < kCount; ++i) {
    for (int k = 0; k < 3; ++k) text << mantissa(random) * std::pow(10.0, exponent(random)) << (k < 2 ? ' ' : '\n');
  }
  const RawScan scan = folder.read("a.ply", header("ascii",
                                                   "element vertex 3000\nproperty double x\nproperty double y\n"
                                                   "property double z\n") +
                                                text.str());
  ASSERT_EQ(scan.points.size(), static_cast<std::size_t>(kCount));
  std::istringstream again(text.str());
  for (const Eigen::Vector3d& point : scan.points) {
    double x = 0;
    double y = 0;
    double z = 0;
    again >> x >> y >> z;
    EXPECT_EQ(point, Eigen::Vector3d(x, y, z));
  }
}

TEST(PlyReader, ReadsDoublePropertiesWithoutLossInBothByteOrders) {
  const ScanFolder folder;
  const Eigen::Vector3d p(5412000.123456789, -1.0 / 3.0, 1e-300);
  for (const bool big : {false, true}) {
    std::string bytes = header(big ? "binary_big_endian" : "binary_little_endian",
                               "element vertex 1\nproperty double x\nproperty double y\nproperty double z\n");
    for (int k = 0; k < 3; ++k) put(bytes, p[k], big);
    EXPECT_THAT(folder.read("d.ply", bytes).points, ElementsAre(p));
  }
}

template <typename T>
void expect_type_reads(const ScanFolder& folder, const std::string& name, bool big) {
  std::string bytes = header(big ? "binary_big_endian" : "binary_little_endian",
                             "element vertex 2\nproperty " + name + " z\nproperty uchar skipped\nproperty " + name +
                                 " x\nproperty " + name + " y\n");
  for (const int base : {1, 60}) {
    put(bytes, static_cast<T>(base), big);
    put(bytes, std::uint8_t{200});
    put(bytes, static_cast<T>(base + 1), big);
    put(bytes, static_cast<T>(base + 2), big);
  }
  const RawScan scan = folder.read("t.ply", bytes);
  EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(2, 3, 1), Eigen::Vector3d(61, 62, 60)))
      << name << " big " << big;
}

TEST(PlyReader, ReadsEveryScalarTypeInAnyOrderOfProperties) {
  const ScanFolder folder;
  for (const bool big : {false, true}) {
    expect_type_reads<std::int8_t>(folder, "char", big);
    expect_type_reads<std::int8_t>(folder, "int8", big);
    expect_type_reads<std::uint8_t>(folder, "uchar", big);
    expect_type_reads<std::uint8_t>(folder, "uint8", big);
    expect_type_reads<std::int16_t>(folder, "short", big);
    expect_type_reads<std::int16_t>(folder, "int16", big);
    expect_type_reads<std::uint16_t>(folder, "ushort", big);
    expect_type_reads<std::uint16_t>(folder, "uint16", big);
    expect_type_reads<std::int32_t>(folder, "int", big);
    expect_type_reads<std::int32_t>(folder, "int32", big);
    expect_type_reads<std::uint32_t>(folder, "uint", big);
    expect_type_reads<std::uint32_t>(folder, "uint32", big);
    expect_type_reads<float>(folder, "float", big);
    expect_type_reads<float>(folder, "float32", big);
    expect_type_reads<double>(folder, "double", big);
    expect_type_reads<double>(folder, "float64", big);
  }
}

TEST(PlyReader, ReadsColoursOfBytesWordsAndFractionsAndIntensity) {
  const ScanFolder folder;
  const std::string colours = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  std::string bytes = header("binary_little_endian", "element vertex 1\n" + kXyz + colours);
  for (int i = 0; i < 3; ++i) put(bytes, 1.0F);
  for (const int c : {1, 2, 255}) put(bytes, static_cast<std::uint8_t>(c));
  EXPECT_THAT(folder.read("u8.ply", bytes).rgba, ElementsAre(0xFFFF0201U));

  const std::string fractions = "property float red\nproperty float green\nproperty float blue\nproperty float alpha\n";
  EXPECT_THAT(
      folder
          .read("f.ply", header("ascii", "element vertex 2\n" + kXyz + fractions) + "0 0 0 0 0.5 1 1\n1 1 1 1 1 1 0\n")
          .rgba,
      ElementsAre(0xFFFF8000U, 0x00FFFFFFU));
  const std::string words =
      "property ushort red\nproperty ushort green\nproperty ushort blue\nproperty float intensity\n";
  const RawScan scan =
      folder.read("w.ply", header("ascii", "element vertex 1\n" + kXyz + words) + "0 0 0 65535 0 32768 7.5\n");
  EXPECT_THAT(scan.rgba, ElementsAre(0xFF8000FFU));
  EXPECT_THAT(scan.intensity, ElementsAre(7.5F));
}

TEST(PlyReader, ReadsColoursThatArePackedIntoOneNumber) {
  const ScanFolder folder;
  const auto file_of = [](bool ascii, const std::string& properties, const std::vector<std::uint32_t>& values) {
    std::string bytes = header(ascii ? "ascii" : "binary_big_endian",
                               fmt::format("element vertex {}\n", values.size()) + kXyz + properties);
    for (const std::uint32_t value : values) {
      if (ascii) {
        bytes += fmt::format("0 0 0 {}\n", value);
        continue;
      }
      for (int i = 0; i < 3; ++i) put(bytes, 1.0F, true);
      if (properties.find("list") != std::string::npos) bytes += '\0';
      put(bytes, value, true);
    }
    return bytes;
  };
  const std::string packed = "property uint rgb\n";
  for (const std::uint32_t top : {0U, 0xFF000000U}) {
    const std::vector<std::uint32_t> values = {top | 0x0A141EU, top | 0xFFFFFFU, top};
    for (const std::string& file :
         {file_of(true, packed, values), file_of(false, packed, values), file_of(false, "property int rgb\n", values),
          file_of(false, "property list uchar uchar tags\n" + packed, values)}) {
      const RawScan scan = folder.read("p.ply", file);
      EXPECT_THAT(scan.rgba, ElementsAre(0xFF1E140AU, 0xFFFFFFFFU, 0xFF000000U));
      EXPECT_TRUE(scan.warnings.empty());
    }
    for (const bool ascii : {false, true}) {
      const RawScan named = folder.read("a.ply", file_of(ascii, "property uint rgba\n", values));
      EXPECT_THAT(named.rgba, ElementsAre(0xFF1E140AU, 0xFFFFFFFFU, 0xFF000000U)) << "as PCL packs them";
      const RawScan last =
          folder.read("b.ply", file_of(ascii, "property uint rgba\n", {0x0A141EFFU, 0xFFFFFFFFU, 255}));
      EXPECT_THAT(last.rgba, ElementsAre(0xFF1E140AU, 0xFFFFFFFFU, 0xFF000000U)) << "opacity in the last byte";
      const RawScan none = folder.read("c.ply", file_of(ascii, "property uint rgba\n", {5, 0x01000000U, 0x7F000002U}));
      EXPECT_TRUE(none.rgba.empty());
      EXPECT_THAT(none.warnings, ElementsAre(::testing::HasSubstr("'rgba' are not read as colours")));
    }
    // Other numbers of that name are no colours.
    for (const bool ascii : {false, true})
      EXPECT_TRUE(folder.read("p.ply", file_of(ascii, packed, {5, 0x01000000U, 0x7F000000U})).rgba.empty());
  }
}

TEST(PlyReader, PassesOverElementsBeforeTheVerticesAndListsAnywhere) {
  const ScanFolder folder;
  const std::string elements =
      "comment a camera and faces first\nobj_info more\nelement camera 1\nproperty float fov\nelement face 1\n"
      "property list uchar int vertex_indices\nproperty uchar flag\nelement vertex 3\nproperty list uchar short "
      "tags\n" +
      kXyz + "property list int double weights\nelement other 1\nproperty list uchar float data\n";
  const std::string ascii =
      header("ascii", elements) + "55.5\n3 2 1 0 9\n2 7 8 0 0 0 1 0.5\n0 1 0 0 0\n1 4 0 1 0 2 1 2\n4 1 2 3 4\n";
  std::string binary = header("binary_little_endian", elements);
  put(binary, 55.5F);
  put(binary, std::uint8_t{3});
  for (const int i : {2, 1, 0}) put(binary, std::int32_t{i});
  put(binary, std::uint8_t{9});
  for (int v = 0; v < 3; ++v) {
    put(binary, static_cast<std::uint8_t>(v));
    for (int t = 0; t < v; ++t) put(binary, std::int16_t{5});
    put(binary, v == 1 ? 1.0F : 0.0F);
    put(binary, v == 2 ? 1.0F : 0.0F);
    put(binary, 0.0F);
    put(binary, std::int32_t{1});
    put(binary, 0.25);
  }
  put(binary, std::uint8_t{0});
  for (const std::string& bytes : {ascii, binary}) {
    const RawScan scan = folder.read("m.ply", bytes);
    EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0)));
    EXPECT_THAT(scan.faces, ElementsAre(std::array<std::uint32_t, 3>{2, 1, 0}));
  }
}

TEST(PlyReader, TheUnitOfARemarkIsTakenOrSaid) {
  const ScanFolder folder;
  const auto read = [&](const std::string& remark) {
    return folder.read("u.ply", "ply\nformat ascii 1.0\n" + remark +
                                    "\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                                    "end_header\n1 2 3\n");
  };
  EXPECT_EQ(read("comment units: mm").unit, scene::LengthUnit::mm);
  EXPECT_EQ(read("obj_info Unit = cm").unit, scene::LengthUnit::cm);
  const RawScan inches = read("comment units: inches");
  EXPECT_EQ(inches.unit, std::nullopt);
  EXPECT_THAT(inches.warnings, Contains(HasSubstr("line 3 gives the coordinates in 'inches'")));
  EXPECT_EQ(read("comment unit test of mm").unit, std::nullopt);
}

TEST(PlyReader, CutsPolygonsAndStripsIntoTriangles) {
  const ScanFolder folder;
  const std::string vertices = "element vertex 5\n" + kXyz;
  const std::string body = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 2 0\n";
  EXPECT_EQ(folder
                .read("q.ply", header("ascii", vertices + "element face 1\nproperty list uchar int vertex_index\n") +
                                   body + "4 0 1 2 3\n")
                .faces.size(),
            2U);
  // A strip of four, a new one of three; odd triangles turn round so that all face the same way.
  const RawScan strip = folder.read("s.ply", header("ascii", vertices + "element tristrips 1\n"
                                                                        "property list int int vertex_indices\n") +
                                                 body + "8 0 1 3 2 -1 0 1 4\n");
  using Triangle = std::array<std::uint32_t, 3>;
  EXPECT_THAT(strip.faces, ElementsAre(Triangle{0, 1, 3}, Triangle{3, 1, 2}, Triangle{0, 1, 4}));
}

TEST(PlyReader, CutsAConcavePolygonWithinItsOutline) {
  const ScanFolder folder;
  // An L: a fan from its first corner would cover the notch.
  const RawScan scan = folder.read(
      "l.ply",
      header("ascii", "element vertex 6\n" + kXyz + "element face 1\nproperty list uchar int vertex_indices\n") +
          "0 2 0\n0 0 0\n2 0 0\n2 1 0\n1 1 0\n1 2 0\n6 0 1 2 3 4 5\n");
  ASSERT_EQ(scan.faces.size(), 4U);
  double area = 0.0;
  for (const auto& f : scan.faces) {
    const Eigen::Vector3d a = scan.points[f[1]] - scan.points[f[0]];
    const Eigen::Vector3d b = scan.points[f[2]] - scan.points[f[0]];
    const double twice = a.x() * b.y() - a.y() * b.x();
    EXPECT_GT(twice, 0.0);
    area += twice / 2.0;
  }
  EXPECT_DOUBLE_EQ(area, 3.0);
}

TEST(PlyReader, CountsPointsThatAreNotFiniteAndDropsTheirFaces) {
  const ScanFolder folder;
  const RawScan scan = folder.read(
      "n.ply",
      header("ascii", "element vertex 5\n" + kXyz + "element face 2\nproperty list uchar int vertex_indices\n") +
          "0 0 0\nnan 0 0\n1 0 0\n0 1 0\n0 -INF 0\n3 0 2 3\n3 0 1 2\n");
  EXPECT_EQ(scan.records, 5U);
  EXPECT_EQ(scan.invalid, 2U);
  EXPECT_EQ(scan.points.size(), 3U);
  EXPECT_THAT(scan.faces, ElementsAre(std::array<std::uint32_t, 3>{0, 1, 2}));
}

TEST(PlyReader, LeavesOutFacesOnVerticesThatDoNotExistAndSaysSo) {
  const ScanFolder folder;
  const RawScan scan = folder.read(
      "f.ply",
      header("ascii", "element vertex 3\n" + kXyz + "element face 3\nproperty list uchar int vertex_indices\n") +
          "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 3\n3 0 -1 2\n");
  EXPECT_EQ(scan.faces.size(), 1U);
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("2 faces")));
}

TEST(PlyReader, AcceptsUpperCaseNamesAndEveryLineEnd) {
  const ScanFolder folder;
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float X\nproperty float Y\nproperty float Z\n"
      "end_header\n1 2 3\n";
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string bytes;
    for (const char c : text) bytes += c == '\n' ? end : std::string(1, c);
    EXPECT_THAT(folder.read("e.ply", bytes).points, ElementsAre(Eigen::Vector3d(1, 2, 3)));
  }
}

TEST(PlyReader, StartsABinaryBodyRightBehindAHeaderOfCrlfLines) {
  const ScanFolder folder;
  std::string bytes =
      "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 1\r\nproperty float x\r\nproperty float y\r\n"
      "property float z\r\nend_header\r\n";
  // 0x0A and 0x0D as first bytes of the body must not be taken for a line end.
  put(bytes, std::uint32_t{0x3F800A0D});
  put(bytes, 2.0F);
  put(bytes, 3.0F);
  const RawScan scan = folder.read("c.ply", bytes);
  ASSERT_EQ(scan.points.size(), 1U);
  EXPECT_EQ(scan.points[0].y(), 2.0);
}

TEST(PlyReader, TakesADeclaredZeroAsZeroPoints) {
  const ScanFolder folder;
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const RawScan scan = folder.read("z.ply", header(format, "element vertex 0\n" + kXyz));
    EXPECT_EQ(scan.records, 0U);
    EXPECT_TRUE(scan.points.empty());
  }
}

struct Lie {
  const char* what;
  std::string bytes;
  const char* message;
  int line;
};

TEST(PlyReader, RefusesEveryLieWithItsLineAndReason) {
  const ScanFolder folder;
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::vector<Lie> lies = {
      {"empty", "", "empty", 0},
      {"no vertex element", header("ascii", face) + "3 0 1 2\n", "no vertex element", 0},
      {"no z", header("ascii", "element vertex 1\nproperty float x\nproperty float y\n") + "1 2\n", "no x, y and z", 3},
      {"x is a list",
       header("ascii", "element vertex 1\nproperty list uchar float x\nproperty float y\nproperty float z\n") +
           "1 2 3 4\n",
       "no x, y and z", 3},
      {"huge count, ascii", header("ascii", "element vertex 4000000000\n" + kXyz) + "1 2 3\n", "4000000000 records", 3},
      {"huge count, binary", header("binary_little_endian", "element vertex 4000000000\n" + kXyz) + "123456789012",
       "4000000000 records", 3},
      {"count beyond 64 bits", header("ascii", "element vertex 99999999999999999999999\n" + kXyz), "bad element line",
       3},
      {"negative count", header("ascii", "element vertex -1\n" + kXyz), "bad element line", 3},
      {"unknown type", header("ascii", "element vertex 1\nproperty real x\n"), "unknown property type", 4},
      {"unknown format", header("text", "element vertex 1\n" + kXyz), "unknown PLY format", 2},
      {"no format", "ply\nelement vertex 1\n" + kXyz + "end_header\n1 2 3\n", "no 'format'", 0},
      {"property first", "ply\nformat ascii 1.0\nproperty float x\nend_header\n", "before any element", 3},
      {"header breaks off", "ply\nformat ascii 1.0\nelement vertex 1\n", "breaks off", 4},
      {"unknown keyword", "ply\nformat ascii 1.0\nelemental vertex 1\nend_header\n", "unknown PLY header line", 3},
      {"float list length", header("ascii", "element vertex 1\n" + kXyz + "property list float int v\n"), "length", 7},
      {"too few values", header("ascii", "element vertex 2\n" + kXyz) + "1 2 3\n1 2\n\n", "too few values", 9},
      {"too many values", header("ascii", "element vertex 1\n" + kXyz) + "1 2 3 4\n", "more values", 8},
      {"a word", header("ascii", "element vertex 1\n" + kXyz) + "1 two 3\n", "'two 3' is not a number", 8},
      {"lines missing", header("ascii", "element vertex 2\n" + kXyz) + "1.00000 2.00000 3.00000\n", "ends after 1 of 2",
       8},
      {"list longer than its line",
       header("ascii", "element vertex 1\n" + kXyz + "property list uchar int v\n") + "1 2 3 9 1 2\n", "too few values",
       9},
      {"negative list length",
       header("ascii", "element vertex 1\n" + kXyz + "property list int int v\n") + "1 2 3 -4\n", "list length", 9},
      {"two vertex elements",
       header("ascii", "element vertex 1\n" + kXyz + "element vertex 1\n" + kXyz) + "1 2 3\n1 2 3\n",
       "second vertex element", 7},
  };
  for (const Lie& lie : lies) {
    const auto error = error_of_bytes("lie.ply", lie.bytes);
    ASSERT_TRUE(error) << lie.what;
    EXPECT_EQ(error->kind(), ErrorKind::input) << lie.what;
    EXPECT_THAT(error->what(), HasSubstr(lie.message)) << lie.what;
    EXPECT_EQ(error->place().line, lie.line) << lie.what;
    EXPECT_THAT(error->place().file, HasSubstr("lie.ply")) << lie.what;
  }
}

TEST(PlyReader, RefusesABinaryListThatRunsBeyondTheFile) {
  const ScanFolder folder;
  std::string bytes = header("binary_little_endian",
                             "element face 1\nproperty list uint int vertex_indices\nelement vertex 1\n" + kXyz);
  put(bytes, std::uint32_t{4000000000U});
  bytes.append(16, '\0');
  const auto error = error_of_bytes("b.ply", bytes);
  ASSERT_TRUE(error);
  EXPECT_THAT(error->what(), HasSubstr("ends within element 'face'"));
}

TEST(PlyReader, RefusesATruncationAtEveryByteOfABinaryFile) {
  const ScanFolder folder;
  std::string bytes = header("binary_big_endian",
                             "element vertex 3\n" + kXyz + "element face 1\nproperty list uchar int vertex_indices\n");
  for (int i = 0; i < 9; ++i) put(bytes, static_cast<float>(i), true);
  put(bytes, std::uint8_t{3});
  for (const int i : {0, 1, 2}) put(bytes, std::int32_t{i}, true);
  ASSERT_FALSE(error_of_bytes("whole.ply", bytes));
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    const auto error = error_of_bytes("cut.ply", std::string_view(bytes).substr(0, n));
    ASSERT_TRUE(error) << n << " of " << bytes.size() << " bytes";
    EXPECT_EQ(error->kind(), ErrorKind::input);
  }
}

TEST(PlyReader, TellsOfBytesBehindTheLastRecordAndRefusesACopyAsText) {
  const ScanFolder folder;
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 300\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n";
  for (int i = 0; i < 300; ++i) {
    for (const int value : {i, 10 * i, 2570 + i}) testing::put(bytes, static_cast<float>(value) * 0x1p-140F);
  }
  EXPECT_THAT(folder.read("a.ply", bytes).warnings, ::testing::IsEmpty());
  EXPECT_THAT(folder.read("a.ply", bytes + "\n").warnings, ::testing::IsEmpty());
  EXPECT_THAT(folder.read("a.ply", bytes + "12345").warnings, ::testing::ElementsAre(HasSubstr("5 bytes behind")));
  std::string copied;
  for (const char c : bytes) copied += c == '\n' ? std::string("\r\n") : std::string(1, c);
  ASSERT_GT(copied.size(), bytes.size() + 20);
  testing::expect_refused("a.ply", copied, "copied as text");
}

TEST(PlyReader, NotesNameSoftwareAndTextures) {
  const RawScan scan = read_scan_bytes(
      "ply\nformat ascii 1.0\ncomment TextureFile wall 1.jpg\ncomment   Created by Program\ncomment anything\n"
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n",
      "a.ply");
  EXPECT_THAT(scan.notes, ::testing::ElementsAre("PLY: texture wall 1.jpg", "PLY: Created by Program"));
  EXPECT_THAT(scan.warnings, ::testing::ElementsAre(HasSubstr("coordinates")));
  for (const std::string words : {"Created in RealityCapture v1.3", "Generated by Agisoft Metashape 2.1"}) {
    const std::string head = "ply\nformat ascii 1.0\ncomment " + words + "\nelement vertex 1\n";
    EXPECT_THAT(
        read_scan_bytes(head + "property float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n", "a.ply")
            .notes,
        ::testing::ElementsAre("PLY: " + words));
  }
}

}  // namespace
}  // namespace sparsha::pipeline
