// LAS: versions, point formats, scales, flags, units, and headers that lie.
#include <gmock/gmock.h>

#include "base/threads/progress.h"
#include "pipeline/scan/formats/las/header.h"
#include "tests/support/las_files.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using testing::error_of_bytes;
using testing::expect_refused;
using ::testing::HasSubstr;
using testing::las_point;
using testing::LasFile;
using testing::put;
using testing::ScanFolder;
using testing::set;

std::string geo_keys(const std::vector<std::array<int, 2>>& keys) {
  std::string bytes;
  for (const int v : {1, 1, 0, static_cast<int>(keys.size())}) put(bytes, static_cast<std::uint16_t>(v));
  for (const auto& [key, value] : keys) {
    for (const int v : {key, 0, 1, value}) put(bytes, static_cast<std::uint16_t>(v));
  }
  return bytes;
}

TEST(LasReader, ReadsEveryVersionAndPointFormat) {
  const ScanFolder folder;
  for (int minor = 0; minor <= 4; ++minor) {
    for (int format = 0; format <= 10; ++format) {
      LasFile file;
      file.minor = minor;
      file.format = format;
      file.points = {las_point(format, 1, -2, 300, 7), las_point(format, 2147483647, 0, -2147483647, 65535)};
      const RawScan scan = folder.read("a.las", file.bytes());
      EXPECT_EQ(scan.format, "LAS 1." + std::to_string(minor) + " pf" + std::to_string(format));
      ASSERT_EQ(scan.points.size(), 2U);
      EXPECT_EQ(scan.points[0], Eigen::Vector3d(1 * 0.01 + 100, -2 * 0.01 + 100, 300 * 0.01 + 100));
      EXPECT_EQ(scan.points[1].x(), 2147483647 * 0.01 + 100);
      EXPECT_EQ(scan.intensity, (std::vector<float>{7.0F, 65535.0F}));
      EXPECT_EQ(scan.unit, std::nullopt);
    }
  }
}

TEST(LasReader, ReadsColoursOfSixteenBitsAndOfEight) {
  const ScanFolder folder;
  const std::pair<int, std::size_t> places[] = {{2, 20}, {3, 28}, {5, 28}, {7, 30}, {8, 30}, {10, 30}};
  for (const auto& [format, place] : places) {
    for (const bool words : {false, true}) {
      LasFile file;
      file.minor = 4;
      file.format = format;
      file.points = {las_point(format, 0, 0, 0)};
      const int unit = words ? 257 : 1;
      for (std::size_t k = 0; k < 3; ++k) {
        set(file.points[0], place + 2 * k,
            static_cast<std::uint16_t>(unit * (k == 0 ? 255 : static_cast<int>(10 * k))));
      }
      const RawScan scan = folder.read("c.las", file.bytes());
      EXPECT_EQ(scan.rgba, std::vector<std::uint32_t>{0xFF140AFFU}) << format << (words ? " words" : " bytes");
    }
  }
}

TEST(LasReader, CountsWithheldPointsAsInvalid) {
  const ScanFolder folder;
  for (const int format : {1, 6}) {
    LasFile file;
    file.minor = 4;
    file.format = format;
    file.points = {las_point(format, 0, 0, 0), las_point(format, 1, 1, 1)};
    file.points[1][15] = static_cast<char>(format >= 6 ? 4 : 128);
    const RawScan scan = folder.read("w.las", file.bytes());
    EXPECT_EQ(scan.records, 2U);
    EXPECT_EQ(scan.invalid, 1U);
  }
}

