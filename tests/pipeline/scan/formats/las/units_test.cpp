// Units of LAS files that are said in several places: codes of EPSG, WKT beside GeoTIFF keys, records of other users.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/scan/units.h"
#include "tests/support/las_files.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline::testing {
namespace {

using scene::LengthUnit;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kFoot = 0.3048, kUsFoot = 12.0 / 39.37;

std::string geo_keys(const std::vector<std::array<int, 2>>& keys) {
  std::string bytes(8 * (keys.size() + 1), '\0');
  const auto put = [&](std::size_t k, std::array<int, 4> values) {
    for (std::size_t i = 0; i < 4; ++i) set(bytes, 8 * k + 2 * i, static_cast<std::uint16_t>(values[i]));
  };
  put(0, {1, 1, 0, static_cast<int>(keys.size())});
  for (std::size_t k = 0; k < keys.size(); ++k) put(k + 1, {keys[k][0], 0, 1, keys[k][1]});
  return bytes;
}

RawScan read(const std::vector<LasRecord>& records, std::uint16_t encoding = 0) {
  LasFile file;
  file.minor = 4;
  file.offset = 0.0;
  file.encoding = encoding;
  file.more_records = records;
  file.points = {las_point(0, 0, 0, 0), las_point(0, 100, 100, 100)};  // from 0 0 0 to 1 1 1 in its units
  return read_scan_bytes(file.bytes(), "u.las");
}

RawScan read_keys(const std::vector<std::array<int, 2>>& keys) { return read({{34735, geo_keys(keys)}}); }

/// Length of one of the file's own units of height.
double metre_of_height(const RawScan& scan) { return scan.points[1].z() * scene::metres_in(scan.unit.value()); }

const std::string kWktFeet = R"(PROJCS["p",GEOGCS["g",UNIT["degree",0.0174]],UNIT["foot",0.3048]])";
const std::string kWktMetres = R"(PROJCS["p",GEOGCS["g",UNIT["degree",0.0174]],UNIT["metre",1]])";

TEST(LasUnits, CodesOfHeightsTellTheirUnit) {
  for (const auto& [code, metres] : std::vector<std::pair<int, double>>{{5703, 1.0},
                                                                        {5773, 1.0},
                                                                        {7979, 1.0},
                                                                        {8228, kFoot},
                                                                        {6131, kFoot},
                                                                        {6360, kUsFoot},
                                                                        {5702, kUsFoot},
                                                                        {8052, kUsFoot}}) {
    for (const auto& [unit, horizontal] : std::vector<std::pair<int, double>>{{9001, 1.0}, {9002, kFoot}}) {
      const RawScan scan = read_keys({{1024, 1}, {3072, 26915}, {3076, unit}, {4096, code}});
      EXPECT_NEAR(metre_of_height(scan), metres, 1e-9) << code << " beside " << unit;
      EXPECT_NEAR(scan.points[1].x() * scene::metres_in(scan.unit.value()), horizontal, 1e-12);
      EXPECT_EQ(scan.warnings.size(), metres == horizontal ? 0U : 1U) << "another unit is said";
    }
  }
}

TEST(LasUnits, TheUnitOfHeightsThatIsNamedWinsOverTheirCode) {
  const RawScan scan = read_keys({{3076, 9001}, {4096, 6360}, {4099, 9001}});
  EXPECT_EQ(metre_of_height(scan), 1.0);
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("EPSG 6360 has units of 0.30480061 m")));
}

TEST(LasUnits, HeightsOfAnUnknownCodeAreDoubtedBesideFeet) {
  EXPECT_THAT(read_keys({{3076, 9003}, {4096, 5103}}).warnings, ElementsAre(HasSubstr("those of EPSG 5103")));
  EXPECT_THAT(read_keys({{3076, 9001}, {4096, 5103}}).warnings, IsEmpty());
  EXPECT_THAT(read_keys({{3072, 2285}, {4096, 5703}}).warnings, ElementsAre(HasSubstr("no unit of x and y is")));
}

