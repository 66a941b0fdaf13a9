// E57: an own little writer makes files of every packing; what it packed must come back.
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "pipeline/scan/formats/e57/pages.h"
#include "tests/pipeline/scan/formats/e57/e57_file.h"

namespace sparsha::pipeline {
namespace {

using testing::Bits;
using testing::E57File;
using ::testing::ElementsAre;
using testing::error_of_bytes;
using testing::expect_refused;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::reals;
using testing::ScanFolder;
using testing::slow_crc32c;

TEST(Crc32c, MatchesTheBitwiseDefinitionAndItsCheckValue) {
  EXPECT_EQ(e57::crc32c("123456789"), 0xE3069283U);
  std::mt19937 random(1);
  std::string bytes;
  for (int n = 0; n < 100; ++n) {
    EXPECT_EQ(e57::crc32c(bytes), slow_crc32c(bytes));
    bytes += static_cast<char>(random());
  }
}

TEST(E57Reader, ReadsNormalsOfTheExtensionAndTurnsThemWithTheScan) {
  const ScanFolder folder;
  E57File file;
  file.records = 2;
  file.streams = {reals({1, 2}, true),    reals({3, 4}, true), reals({5, 6}, true),
                  reals({0.6, -1}, true), reals({0, 0}, true), reals({0.8, 0}, false)};
  for (const char* axis : {"cartesianX", "cartesianY", "cartesianZ", "nor:normalX", "nor:normalY"})
    file.prototype += std::string("<") + axis + " type=\"Float\" precision=\"single\"/>";
  file.prototype += "<nor:normalZ type=\"Float\"/>";
  // A quarter turn about z: x becomes y.
  file.before_points =
      "<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">1</w><x type=\"Float\"/>"
      "<y type=\"Float\"/><z type=\"Float\">1</z></rotation></pose>";
  const RawScan scan = folder.read("a.e57", file.bytes());
  ASSERT_EQ(scan.normals.size(), 2U);
  EXPECT_LT((scan.normals[0] - Eigen::Vector3f(0.0F, 0.6F, 0.8F)).norm(), 1e-6F);
  EXPECT_LT((scan.normals[1] - Eigen::Vector3f(0.0F, -1.0F, 0.0F)).norm(), 1e-6F);
  EXPECT_LT((scan.points[0] - Eigen::Vector3d(-3.0, 1.0, 5.0)).norm(), 1e-6);
}

TEST(E57Reader, ReadsSinglesDoublesAndPosesAcrossPacketsAndPages) {
  const ScanFolder folder;
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> z;
  for (int i = 0; i < 700; ++i) {
    x.push_back(0.25 * i);
    y.push_back(i / 3.0);
    z.push_back(-i);
  }
  E57File file;
  file.records = x.size();
  file.streams = {reals(x, true), reals(y, false), reals(z, true)};
  file.prototype =
      "<cartesianX type=\"Float\" precision=\"single\"/><cartesianY type=\"Float\"/>"
      "<cartesianZ type=\"Float\" precision=\"single\"/>";
  file.before_points =
      "<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">1</w><x type=\"Float\"/>"
      "<y type=\"Float\"/><z type=\"Float\">1</z></rotation><translation type=\"Structure\">"
      "<x type=\"Float\">10</x><y type=\"Float\">20</y><z type=\"Float\">3e1</z></translation></pose>";
  for (const std::size_t per_packet : {1U, 7U, 1000U}) {  // values are cut by the ends of packets
    file.per_packet = per_packet;
    const RawScan scan = folder.read("a.e57", file.bytes());
    EXPECT_EQ(scan.unit, scene::LengthUnit::m);
    ASSERT_EQ(scan.points.size(), x.size());
    ASSERT_EQ(scan.stations.size(), 1U);
    EXPECT_EQ(scan.stations[0].place, Eigen::Vector3d(10, 20, 30)) << "the scanner is its own origin";
    for (std::size_t i = 0; i < x.size(); ++i) {
      // A quarter turn about z: (x, y) becomes (-y, x); the quaternion need not be of unit length.
      EXPECT_LT((scan.points[i] - Eigen::Vector3d(10 - y[i], 20 + x[i], 30 + z[i])).norm(), 1e-12 * (700 + x[i]));
    }
  }
}

TEST(E57Reader, UnpacksIntegersOfEveryWidth) {
  const ScanFolder folder;
  std::mt19937_64 random(5);
  for (int bits = 0; bits <= 64; ++bits) {
    const std::uint64_t range = bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
    const std::int64_t minimum =
        bits == 64 ? std::numeric_limits<std::int64_t>::min() : -static_cast<std::int64_t>(range / 3);
    const auto maximum = static_cast<std::int64_t>(static_cast<std::uint64_t>(minimum) + range);
    Bits packed;
    std::vector<double> expected;
    std::vector<double> other;
    for (int i = 0; i < 100; ++i) {
      const std::uint64_t raw = bits == 0 ? 0 : random() & range;
      packed.add(raw, bits);
      const auto value = static_cast<std::int64_t>(static_cast<std::uint64_t>(minimum) + raw);
      expected.push_back(static_cast<double>(value) * 0.001 + 5.0);
      other.push_back(i);
    }
    E57File file;
    file.records = 100;
    file.streams = {packed.bytes(), reals(other, false), reals(other, false)};
    file.per_packet = 37;
    file.prototype = "<cartesianX type=\"ScaledInteger\" minimum=\"" + std::to_string(minimum) + "\" maximum=\"" +
                     std::to_string(maximum) +
                     "\" scale=\"0.001\" offset=\"5\"/><cartesianY type=\"Float\"/><cartesianZ type=\"Float\"/>";
    const RawScan scan = folder.read("i.e57", file.bytes());
    ASSERT_EQ(scan.points.size(), 100U) << bits;
    for (std::size_t i = 0; i < 100; ++i) ASSERT_EQ(scan.points[i].x(), expected[i]) << bits << " bits";
  }
}

TEST(E57Reader, TurnsSphericalCoordinatesAndDropsInvalidOnes) {
  const ScanFolder folder;
  Bits state;
  for (const int s : {0, 1, 2}) state.add(static_cast<std::uint64_t>(s), 2);
  E57File file;
  file.records = 3;
  file.streams = {reals({2, 2, 2}, false), reals({M_PI / 2, 0, 0}, false), reals({M_PI / 6, 0, 0}, false),
                  state.bytes()};
  file.prototype =
      "<sphericalRange type=\"Float\"/><sphericalAzimuth type=\"Float\"/><sphericalElevation type=\"Float\"/>"
      "<sphericalInvalidState type=\"Integer\" minimum=\"0\" maximum=\"2\"/>";
  const RawScan scan = folder.read("s.e57", file.bytes());
  EXPECT_EQ(scan.records, 3U);
  EXPECT_EQ(scan.invalid, 2U);
  ASSERT_EQ(scan.points.size(), 1U);
  EXPECT_LT((scan.points[0] - Eigen::Vector3d(0, std::sqrt(3.0), 1)).norm(), 1e-15 * 4);
}

TEST(E57Reader, ScalesColoursByTheirLimits) {
  const ScanFolder folder;
  E57File file;
  file.records = 1;
  Bits colour;
  colour.add(1023, 10);
  Bits half;
  half.add(512, 10);
  file.streams = {reals({0}, false), reals({0}, false), reals({0}, false), colour.bytes(),
                  half.bytes(),      half.bytes(),      reals({0.5}, true)};
  const std::string ten_bits = " type=\"Integer\" minimum=\"0\" maximum=\"1023\"/>";
  file.prototype = "<cartesianX type=\"Float\"/><cartesianY type=\"Float\"/><cartesianZ type=\"Float\"/><colorRed" +
                   ten_bits + "<colorGreen" + ten_bits + "<colorBlue" + ten_bits +
                   "<intensity type=\"Float\" precision=\"single\"/>";
  const RawScan scan = folder.read("c.e57", file.bytes());
  EXPECT_EQ(scan.rgba, std::vector<std::uint32_t>{0xFF8080FFU});
  EXPECT_EQ(scan.intensity, std::vector<float>{0.5F});
}

TEST(E57Reader, ColoursBeyondTheirLimitAreReadAsWhatTheyAreAndSaid) {
  const auto file_of = [](const std::string& type, const std::string& stream, std::optional<int> limit) {
    E57File file;
    file.records = 3;
    const std::string zeros = reals({0, 0, 0}, false);
    file.streams = {zeros, zeros, zeros, stream, stream, stream};
    file.prototype = "<cartesianX type=\"Float\"/><cartesianY type=\"Float\"/><cartesianZ type=\"Float\"/>";
    for (const std::string channel : {"Red", "Green", "Blue"}) file.prototype += "<color" + channel + type;
    if (limit) {
      file.before_points = fmt::format(
          "<colorLimits type=\"Structure\"><colorRedMinimum type=\"Integer\">0</colorRedMinimum>"
          "<colorRedMaximum type=\"Integer\">{}</colorRedMaximum></colorLimits>",
          *limit);
    }
    return file.bytes();
  };
  const auto integers = [](const std::vector<std::uint64_t>& values, int bits) {
    Bits stream;
    for (const std::uint64_t value : values) stream.add(value, bits);
    return stream.bytes();
  };
  const std::string floats = " type=\"Float\" precision=\"single\"/>";
  const std::string bytes = " type=\"Integer\" minimum=\"0\" maximum=\"255\"/>";
  const std::string words = " type=\"Integer\" minimum=\"0\" maximum=\"65535\"/>";
  const ScanFolder folder;
  const std::vector<std::uint32_t> expected = {0xFF000000U, 0xFF0A0A0AU, 0xFFFFFFFFU};
  for (const std::string& file :
       {file_of(floats, reals({0, 10, 255}, true), std::nullopt), file_of(bytes, integers({0, 10, 255}, 8), 1),
        file_of(words, integers({0, 2570, 65535}, 16), 0), file_of(floats, reals({0, 2570, 65535}, true), 0)}) {
    const RawScan scan = folder.read("c.e57", file);
    EXPECT_EQ(scan.rgba, expected);
    EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("beyond their limit of")));
  }
  for (const std::string& file :
       {file_of(floats, reals({0, 10 / 255.0, 1}, true), std::nullopt), file_of(floats, reals({0, 10, 255}, true), 255),
        file_of(bytes, integers({0, 10, 255}, 8), 255), file_of(words, integers({0, 10, 255}, 16), 0),
        file_of(words, integers({0, 2570, 65535}, 16), std::nullopt)}) {
    const RawScan scan = folder.read("c.e57", file);
    EXPECT_EQ(scan.rgba, expected);
    EXPECT_THAT(scan.warnings, IsEmpty());
  }
}

