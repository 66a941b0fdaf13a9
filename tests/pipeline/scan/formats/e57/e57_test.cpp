// E57: an own little writer makes files of every packing; what it packed must come back.
#include <bit>
#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>

#include "base/png.h"
#include "pipeline/scan/formats/e57/pages.h"
#include "pipeline/scan/writer.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::ElementsAre;
using testing::error_of_bytes;
using testing::expect_refused;
using ::testing::HasSubstr;
using testing::put;
using testing::ScanFolder;

/// CRC-32C bit by bit.
std::uint32_t slow_crc32c(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? crc >> 1 ^ 0x82F63B78U : crc >> 1;
  }
  return ~crc;
}

/// Bits of one field, least significant first.
class Bits {
 public:
  void add(std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i) {
      if (filled_ % 8 == 0) bytes_ += '\0';
      if ((value >> i & 1) != 0) bytes_.back() = static_cast<char>(bytes_.back() | (1 << (filled_ % 8)));
      ++filled_;
    }
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::size_t filled_ = 0;
};

struct E57File {
  std::string prototype;
  std::string before_points;  ///< XML beside the points: pose, limits
  std::string beside;         ///< XML of the first scan's file, beside the scans
  std::string blob;           ///< of the first scan's file, at byte 48
  std::vector<std::string> streams;
  std::string codecs;  ///< XML
  std::uint64_t records = 0;
  std::size_t per_packet = 1000;  ///< bytes of each stream in a packet

  [[nodiscard]] std::string bytes() const { return bytes_of({*this}); }

  /// The compressed vector that begins at byte `at` of the pages' contents.
  [[nodiscard]] std::string section(std::size_t at) const {
    std::string packets;
    std::size_t longest = 0;
    for (const std::string& s : streams) longest = std::max(longest, s.size());
    for (std::size_t from = 0; from < longest; from += per_packet) {
      std::string body;
      std::string lengths;
      for (const std::string& s : streams) {
        const std::string piece = from < s.size() ? s.substr(from, per_packet) : "";
        put(lengths, static_cast<std::uint16_t>(piece.size()));
        body += piece;
      }
      std::string packet = std::string("\x01\x00", 2);
      std::size_t size = 6 + lengths.size() + body.size();
      const std::size_t padding = (4 - size % 4) % 4;
      size += padding;
      put(packet, static_cast<std::uint16_t>(size - 1));
      put(packet, static_cast<std::uint16_t>(streams.size()));
      packets += packet + lengths + body + std::string(padding, '\0');
    }
    std::string section;
    put(section, std::uint64_t{1});  // section of a compressed vector
    put(section, static_cast<std::uint64_t>(32 + packets.size()));
    put(section, physical(at + 32));  // the packets follow at once
    put(section, std::uint64_t{0});
    return section + packets;
  }
  static std::uint64_t physical(std::size_t logical) { return logical / 1020 * 1024 + logical % 1020; }

  /// A file of several scans.
  static std::string bytes_of(const std::vector<E57File>& scans) {
    std::string logical(48, '\0');
    if (const std::string& blob = scans.front().blob; !blob.empty()) {
      put(logical, std::uint64_t{0});
      put(logical, static_cast<std::uint64_t>(16 + blob.size()));
      logical += blob + std::string((4 - blob.size() % 4) % 4, '\0');
    }
    std::string xml = "<?xml version=\"1.0\"?><e57Root type=\"Structure\"><data3D type=\"Vector\">";
    for (const E57File& scan : scans) {
      xml += "<vectorChild type=\"Structure\">" + scan.before_points +
             "<points type=\"CompressedVector\" fileOffset=\"" + std::to_string(physical(logical.size())) +
             "\" recordCount=\"" + std::to_string(scan.records) + "\"><prototype type=\"Structure\">" + scan.prototype +
             "</prototype><codecs type=\"Vector\">" + scan.codecs + "</codecs></points></vectorChild>";
      logical += scan.section(logical.size());
    }
    xml += "</data3D>" + scans.front().beside + "</e57Root>";
    const std::size_t xml_at = logical.size();
    logical += xml;
    logical.resize((logical.size() + 1019) / 1020 * 1020, ' ');
    std::string head = "ASTM-E57";
    put(head, std::uint32_t{1});
    put(head, std::uint32_t{0});
    put(head, static_cast<std::uint64_t>(logical.size() / 1020 * 1024));
    put(head, physical(xml_at));
    put(head, static_cast<std::uint64_t>(xml.size()));
    put(head, std::uint64_t{1024});
    logical.replace(0, 48, head);
    return with_checksums(logical);
  }

  static std::string with_checksums(const std::string& logical) {
    std::string physical;
    for (std::size_t at = 0; at < logical.size(); at += 1020) {
      const std::string page = logical.substr(at, 1020);
      physical += page;
      put(physical, slow_crc32c(page), true);
    }
    return physical;
  }
};

std::string reals(const std::vector<double>& values, bool single) {
  std::string bytes;
  for (const double v : values) single ? put(bytes, static_cast<float>(v)) : put(bytes, v);
  return bytes;
}

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

/// A picture of 8 x 4 pixels, each with its column and row in red and green.
std::string small_picture() {
  std::vector<std::uint8_t> pixels;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 8; ++column) {
      for (const int value : {30 * column, 60 * row, 7}) pixels.push_back(static_cast<std::uint8_t>(value));
    }
  }
  PngFormat format;
  format.width = 8;
  format.height = 4;
  return encode_png(format, pixels);
}

