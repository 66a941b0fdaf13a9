// E57: limits of colours of every type and channel, prefixes of extensions, and scans with two kinds of coordinates.
#include <array>
#include <cmath>

#include "tests/pipeline/scan/formats/e57/e57_file.h"

namespace sparsha::pipeline::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kCartesian =
    "<cartesianX type=\"Float\"/><cartesianY type=\"Float\"/><cartesianZ type=\"Float\"/>";
constexpr std::array<const char*, 3> kChannels = {"Red", "Green", "Blue"};

std::string integers(const std::vector<std::uint64_t>& values, int bits) {
  Bits stream;
  for (const std::uint64_t value : values) stream.add(value, bits);
  return stream.bytes();
}

/// Points whose channels are integers from 0 to `most`, scaled or not.
struct Coloured {
  std::uint64_t most = 65535;
  int bits = 16;
  std::string type = "Integer";
  std::string attributes;       ///< of the type and of the limits
  std::array<int, 3> limits{};  ///< of red, green and blue; 0: the file has none
  std::array<std::vector<std::uint64_t>, 3> values;

  [[nodiscard]] RawScan read() const {
    E57File file;
    file.records = values[0].size();
    file.prototype = kCartesian;
    file.streams.assign(3, reals(std::vector<double>(values[0].size(), 0.0), false));
    std::string stated;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string name = std::string("color") + kChannels[k];
      const std::string with = " type=\"" + type + "\" " + attributes;
      file.prototype += "<" + name + with + " minimum=\"0\" maximum=\"" + std::to_string(most) + "\"/>";
      file.streams.push_back(integers(values[k], bits));
      stated += "<" + name + "Minimum" + with + ">0</" + name + "Minimum>";
      stated += "<" + name + "Maximum" + with + ">" + std::to_string(limits[k]) + "</" + name + "Maximum>";
    }
    if (limits[0] != 0) file.before_points = "<colorLimits type=\"Structure\">" + stated + "</colorLimits>";
    return read_scan_bytes(file.bytes(), "c.e57");
  }
};

TEST(E57Types, LimitsOfScaledIntegersAreScaledAsTheirFieldsAre) {
  for (const std::string attributes : {"scale=\"0.125\"", "scale=\"0.125\" offset=\"10\""}) {
    Coloured file{1020, 10, "ScaledInteger", attributes, {1020, 1020, 1020}, {}};
    file.values = {{{0, 1020}, {510, 1020}, {4, 0}}};
    const RawScan scan = file.read();
    EXPECT_THAT(scan.rgba, ElementsAre(0xFF018000U, 0xFF00FFFFU)) << attributes;
    EXPECT_THAT(scan.warnings, IsEmpty());
  }
}

TEST(E57Types, EachChannelHasItsOwnLimits) {
  Coloured file{1020, 10, "Integer", "", {1020, 255, 510}, {}};
  file.values = {{{1020, 4}, {255, 1}, {510, 2}}};
  const RawScan scan = file.read();
  EXPECT_THAT(scan.rgba, ElementsAre(0xFFFFFFFFU, 0xFF010101U));
  EXPECT_THAT(scan.warnings, IsEmpty());
}

TEST(E57Types, AChannelBeyondItsOwnLimitIsSaid) {
  Coloured file{1023, 10, "Integer", "", {1023, 255, 1023}, {}};
  file.values = {{{1023, 0}, {1023, 0}, {1023, 0}}};
  const RawScan scan = file.read();
  EXPECT_THAT(scan.rgba, ElementsAre(0xFFFFFFFFU, 0xFF000000U));
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("up to 1023, beyond their limit of 255")));
}