TEST(E57Reader, RefusesLiesAndDamage) {
  const ScanFolder folder;
  E57File file;
  file.records = 2;
  file.streams = {reals({1, 2}, false), reals({1, 2}, false), reals({1, 2}, false)};
  file.prototype = "<cartesianX type=\"Float\"/><cartesianY type=\"Float\"/><cartesianZ type=\"Float\"/>";
  ASSERT_FALSE(error_of_bytes("good.e57", file.bytes()));
  const auto refuse = [](const std::string& bytes, const char* message) { expect_refused("lie.e57", bytes, message); };
  const std::string good = file.bytes();
  for (std::size_t at = 48; at < good.size(); at += 101) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(bytes[at] ^ 4);
    refuse(bytes, "checksum of page");
  }
  for (std::size_t n = 0; n < good.size(); n += 13) {
    EXPECT_TRUE(error_of_bytes("cut.e57", std::string_view(good).substr(0, n))) << n;
  }
  E57File lie = file;
  lie.records = 4000000000U;
  refuse(lie.bytes(), "4000000000 points cannot be");
  lie.records = 3;
  refuse(lie.bytes(), "end after 2 of 3 points");
  lie = file;
  lie.prototype = "<cartesianX type=\"Float\"/><cartesianY type=\"Float\"/>";
  refuse(lie.bytes(), "neither Cartesian nor spherical");
  lie.prototype = file.prototype + "<intensity type=\"Float\"/>";
  refuse(lie.bytes(), "packet of 3 streams");
  lie.prototype = "<cartesianX type=\"Integer\" minimum=\"5\" maximum=\"4\"/>" + file.prototype;
  refuse(lie.bytes(), "maximum below its minimum");
  lie.prototype = "<cartesianX type=\"Float\">";
  refuse(lie.bytes(), "XML section is damaged");
  // Constant coordinates take no bits; then nothing bounds the number of records but us.
  lie.prototype =
      "<cartesianX type=\"Integer\" minimum=\"5\" maximum=\"5\"/><cartesianY type=\"Integer\" minimum=\"5\" "
      "maximum=\"5\"/><cartesianZ type=\"Integer\" minimum=\"5\" maximum=\"5\"/>";
  lie.records = 4000000000U;
  refuse(lie.bytes(), "cannot be");
}