TEST(LasReader, FindsUnitsInGeoKeys) {
  const ScanFolder folder;
  const auto units_of = [&](const std::vector<std::array<int, 2>>& keys) {
    LasFile file;
    file.record_id = 34735;
    file.record = geo_keys(keys);
    file.points = {las_point(0, 0, 0, 0), las_point(0, 100, 0, 100)};
    return folder.read("u.las", file.bytes());
  };
  EXPECT_EQ(units_of({{1024, 1}, {3076, 9001}}).unit, scene::LengthUnit::m);
  EXPECT_EQ(units_of({{1024, 1}, {3076, 9002}}).unit, scene::LengthUnit::ft);
  EXPECT_EQ(units_of({{1024, 1}, {3076, 9003}}).unit, scene::LengthUnit::us_ft);
  EXPECT_EQ(units_of({{1024, 1}, {3072, 32617}}).unit, scene::LengthUnit::m) << "UTM is in metres";
  EXPECT_EQ(units_of({{1024, 1}, {3072, 26918}}).unit, scene::LengthUnit::m) << "so are other systems' zones";
  EXPECT_EQ(units_of({{1024, 1}, {3072, 2056}}).unit, scene::LengthUnit::m) << "and national grids";
  EXPECT_EQ(units_of({{1024, 1}, {3072, 2285}}).unit, std::nullopt);
  const RawScan heights_alone = units_of({{1024, 1}, {3072, 2285}, {4099, 9002}});
  EXPECT_EQ(heights_alone.unit, std::nullopt);
  EXPECT_THAT(heights_alone.warnings, ::testing::ElementsAre(::testing::HasSubstr("units of 0.3048 m")));
  EXPECT_TRUE(units_of({{1024, 2}, {2048, 4326}}).degrees);
  const RawScan mixed = units_of({{1024, 1}, {3076, 9001}, {4099, 9002}});
  EXPECT_EQ(mixed.unit, scene::LengthUnit::m);
  EXPECT_DOUBLE_EQ(mixed.points[1].z(), 101.0 * 0.3048) << "heights in feet become metres";
  EXPECT_EQ(mixed.warnings.size(), 1U);
}

TEST(LasReader, FindsUnitsInWellKnownText) {
  using las::parse_wkt_units;
  const auto us_ft = parse_wkt_units(
      R"(PROJCS["NAD83 / Washington",GEOGCS["NAD83",UNIT["degree",0.0174532925199433]],PARAMETER["x",[1]],)"
      R"(UNIT["US survey foot",0.3048006096012192,AUTHORITY["EPSG","9003"]],AXIS["X",EAST]])");
  EXPECT_FALSE(us_ft.geographic);
  EXPECT_DOUBLE_EQ(us_ft.horizontal_m, 0.3048006096012192);
  const auto compound = parse_wkt_units(
      R"(COMPD_CS["a + b",PROJCS["a",GEOGCS["g",UNIT["degree",0.017]],UNIT["metre",1]],VERT_CS["b",UNIT["foot",0.3048]]])");
  EXPECT_EQ(compound.horizontal_m, 1.0);
  EXPECT_EQ(compound.vertical_m, 0.3048);
  for (const char* text :
       {R"(PROJCS["a",GEOGCS["g",UNIT["Degree",0.017]],UNIT["Meter",1.0]],VERTCS["b",VDATUM["c"],UNIT["Foot_US",0.3]])",
        R"(COMPD_CS["ab",PROJCS["a",UNIT["Meter",1.0]],VERTCS["b",UNIT["Foot_US",0.3]]])"}) {
    const auto esri = parse_wkt_units(text);
    EXPECT_EQ(esri.horizontal_m, 1.0) << text;
    EXPECT_EQ(esri.vertical_m, 0.3) << text;
  }
  EXPECT_TRUE(parse_wkt_units(R"(GEOGCS["WGS 84",UNIT["degree",0.0174532925199433]])").geographic);
  EXPECT_TRUE(parse_wkt_units(R"(GEOGCRS["WGS 84",CS[ellipsoidal,2]])").geographic);
  EXPECT_EQ(
      parse_wkt_units(R"wkt(PROJCRS["a",BASEGEOGCRS["g"],CS[Cartesian,2],AXIS["(E)",east,LENGTHUNIT["metre",1]]])wkt")
          .horizontal_m,
      1.0);
  for (const std::string text : {"", "PROJCS", "PROJCS[", "[[[[", "PROJCS[\"a", "UNIT[,,]", "PROJCS[]]]]", ")("}) {
    EXPECT_EQ(parse_wkt_units(text).horizontal_m, 0.0) << text;
  }
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "A[";
  EXPECT_EQ(parse_wkt_units(deep).horizontal_m, 0.0);

  const ScanFolder folder;
  LasFile file;
  file.record_id = 2112;
  file.record = R"(PROJCS["p",UNIT["foot",0.3048]])";
  file.points = {las_point(0, 0, 0, 0)};
  EXPECT_EQ(folder.read("w.las", file.bytes()).unit, scene::LengthUnit::ft);
}