std::string image_xml(const std::string& form, std::size_t bytes, const std::string& numbers, const char* guid,
                      const char* z) {
  return "<vectorChild type=\"Structure\"><associatedData3DGuid type=\"String\">" + std::string(guid) +
         "</associatedData3DGuid><pose type=\"Structure\"><translation type=\"Structure\"><x "
         "type=\"Float\">10</x><z type=\"Float\">" +
         z + "</z></translation></pose><" + form +
         " type=\"Structure\"><imageWidth type=\"Integer\">8</imageWidth><imageHeight "
         "type=\"Integer\">4</imageHeight>" +
         numbers + "<pngImage type=\"Blob\" fileOffset=\"48\" length=\"" + std::to_string(bytes) + "\"/></" + form +
         "></vectorChild>";
}

/// A scan without colours at (10, 0, 1), whose points lie in these directions from it, two metres away.
E57File grey_station(const std::vector<Eigen::Vector3d>& directions) {
  E57File file;
  for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"})
    file.prototype += "<" + std::string(name) + " type=\"Float\"/>";
  for (Eigen::Index k = 0; k < 3; ++k) {
    std::vector<double> values;
    for (const Eigen::Vector3d& d : directions) values.push_back(2.0 * d[k]);
    file.streams.push_back(reals(values, false));
  }
  file.records = directions.size();
  file.before_points =
      "<guid type=\"String\">{a}</guid><pose type=\"Structure\"><translation type=\"Structure\"><x "
      "type=\"Float\">10</x><z type=\"Float\">1</z></translation></pose>";
  return file;
}

TEST(E57Pictures, PinholeAndSphericalOnesColourPointsThatHaveNone) {
  const ScanFolder folder;
  const std::string picture = small_picture();
  // A pixel is a quarter of the focal length wide and high: the middle of column 6, row 0 is 2.5 pixels right of the
  // axis and 1.5 above.
  const std::vector<Eigen::Vector3d> seen = {
      {2.5 / 4, 1.5 / 4, -1}, {-3.5 / 4, -1.5 / 4, -1}, {5.0 / 4, 0, -1}, {0.1, 0.1, 1}};
  E57File pinhole = grey_station(seen);
  pinhole.blob = picture;
  const std::string numbers =
      "<focalLength type=\"Float\">0.02</focalLength><pixelWidth type=\"Float\">0.005</pixelWidth><pixelHeight "
      "type=\"Float\">0.005</pixelHeight><principalPointX type=\"Float\">4</principalPointX><principalPointY "
      "type=\"Float\">2</principalPointY>";
  const auto with = [&](E57File file, const std::string& image) {
    file.beside = "<images2D type=\"Vector\">" + image + "</images2D>";
    return folder.read("a.e57", file.bytes());
  };
  const RawScan scan = with(pinhole, image_xml("pinholeRepresentation", picture.size(), numbers, "{a}", "1"));
  EXPECT_THAT(scan.rgba, ElementsAre(pack_rgba(180, 0, 7), pack_rgba(0, 180, 7), kNoColour, kNoColour));
  EXPECT_THAT(scan.notes, ::testing::Contains("E57: 1 pictures, of which 1 give points their colour, 1 pinhole"));

  // The whole sphere: a pixel is an eighth of a turn wide. Column 1 has azimuth 5/16 of a turn, to the left.
  const double azimuth = 2.5 * std::numbers::pi / 4, elevation = -0.5 * std::numbers::pi / 4;
  E57File sphere = grey_station(
      {{std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation), std::sin(elevation)}});
  sphere.blob = picture;
  const std::string eighths =
      "<pixelWidth type=\"Float\">0.7853981633974483</pixelWidth><pixelHeight "
      "type=\"Float\">0.7853981633974483</pixelHeight>";
  EXPECT_THAT(with(sphere, image_xml("sphericalRepresentation", picture.size(), eighths, "{a}", "1")).rgba,
              ElementsAre(pack_rgba(30, 120, 7)));
  // Of another scan, and from too far away.
  EXPECT_TRUE(with(sphere, image_xml("sphericalRepresentation", picture.size(), eighths, "{b}", "1")).rgba.empty());
  EXPECT_TRUE(with(sphere, image_xml("sphericalRepresentation", picture.size(), eighths, "{a}", "1.6")).rgba.empty());
}

TEST(E57Pictures, DamageIsAWarningAndThePointsAreRead) {
  const ScanFolder folder;
  const std::string picture = small_picture();
  E57File file = grey_station({{1, 0, 0}});
  file.blob = picture.substr(0, picture.size() / 2);
  const auto read = [&](std::size_t bytes, const char* width) {
    const std::string numbers = "<pixelWidth type=\"Float\">" + std::string(width) +
                                "</pixelWidth><pixelHeight type=\"Float\">0.7</pixelHeight>";
    file.beside =
        "<images2D type=\"Vector\">" + image_xml("sphericalRepresentation", bytes, numbers, "{a}", "1") + "</images2D>";
    return folder.read("a.e57", file.bytes());
  };
  for (const std::size_t bytes : {file.blob.size(), std::size_t{1} << 40U, std::size_t{0}}) {
    const RawScan scan = read(bytes, "0.7");
    EXPECT_EQ(scan.points.size(), 1U);
    EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("picture 1 of the file is not used")));
  }
  EXPECT_THAT(read(file.blob.size(), "0").warnings, ElementsAre(HasSubstr("size of its pixels")));
}

}  // namespace
}  // namespace sparsha::pipeline