TEST(E57Reader, RefusesNumbersOfItsXmlThatAreNoneInsteadOfTakingDefaults) {
  const ScanFolder folder;
  const auto with = [](const std::string& attributes, const std::string& shift) {
    E57File file;
    for (const char axis : {'X', 'Y', 'Z'}) {
      file.prototype += std::string("<cartesian") + axis + " type=\"ScaledInteger\" maximum=\"7\" " + attributes + "/>";
      file.streams.emplace_back(1, '\x0A');
    }
    file.before_points = "<pose><translation><x> " + shift + "\n</x></translation></pose>";
    file.records = 2;
    return file.bytes();
  };
  const auto refuse = [](const std::string& bytes, const char* message) {
    expect_refused("number.e57", bytes, message);
  };
  EXPECT_EQ(folder.read("good.e57", with("minimum=\"0\" scale=\"0.5\"", "100")).points.at(0),
            Eigen::Vector3d(101, 1, 1));
  EXPECT_EQ(folder.read("whole.e57", with("minimum=\"0.0\"", "")).points.at(0), Eigen::Vector3d(2, 2, 2));
  refuse(with("minimum=\"0\" scale=\"abc\"", "0"), "'abc' as 'scale'");
  refuse(with("minimum=\"0\" scale=\"0\"", "0"), "scale of zero");
  refuse(with("minimum=\"0.5\"", "0"), "'0.5' as 'minimum'");
  refuse(with("minimum=\"zero\"", "0"), "'zero' as 'minimum'");
  refuse(with("minimum=\"0\"", "1,5"), "'1,5' as 'x'");
  refuse(with("minimum=\"0\"", "nan"), "'nan' as 'x'");
}