TEST(LasUnits, ZonesOfTheBlmAreInFeetAndThoseOfUtmInMetres) {
  for (const int code : {32664, 32665, 32667, 32064, 32067, 32074, 32164, 32167, 4399, 4413, 4418, 4433, 4439}) {
    EXPECT_EQ(read_keys({{1024, 1}, {3072, code}}).unit, LengthUnit::us_ft) << code;
  }
  for (const int code : {32601, 32660, 32663, 32701, 32760}) {
    EXPECT_EQ(read_keys({{1024, 1}, {3072, code}}).unit, LengthUnit::m) << code;
  }
  for (const int code : {32668, 4414, 4417, 4434}) {
    EXPECT_EQ(read_keys({{1024, 1}, {3072, code}}).unit, std::nullopt) << code;
  }
}

TEST(LasUnits, CodesOfProjectionsWithHeightsTellBoth) {
  EXPECT_EQ(read_keys({{1024, 1}, {3072, 8741}}).unit, LengthUnit::us_ft);
  EXPECT_EQ(read_keys({{1024, 1}, {3072, 8702}}).unit, LengthUnit::ft);
  EXPECT_EQ(read_keys({{1024, 1}, {3072, 5555}}).unit, LengthUnit::m);
}

TEST(LasUnits, RecordsOfOtherUsersTellNothing) {
  const LasRecord metres{34735, geo_keys({{3076, 9001}})};
  EXPECT_EQ(read({{2112, kWktFeet, "somebody else"}, metres}).unit, LengthUnit::m);
  EXPECT_EQ(read({{2112, kWktFeet, "somebody else"}}).unit, std::nullopt);
  EXPECT_EQ(read({{2112, kWktFeet, "liblas"}}).unit, LengthUnit::ft);
  EXPECT_EQ(read({{34735, geo_keys({{3076, 9002}}), "somebody else"}, metres}).unit, LengthUnit::m);
  // Key 3077 has its number in the record of numbers: here 0.3048, and 1 in that of another user.
  std::string own = geo_keys({{3076, 32767}, {3077, 0}});
  set(own, 8 * 2 + 2, std::uint16_t{34736});
  std::string foot(8, '\0'), metre(8, '\0');
  set(foot, 0, 0.3048);
  set(metre, 0, 1.0);
  EXPECT_EQ(read({{34735, own}, {34736, foot}, {34736, metre, "somebody else"}}).unit, LengthUnit::ft);
}

TEST(LasUnits, TheHeaderDecidesBetweenWktAndKeys) {
  constexpr std::uint16_t kIsWkt = 16;
  const LasRecord wkt{2112, kWktFeet}, keys{34735, geo_keys({{3076, 9001}})};
  const RawScan by_keys = read({wkt, keys});
  EXPECT_EQ(by_keys.unit, LengthUnit::m);
  EXPECT_THAT(by_keys.warnings, ElementsAre(HasSubstr("the keys hold, so units of 1 m are taken")));
  const RawScan by_wkt = read({keys, wkt}, kIsWkt);
  EXPECT_EQ(by_wkt.unit, LengthUnit::ft);
  EXPECT_THAT(by_wkt.warnings, ElementsAre(HasSubstr("WKT holds, so units of 0.3048 m are taken")));

  for (const std::uint16_t encoding : {std::uint16_t{0}, kIsWkt}) {
    const RawScan same = read({{2112, kWktMetres}, keys}, encoding);
    EXPECT_EQ(same.unit, LengthUnit::m);
    EXPECT_THAT(same.warnings, IsEmpty());
    EXPECT_EQ(read({wkt}, encoding).unit, LengthUnit::ft) << "WKT alone";
    EXPECT_EQ(read({keys}, encoding).unit, LengthUnit::m) << "keys alone";
    EXPECT_EQ(read({wkt, {34735, geo_keys({{1024, 1}})}}, encoding).unit, LengthUnit::ft) << "keys without a unit";
    EXPECT_EQ(read({{2112, "PROJCS[\"p\"]"}, keys}, encoding).unit, LengthUnit::m) << "WKT without a unit";
  }
}