TEST(LasReader, LoadsFeetAsMetresAndRefusesDegrees) {
  const ScanFolder folder;
  LasFile file;
  file.offset = 0.0;
  file.record_id = 34735;
  file.record = geo_keys({{1024, 1}, {3076, 9003}});
  file.points = {las_point(0, 0, 0, 0), las_point(0, 1000, 0, 0)};
  scene::ScanConfig config;
  config.file = folder.write("feet.las", file.bytes());
  Progress progress;
  const Cloud cloud = load_scan(config, progress);
  EXPECT_NEAR(static_cast<double>(cloud.xyz1()[4] - cloud.xyz1()[0]), 12000.0 / 3937.0, 1e-6);
  file.record = geo_keys({{1024, 2}});
  config.file = folder.write("degrees.las", file.bytes());
  EXPECT_THROW((void)load_scan(config, progress), Error);
  EXPECT_EQ(inspect_scan(config.file).units, "degrees");
}

TEST(LasReader, RefusesLies) {
  const ScanFolder folder;
  LasFile good;
  good.points = {las_point(0, 1, 2, 3), las_point(0, 4, 5, 6)};
  const auto refuse = [](const std::string& bytes, const char* message) { expect_refused("lie.las", bytes, message); };
  std::string bytes = good.bytes();
  set(bytes, 107, std::uint32_t{4000000000U});
  refuse(bytes, "promises 4000000000 points, only 2");
  bytes = good.bytes();
  set(bytes, 96, std::uint32_t{4000000000U});
  refuse(bytes, "begin at byte 4000000000");
  bytes = good.bytes();
  set(bytes, 94, std::uint16_t{12});
  refuse(bytes, "header of 12 bytes");
  bytes = good.bytes();
  bytes[104] = 11;
  refuse(bytes, "point format 11");
  bytes = good.bytes();
  set(bytes, 105, std::uint16_t{19});
  refuse(bytes, "in 19 bytes");
  bytes = good.bytes();
  set(bytes, 131, 0.0);
  refuse(bytes, "scale");
  bytes = good.bytes();
  set(bytes, 155, std::numeric_limits<double>::quiet_NaN());
  refuse(bytes, "scale");
  bytes = good.bytes();
  bytes[25] = 9;
  refuse(bytes, "version 1.9");
  bytes = good.bytes();
  bytes[104] = static_cast<char>(128);
  refuse(bytes, "without a LASzip record");
  refuse(good.bytes().substr(0, 100), "breaks off");
}

TEST(LasReader, TakesAWrongNumberOfRecordsForWhatItIsWorth) {
  const ScanFolder folder;
  LasFile file;
  file.points = {las_point(0, 1, 2, 3)};
  std::string bytes = file.bytes();
  set(bytes, 100, std::uint32_t{1069128089});
  const RawScan scan = folder.read("v.las", bytes);
  EXPECT_EQ(scan.records, 1U);
  EXPECT_THAT(scan.warnings, ::testing::ElementsAre(HasSubstr("1069128089")));
}

TEST(LasReader, RefusesATruncationAtEveryByte) {
  const ScanFolder folder;
  LasFile file;
  file.minor = 4;
  file.format = 6;
  file.points = {las_point(6, 1, 2, 3), las_point(6, 4, 5, 6)};
  const std::string bytes = file.bytes();
  ASSERT_FALSE(error_of_bytes("whole.las", bytes));
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    EXPECT_TRUE(error_of_bytes("cut.las", std::string_view(bytes).substr(0, n))) << n;
  }
}