constexpr const char* kCartesian =
    "<cartesianX type=\"Float\"/><cartesianY type=\"Float\"/><cartesianZ type=\"Float\"/>";

E57File station(const std::string& name, const std::vector<double>& x) {
  E57File scan;
  scan.before_points = "<guid type=\"String\">{" + name + "}</guid><name type=\"String\">Station " + name + "</name>";
  scan.prototype = kCartesian;
  scan.records = x.size();
  scan.streams = {reals(x, false), reals(x, false), reals(x, false)};
  return scan;
}

E57File coloured_station(const std::string& name, const std::vector<double>& x) {
  E57File scan = station(name, x);
  for (const char* colour : {"Red", "Green", "Blue"}) {
    scan.prototype += std::string("<color") + colour + " type=\"Integer\" minimum=\"0\" maximum=\"255\"/>";
    scan.streams.emplace_back(x.size(), '\x10');
  }
  scan.prototype += "<intensity type=\"Float\" precision=\"single\"/>";
  scan.streams.push_back(reals(std::vector<double>(x.size(), 0.5), true));
  return scan;
}

TEST(E57Reader, GreyAndColouredScansOfOneFileKeepWhatTheyHave) {
  const ScanFolder folder;
  const RawScan scan = folder.read("mixed.e57", E57File::bytes_of({station("a", {1, 2}), coloured_station("b", {3}),
                                                                   station("empty", {}), station("c", {4})}));
  EXPECT_EQ(scan.points.size(), 4U);
  EXPECT_EQ(scan.scans, 4U);
  EXPECT_THAT(scan.rgba, ::testing::ElementsAre(kNoColour, kNoColour, 0xFF101010U, kNoColour));
  EXPECT_THAT(scan.intensity, ::testing::ElementsAre(::testing::IsNan(), ::testing::IsNan(), 0.5F, ::testing::IsNan()));
  EXPECT_THAT(scan.fields, ::testing::Contains("colorRed"));
  EXPECT_THAT(scan.warnings, ::testing::ElementsAre(::testing::AllOf(HasSubstr("scan 3 of the file, Station empty"),
                                                                     HasSubstr("has no points"))));
}