TEST(LasUnits, TheReferenceThatInfoNamesIsTheOneThatHolds) {
  const LasRecord wkt{2112, kWktMetres}, text{34737, "NAD83 / zone 10|"};
  EXPECT_THAT(read({wkt, text}).notes, Contains("LAS: coordinates of NAD83 / zone 10"));
  EXPECT_THAT(read({text, wkt}, 16).notes, Contains("LAS: coordinates of p"));
  EXPECT_THAT(read({wkt}).notes, Contains("LAS: coordinates of p"));
}

TEST(LasUnits, HeightsOfWktThatDifferFromThoseOfKeysAreSaid) {
  const LasRecord wkt{2112, "COMPD_CS[\"c\"," + kWktMetres + R"(,VERT_CS["v",UNIT["foot",0.3048]]])"};
  const RawScan scan = read({wkt, {34735, geo_keys({{3076, 9001}})}});
  EXPECT_EQ(metre_of_height(scan), 1.0);
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("heights of 0.3048 m, its GeoTIFF keys units of 1 m")));
}

// z of the second point is 1 in the file.
TEST(LasUnits, DepthsAreTurnedUpwardsWithAWord) {
  const auto compound = [](const std::string& vertical) {
    return LasRecord{2112, "COMPD_CS[\"c\"," + kWktMetres + "," + vertical + "]"};
  };
  for (const char* const depth :
       {R"(VERT_CS["v",VERT_DATUM["d",2005],UNIT["metre",1],AXIS["Depth",DOWN]])",
        R"(VERTCS["v",VDATUM["d"],PARAMETER["Vertical_Shift",0.0],PARAMETER["Direction",-1.0],UNIT["Meter",1.0]])",
        R"(VERTCRS["v",VDATUM["d"],CS[vertical,1],AXIS["depth",down,LENGTHUNIT["metre",1]]])"}) {
    const RawScan scan = read({compound(depth)});
    EXPECT_EQ(scan.points[1].z(), -1.0) << depth;
    EXPECT_EQ(scan.points[1].x(), 1.0);
    EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("z is a depth"))) << depth;
  }
  for (const char* const height :
       {R"(VERT_CS["v",UNIT["metre",1],AXIS["Up",UP]])",
        R"(VERTCS["v",PARAMETER["Vertical_Shift",0.0],PARAMETER["Direction",1.0],UNIT["Meter",1.0]])"}) {
    const RawScan scan = read({compound(height)});
    EXPECT_EQ(scan.points[1].z(), 1.0) << height;
    EXPECT_THAT(scan.warnings, IsEmpty()) << height;
  }
  EXPECT_EQ(read_keys({{3076, 9001}, {4096, 5715}}).points[1].z(), -1.0);
  EXPECT_EQ(read_keys({{3076, 9001}, {4096, 5714}}).points[1].z(), 1.0);
  const RawScan feet = read_keys({{3076, 9001}, {4096, 8053}});
  EXPECT_NEAR(feet.points[1].z(), -kUsFoot, 1e-9);
  EXPECT_EQ(feet.warnings.size(), 2U) << "another unit, and depths";
}

TEST(LasUnits, DepthsOfWhichNoneIsAboveZeroAreTakenForHeights) {
  LasFile file;
  file.minor = 4;
  file.offset = 0.0;
  file.more_records = {{34735, geo_keys({{3076, 9001}, {4096, 5715}})}};
  file.points = {las_point(0, 0, 0, 0), las_point(0, 100, 100, -100)};
  std::string bytes = file.bytes();
  set(bytes, 211, 0.0);
  set(bytes, 219, -1.0);
  const RawScan scan = read_scan_bytes(bytes, "u.las");
  EXPECT_EQ(scan.points[1].z(), -1.0);
  EXPECT_THAT(scan.warnings, ::testing::Contains(HasSubstr("none is above zero")));
}

}  // namespace
}  // namespace sparsha::pipeline::testing