/// A box of 10 units a side, as the header should have it.
LasFile boxed(int minor, int count) {
  LasFile file;
  file.minor = minor;
  for (int i = 0; i < count; ++i) {
    file.points.push_back(las_point(0, i % 32 * 32 + 10, i / 32 % 32 * 32 + 10, i % 7 * 10 + 10));
  }
  return file;
}

std::string with_box(const LasFile& file, double low, double high) {
  std::string bytes = file.bytes();
  for (std::size_t k = 0; k < 3; ++k) {
    testing::set(bytes, 179 + 16 * k, high);
    testing::set(bytes, 187 + 16 * k, low);
  }
  return bytes;
}

TEST(LasReader, WarnsOfMorePointsThanItsHeaderPromisesInEveryVersion) {
  const testing::ScanFolder folder;
  for (int minor = 0; minor <= 4; ++minor) {
    std::string bytes = boxed(minor, 100).bytes();
    EXPECT_THAT(folder.read("a.las", bytes).warnings, ::testing::IsEmpty());
    testing::set(bytes, 107, std::uint32_t{60});
    if (minor == 4) testing::set(bytes, 247, std::uint64_t{60});
    EXPECT_THAT(folder.read("a.las", bytes).warnings,
                ::testing::ElementsAre(::testing::HasSubstr("room for 100 points, its header promises 60")));
  }
  // What the header says follows the points is no missing point.
  std::string waves = boxed(3, 60).bytes();
  testing::set(waves, 227, static_cast<std::uint64_t>(waves.size()));
  EXPECT_THAT(folder.read("a.las", waves + std::string(5000, 'w')).warnings, ::testing::IsEmpty());
}

TEST(LasReader, WarnsOfPointsFarOutsideTheHeadersBoxAndRefusesAnAbsurdSpread) {
  const testing::ScanFolder folder;
  LasFile file = boxed(2, 1000);
  EXPECT_THAT(folder.read("a.las", with_box(file, 100.0, 111.0)).warnings, ::testing::IsEmpty());
  EXPECT_THAT(folder.read("a.las", with_box(file, 0.0, 0.0)).warnings, ::testing::IsEmpty()) << "no box";
  // A cloud that was moved without its box keeps its size: usable.
  EXPECT_THAT(folder.read("a.las", with_box(file, 5100.0, 5111.0)).warnings,
              ::testing::ElementsAre(::testing::HasSubstr("1000 of 1000 points lie far outside")));
  // One point in a thousand: an outlier.
  file.points[500] = las_point(0, 2000000000, 5, 5);
  EXPECT_THAT(folder.read("a.las", with_box(file, 100.0, 111.0)).warnings,
              ::testing::ElementsAre(::testing::HasSubstr("1 of 1000 points lie far outside")));
  for (std::size_t i = 0; i < 40; ++i) file.points[i] = las_point(0, 2000000000, 5, 5);
  testing::expect_refused("a.las", with_box(file, 100.0, 111.0), "far outside the header's box");
}

TEST(LasReader, SaysThatItsHeadersBoxIsZeroOrExchanged) {
  const testing::ScanFolder folder;
  const LasFile file = boxed(2, 100);
  EXPECT_THAT(folder.read("a.las", with_box(file, 100.0, 111.0)).notes, ::testing::IsEmpty());
  EXPECT_THAT(folder.read("a.las", with_box(file, 0.0, 0.0)).notes, ::testing::ElementsAre(HasSubstr("not filled in")));
  EXPECT_THAT(folder.read("a.las", with_box(file, 111.0, 100.0)).warnings,
              ::testing::ElementsAre(::testing::AllOf(HasSubstr("least x (111)"), HasSubstr("largest (100)"))));
}