TEST(E57Reader, AScanThatCannotBeReadIsAWarningThatNamesItAndTheOthersAreRead) {
  const ScanFolder folder;
  E57File blind = station("blind", {7, 8});
  blind.prototype = "<intensity type=\"Float\"/>";
  E57File packed = station("packed", {7, 8});
  packed.codecs = "<vectorChild type=\"Structure\"><draco type=\"Structure\"/></vectorChild>";
  E57File cut = station("cut", {5, 6});
  cut.records = 3;
  const std::vector<E57File> scans = {station("a", {1, 2}), blind, packed, cut, coloured_station("b", {3})};
  const RawScan scan = folder.read("mixed.e57", E57File::bytes_of(scans));
  EXPECT_EQ(scan.points.size(), 5U) << "of the cut one what it has";
  EXPECT_EQ(scan.rgba.back(), 0xFF101010U);
  using ::testing::AllOf;
  EXPECT_THAT(scan.warnings,
              ::testing::UnorderedElementsAre(
                  AllOf(HasSubstr("scan 2 of the file, Station blind, {blind}"), HasSubstr("neither Cartesian")),
                  AllOf(HasSubstr("scan 3 of the file, Station packed"), HasSubstr("left out"), HasSubstr("codec")),
                  AllOf(HasSubstr("scan 4 of the file, Station cut"), HasSubstr("only 2 of its points"))));
  expect_refused("none.e57", E57File::bytes_of({blind, packed}),
                 "Station blind, {blind}: a scan has neither Cartesian");
}

TEST(E57Reader, NotesSayWhoWroteAndScannedItAndWhatIsNotRead) {
  E57File first = coloured_station("a", {1, 2, 3});
  first.before_points +=
      "<sensorVendor type=\"String\">Maker</sensorVendor><sensorModel type=\"String\">M\x01k 2</sensorModel>"
      "<pose type=\"Structure\"><translation type=\"Structure\"><x type=\"Float\">1</x></translation></pose>";
  E57File second = coloured_station("b", {4});
  second.before_points +=
      "<indexBounds type=\"Structure\"><rowMinimum type=\"Integer\">0</rowMinimum><rowMaximum type=\"Integer\"> 99 "
      "</rowMaximum><columnMinimum type=\"Integer\">0</columnMinimum><columnMaximum type=\"Integer\">199"
      "</columnMaximum></indexBounds>";
  first.beside =
      "<e57LibraryVersion type=\"String\">Lib 1</e57LibraryVersion><images2D type=\"Vector\">"
      "<vectorChild type=\"Structure\"><pinholeRepresentation type=\"Structure\"/></vectorChild>"
      "<vectorChild type=\"Structure\"><sphericalRepresentation type=\"Structure\"/></vectorChild>"
      "<vectorChild type=\"Structure\"><pinholeRepresentation type=\"Structure\"/></vectorChild></images2D>";
  const ScanFolder folder;
  const RawScan scan = folder.read("a.e57", E57File::bytes_of({first, second}));
  EXPECT_EQ(scan.points.size(), 4U);
  EXPECT_THAT(scan.notes, ::testing::ElementsAre("E57: written by Lib 1", "E57: scanned by Maker M?k 2",
                                                 "E57: 1 scan positions", "E57: rows 0 to 99, columns 0 to 199",
                                                 "E57: 3 pictures, which are not read, 2 pinhole, 1 spherical"));
  EXPECT_THAT(folder.read("b.e57", E57File::bytes_of({coloured_station("b", {4})})).notes, ::testing::IsEmpty());
}

}  // namespace
}  // namespace sparsha::pipeline