TEST(E57Types, BytesInFieldsOf16BitsAreBytes) {
  Coloured file;
  file.values = {{{255, 0}, {10, 0}, {128, 0}}};
  RawScan scan = file.read();
  EXPECT_THAT(scan.rgba, ElementsAre(0xFF800AFFU, 0xFF000000U));
  EXPECT_THAT(scan.warnings, IsEmpty());
  file.limits = {65535, 65535, 65535};
  scan = file.read();
  EXPECT_THAT(scan.rgba, ElementsAre(0xFF800AFFU, 0xFF000000U));
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("up to 255, far below their limit of 65535")));
  file.values = {{{255, 65535}, {10, 0}, {128, 0}}};
  EXPECT_THAT(file.read().rgba, ElementsAre(0xFF000001U, 0xFF0000FFU)) << "one value of 16 bits tells";
  file.limits = {};
  EXPECT_THAT(file.read().rgba, ElementsAre(0xFF000001U, 0xFF0000FFU));
}

TEST(E57Types, ColoursOfFieldsWithoutALimitAreBytesOrWords) {
  Coloured file;
  file.most = 9223372036854775807U;
  file.bits = 63;
  file.values = {{{255, 0}, {10, 0}, {128, 0}}};
  EXPECT_THAT(file.read().rgba, ElementsAre(0xFF800AFFU, 0xFF000000U));
  file.values = {{{65535, 0}, {2570, 0}, {32896, 0}}};
  EXPECT_THAT(file.read().rgba, ElementsAre(0xFF800AFFU, 0xFF000000U));
}

TEST(E57Types, NormalsAreKnownByTheirNamespaceAndNotByItsPrefix) {
  for (const std::string prefix : {"nor", "sn"}) {
    E57File file;
    file.records = 1;
    file.prototype = kCartesian;
    file.streams.assign(3, reals({0}, false));
    file.declarations = " xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\" xmlns:" + prefix +
                        "=\"http://www.libe57.org/E57_NOR_surface_normals.txt\"";
    for (const auto& [axis, value] : {std::pair("X", 0.6), std::pair("Y", 0.0), std::pair("Z", 0.8)}) {
      file.prototype += "<" + prefix + ":normal" + axis + " type=\"Float\"/>";
      file.streams.push_back(reals({value}, false));
    }
    const RawScan scan = read_scan_bytes(file.bytes(), "n.e57");
    ASSERT_EQ(scan.normals.size(), 1U) << prefix;
    EXPECT_NEAR(static_cast<double>(scan.normals[0].x()), 0.6, 1e-6);
    EXPECT_NEAR(static_cast<double>(scan.normals[0].z()), 0.8, 1e-6);
  }
}

TEST(E57Types, PointsWithoutValidCartesianCoordinatesHaveTheirSphericalOnes) {
  E57File file;
  file.records = 4;
  file.prototype =
      std::string(kCartesian) + "<cartesianInvalidState type=\"Integer\" minimum=\"0\" maximum=\"2\"/>" +
      "<sphericalRange type=\"Float\"/><sphericalAzimuth type=\"Float\"/><sphericalElevation type=\"Float\"/>";
  const std::string spherical_state = "<sphericalInvalidState type=\"Integer\" minimum=\"0\" maximum=\"2\"/>";
  file.streams = {reals({7, 0, 0, 5}, false),       reals({8, 0, 0, 5}, false), reals({9, 0, 0, 5}, false),
                  integers({0, 2, 2, 0}, 2),        reals({1, 2, 3, 4}, false), reals({0, M_PI / 2, 0, 0}, false),
                  reals({0, M_PI / 6, 0, 0}, false)};
  RawScan scan = read_scan_bytes(file.bytes(), "a.e57");
  EXPECT_EQ(scan.points.size(), 2U) << "nothing says that spherical coordinates are valid";
  EXPECT_EQ(scan.invalid, 2U);
  file.prototype += spherical_state;
  file.streams.push_back(integers({0, 0, 1, 2}, 2));
  scan = read_scan_bytes(file.bytes(), "b.e57");
  EXPECT_EQ(scan.invalid, 1U);
  ASSERT_EQ(scan.points.size(), 3U);
  EXPECT_EQ(scan.points[0], Eigen::Vector3d(7, 8, 9));
  EXPECT_LT((scan.points[1] - Eigen::Vector3d(0, std::sqrt(3.0), 1)).norm(), 1e-15 * 4);
  EXPECT_EQ(scan.points[2], Eigen::Vector3d(5, 5, 5));
}

}  // namespace
}  // namespace sparsha::pipeline::testing