TEST(LasReader, RefusesAFileWhoseLineFeedsWereTranslated) {
  LasFile file = boxed(2, 2000);  // their bytes hold line feeds
  const std::string bytes = file.bytes();
  std::string copied;
  for (const char c : bytes) {
    if (c == '\n') copied += '\r';
    copied += c;
  }
  ASSERT_GT(copied.size(), bytes.size() + 20);
  testing::expect_refused("a.las", copied, "copied as text");
}

TEST(LasReader, NotesNameRulesOfLas14ThatAreBroken) {
  LasFile file;
  file.minor = 4;
  file.format = 6;
  file.points = {las_point(6, 1, 2, 3)};
  std::string bytes = with_box(file, 100.0, 111.0);
  EXPECT_THAT(read_scan_bytes(bytes, "a.las").notes, ::testing::ElementsAre(HasSubstr("reference as WKT")));
  bytes[6] = 16;
  EXPECT_THAT(read_scan_bytes(bytes, "a.las").notes, ::testing::IsEmpty());
  set(bytes, 107, std::uint32_t{1});
  EXPECT_THAT(read_scan_bytes(bytes, "a.las").notes,
              ::testing::ElementsAre(HasSubstr("in the old place of the header, it has 1")));
  file.format = 3;
  file.points = {las_point(3, 1, 2, 3)};
  EXPECT_THAT(read_scan_bytes(with_box(file, 100.0, 111.0), "a.las").notes, ::testing::IsEmpty());
}

TEST(LasReader, NotesNameSoftwareSystemAndReference) {
  const ScanFolder folder;
  LasFile file;
  file.points = {las_point(0, 1, 2, 3)};
  EXPECT_THAT(folder.read("a.las", with_box(file, 100.0, 111.0)).notes, ::testing::IsEmpty());
  file.record_id = 2112;
  file.record = "COMPD_CS[\"ETRS89 / UTM 32N + \x1BHeight\",PROJCS[\"other\"]]";
  std::string bytes = with_box(file, 100.0, 111.0);
  bytes.replace(26, 5, "  Sys");
  bytes.replace(58, 32, "Program with a name of 32 letter");
  EXPECT_THAT(folder.read("b.las", bytes).notes,
              ::testing::ElementsAre("LAS: written by Program with a name of 32 letter", "LAS: system Sys",
                                     "LAS: coordinates of ETRS89 / UTM 32N + ?Height"));
  file.record_id = 34737;
  file.record = "NAD83 / zone 10|NAVD88|";
  EXPECT_THAT(folder.read("c.las", with_box(file, 100.0, 111.0)).notes,
              ::testing::ElementsAre("LAS: coordinates of NAD83 / zone 10"));
}

TEST(Las, NearInfraredIsAFieldAndWhatIsNotReadIsSaid) {
  LasFile file;
  file.minor = 4;
  for (const int format : {8, 10}) {
    file.format = format;
    file.points.clear();
    for (const int infrared : {7, 500, 65535}) {
      std::string point = las_point(format, 1, 2, 3);
      set(point, 36, static_cast<std::uint16_t>(infrared));
      file.points.push_back(point);
    }
    ReadOptions options;
    options.fields = {"infrared"};
    const RawScan scan = read_scan_bytes(file.bytes(), "a.las", options);
    EXPECT_THAT(scan.values.at(0), ::testing::ElementsAre(7.0F, 500.0F, 65535.0F)) << format;
    EXPECT_EQ(std::ranges::count(scan.notes, "LAS: wave packets, which are not read"), format == 10 ? 1 : 0);
  }
  file = {};
  file.points = {las_point(0, 1, 2, 3) + "abc"};
  std::string bytes = with_box(file, 100.0, 111.0);
  set(bytes, 105, std::uint16_t{23});
  EXPECT_THAT(read_scan_bytes(bytes, "a.las").notes,
              ::testing::ElementsAre("LAS: 3 bytes behind each point, which the file does not describe, are not read"));
}

}  // namespace
}  // namespace sparsha::pipeline
