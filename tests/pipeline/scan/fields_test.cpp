// What scans say of their points beside places and colours: read when it is asked for, counted, and judged.
#include "pipeline/scan/fields.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "base/threads/progress.h"
#include "pipeline/scan/set.h"
#include "pipeline/scan/statistics.h"
#include "pipeline/scan/worth.h"
#include "tests/support/las_files.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::las_point;
using testing::LasFile;
using testing::put;
using testing::ScanFolder;
using testing::set;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

ReadOptions asking(std::vector<std::string> fields) {
  ReadOptions options;
  options.fields = std::move(fields);
  return options;
}

/// The values of one field of a file; those of points without one are -99.
std::vector<float> values_of(const std::string& bytes, const std::string& name, const std::string& field) {
  RawScan scan = read_scan_bytes(bytes, name, asking({field}));
  EXPECT_EQ(scan.values.size(), 1U);
  for (float& value : scan.values[0]) {
    if (std::isnan(value)) value = -99.0F;
  }
  EXPECT_TRUE(scan.values[0].empty() || scan.values[0].size() == scan.points.size());
  return scan.values[0];
}

FieldTally tally_of(const std::string& name, const std::vector<float>& values) {
  FieldTally tally(name);
  tally.add(values);
  return tally;
}

TEST(FieldKey, IsTheNameThatPeopleMean) {
  EXPECT_EQ(field_key(" Scalar_Confidence\t"), "confidence");
  EXPECT_EQ(field_key("Class"), "classification");
  EXPECT_EQ(field_key("scalar_"), "scalar_");
  EXPECT_EQ(field_key("  "), "");
}

TEST(FieldTally, CountsAsAllValuesSortedDo) {
  std::mt19937 random(7);
  std::normal_distribution<float> normal(0.3F, 2.0F);
  std::vector<float> values(20001);
  for (float& value : values) value = normal(random);
  const FieldTally tally = tally_of("a", values);
  std::sort(values.begin(), values.end());
  EXPECT_EQ(tally.least(), values.front());
  EXPECT_EQ(tally.most(), values.back());
  EXPECT_FALSE(tally.is_whole());
  for (const float border : {0.0F, 0.5F, 1.0F, 3.0F}) {
    const auto below = std::lower_bound(values.begin(), values.end(), border) - values.begin();
    EXPECT_EQ(tally.below(border), static_cast<std::uint64_t>(below)) << border;
  }
  for (const double rank : {0.0, 0.1, 0.5, 0.9, 1.0}) {
    const float exact = values[static_cast<std::size_t>(rank * 20000.0)];
    EXPECT_NEAR(tally.quantile(rank), exact, 0.01 * std::abs(exact) + 1e-6) << rank;
  }
}

TEST(FieldTally, CountsPointsWithoutAValueApart) {
  const FieldTally tally = tally_of("a", {3.0F, kNaN, 0.0F, 3.0F, -0.0F, 255.0F});
  EXPECT_EQ(tally.values(), 5U);
  EXPECT_EQ(tally.missing(), 1U);
  EXPECT_TRUE(tally.is_whole());
  EXPECT_EQ(tally.count(0), 2U);
  EXPECT_EQ(tally.count(3), 2U);
  EXPECT_EQ(tally.count(255), 1U);
  EXPECT_EQ(few_values(tally).size(), 3U);
  EXPECT_TRUE(few_values(tally_of("a", {0.5F})).empty());
  EXPECT_TRUE(tally_of("a", {}).is_constant());
}

std::string ply_header(const std::string& format, const std::string& properties, int count) {
  return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(count) + "\n" + properties + "end_header\n";
}

TEST(FieldsOfPly, AreReadInEveryEncodingBehindListsAndUnderTheirNames) {
  const std::string ascii = ply_header("ascii",
                                       "property float x\nproperty list uchar int tags\nproperty float y\nproperty "
                                       "float z\nproperty double scalar_Confidence\n",
                                       3) +
                            "1 0 2 3 0.25\n1 2 7 8 nan 3 4\n1 1 9 2 3 nan\n";
  EXPECT_THAT(values_of(ascii, "a.ply", "confidence"), ElementsAre(0.25F, -99.0F));
  for (const bool big : {false, true}) {
    for (const bool list : {false, true}) {
      std::string bytes =
          ply_header(big ? "binary_big_endian" : "binary_little_endian",
                     std::string("property double x\n") + (list ? "property list uchar short tags\n" : "") +
                         "property double y\nproperty double z\nproperty double Confidence\nproperty ushort quality\n",
                     3);
      for (int i = 0; i < 3; ++i) {
        put(bytes, 1.0, big);
        if (list) put(bytes, static_cast<std::uint8_t>(i));
        for (int k = 0; list && k < i; ++k) put(bytes, std::int16_t{5}, big);
        put(bytes, 2.0, big);
        put(bytes, i == 1 ? std::nan("") : 3.0, big);
        put(bytes, 0.5 * i, big);
        put(bytes, static_cast<std::uint16_t>(300 * i), big);
      }
      EXPECT_THAT(values_of(bytes, "a.ply", "confidence"), ElementsAre(0.0F, 1.0F)) << big << list;
      EXPECT_THAT(values_of(bytes, "a.ply", "quality"), ElementsAre(0.0F, 600.0F)) << big << list;
      EXPECT_THAT(values_of(bytes, "a.ply", "opacity"), ElementsAre());
    }
  }
}

TEST(FieldsOfPly, OpacityAndColourOfSplatsAreWhatIsSeen) {
  std::string names = "property float x\nproperty float y\nproperty float z\n";
  for (const char* name : {"f_dc_0", "f_dc_1", "f_dc_2", "opacity"})
    names += std::string("property float ") + name + "\n";
  const std::string ascii = ply_header("ascii", names, 2) + "0 0 0 0 1 -9 0\n1 0 0 9 0 1.5 4\n";
  std::string binary = ply_header("binary_little_endian", names, 2);
  for (const float value : {0.0F, 0.0F, 0.0F, 0.0F, 1.0F, -9.0F, 0.0F, 1.0F, 0.0F, 0.0F, 9.0F, 0.0F, 1.5F, 4.0F}) {
    put(binary, value);
  }
  for (const std::string& bytes : {ascii, binary}) {
    EXPECT_THAT(values_of(bytes, "a.ply", "opacity"),
                ElementsAre(0.5F, static_cast<float>(1.0 / (1.0 + std::exp(-4.0)))));
    const RawScan scan = read_scan_bytes(bytes, "a.ply");
    // 255 (0.5 + 0.28209479 f), Kerbl et al. 2023.
    EXPECT_THAT(scan.rgba, ElementsAre(0xFF00C780U, 0xFFEB80FFU));
  }
  // Without harmonics an opacity is what it says.
  const std::string plain =
      ply_header("ascii", "property float x\nproperty float y\nproperty float z\nproperty float opacity\n", 1);
  EXPECT_THAT(values_of(plain + "0 0 0 0.75\n", "a.ply", "opacity"), ElementsAre(0.75F));
}

TEST(FieldsOfPly, OpacityOfSplatsThatIsAShareAlreadyStaysWhatItIs) {
  std::string names = "property float x\nproperty float y\nproperty float z\n";
  for (const char* name : {"f_dc_0", "f_dc_1", "f_dc_2", "opacity"})
    names += std::string("property float ") + name + "\n";
  const auto read = [&](const std::vector<float>& opacities, bool binary) {
    const auto count = static_cast<int>(opacities.size());
    std::string bytes = ply_header(binary ? "binary_little_endian" : "ascii", names, count);
    for (int k = 0; k < count; ++k) {
      const float opacity = opacities[static_cast<std::size_t>(k)];
      if (!binary) bytes += std::to_string(k) + " 0 0 0 0 0 " + std::to_string(opacity) + "\n";
      for (const float value : {static_cast<float>(k), 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, opacity})
        if (binary) put(bytes, value);
    }
    return values_of(bytes, "a.ply", "opacity");
  };
  for (const bool binary : {false, true}) {
    EXPECT_THAT(read({0.0F, 0.25F, 1.0F}, binary), ElementsAre(0.0F, 0.25F, 1.0F));
    const auto seen = [](double logit) { return static_cast<float>(1.0 / (1.0 + std::exp(-logit))); };
    EXPECT_THAT(read({0.0F, 0.25F, 1.5F}, binary), ElementsAre(0.5F, seen(0.25), seen(1.5)));
    EXPECT_THAT(read({-0.5F, 0.25F, 1.0F}, binary), ElementsAre(seen(-0.5), seen(0.25), seen(1.0)));
    EXPECT_THAT(read({1.0F, 1.0F}, binary), ElementsAre(seen(1.0), seen(1.0)));  // all the same: nothing tells
  }
}

TEST(FieldsOfPcd, AreReadInEveryEncoding) {
  const auto header = [](const char* data) {
    return std::string(
               "VERSION 0.7\nFIELDS x y z quality _ pair\nSIZE 4 4 4 1 2 4\nTYPE F F F U U F\nCOUNT 1 1 1 1 1 2\nWIDTH "
               "2\nHEIGHT 1\nPOINTS 2\nDATA ") +
           data + "\n";
  };
  std::string binary = header("binary");
  for (const int i : {0, 1}) {
    for (int k = 0; k < 3; ++k) put(binary, 1.0F);
    put(binary, static_cast<std::uint8_t>(200 + i));
    put(binary, std::uint16_t{9});
    put(binary, 1.0F);
    put(binary, 2.0F);
  }
  EXPECT_THAT(values_of(binary, "a.pcd", "quality"), ElementsAre(200.0F, 201.0F));
  EXPECT_THAT(values_of(binary, "a.pcd", "pair"), ElementsAre());
  EXPECT_THAT(values_of(header("ascii") + "0 0 0 200 9 1 2\n1 1 1 201 9 1 2\n", "a.pcd", "quality"),
              ElementsAre(200.0F, 201.0F));
}

TEST(FieldsOfTables, AreReadByTheirNamesAlsoWhereRowsEndEarly) {
  EXPECT_THAT(values_of("x,y,z,Confidence\n0,0,0,2\n1,0,0,\n0,1,0,0\n1,1,0\n", "a.csv", "confidence"),
              ElementsAre(2.0F, -99.0F, 0.0F, -99.0F));
  EXPECT_THAT(values_of("x y z quality\n0 0 0 7\n1 0 0 8\n", "a.txt", "quality"), ElementsAre(7.0F, 8.0F));
}

TEST(FieldsOfLas, ClassesAndFlagsAreThoseOfTheFormat) {
  for (int minor = 0; minor <= 4; ++minor) {
    for (int format = 0; format <= 10; ++format) {
      LasFile file;
      file.minor = minor;
      file.format = format;
      for (int k = 0; k < 3; ++k) {
        std::string point = las_point(format, k, 0, 0);
        const int number = k == 0 ? 7 : k == 1 ? 18 : 2;
        if (format >= 6) {
          point[16] = static_cast<char>(number + (k == 2 ? 200 : 0));
          point[15] = static_cast<char>(k == 1 ? 1 + 8 : k == 2 ? 4 : 0);
        } else {
          point[15] = static_cast<char>(number | (minor > 0 ? (k == 1 ? 32 : k == 2 ? 128 : 0) : 0));
        }
        file.points.push_back(point);
      }
      const bool flags = format >= 6 || minor > 0;
      const std::vector<float> classes = values_of(file.bytes(), "a.las", PointField::kClass);
      ASSERT_EQ(classes.size(), flags ? 2U : 3U) << minor << ' ' << format;  // the third is withheld
      EXPECT_EQ(classes[0], 7.0F);
      EXPECT_EQ(classes[1], 18.0F);
      const RawScan scan = read_scan_bytes(file.bytes(), "a.las", asking({"synthetic", "overlap"}));
      EXPECT_EQ(scan.values[0], (flags ? std::vector<float>{0.0F, 1.0F} : std::vector<float>{}))
          << minor << ' ' << format;
      EXPECT_EQ(scan.values[1], (format >= 6 ? std::vector<float>{0.0F, 1.0F} : std::vector<float>{}));
      if (!flags) continue;
      EXPECT_THAT(scan.warnings, ::testing::Contains(HasSubstr("1 of 3 points are withheld")));
    }
  }
}

TEST(FieldsOfLas, NumbersThatProgramsAddAreReadByTheirDescriptions) {
  LasFile file;
  file.minor = 4;
  file.format = 6;
  file.record_user = "LASF_Spec";
  file.record_id = 4;
  const auto describe = [&](const char* name, int type, int options, double scale) {
    std::string bytes(192, '\0');
    bytes[2] = static_cast<char>(type);
    bytes[3] = static_cast<char>(options);
    std::memcpy(bytes.data() + 4, name, std::strlen(name));
    set(bytes, 40, std::uint64_t{65535});
    set(bytes, 112, scale);
    set(bytes, 136, 10.0);
    file.record += bytes;
  };
  describe("three bytes", 0, 3, 0.0);
  describe("Confidence", 3, 1 + 8 + 16, 0.5);
  describe("pair", 19, 0, 0.0);
  describe("Deviation", 9, 0, 0.0);
  describe("beyond the record", 10, 0, 0.0);
  for (const std::uint16_t stored : {std::uint16_t{4}, std::uint16_t{65535}}) {
    std::string point = las_point(6, 1, 2, 3) + "abc";
    put(point, stored);
    put(point, 1.0F);
    put(point, 2.0F);
    put(point, 0.125F);
    file.points.push_back(point);
  }
  std::string bytes = file.bytes();
  set(bytes, 105, static_cast<std::uint16_t>(file.points[0].size()));
  EXPECT_THAT(values_of(bytes, "a.las", "confidence"), ElementsAre(12.0F, -99.0F));
  EXPECT_THAT(values_of(bytes, "a.las", "deviation"), ElementsAre(0.125F, 0.125F));
  EXPECT_THAT(values_of(bytes, "a.las", "beyond the record"), ElementsAre());
}

TEST(ScanSet, HandsOverFieldsInMemoryAndStreamedAndScansWithoutHaveNone) {
  const ScanFolder folder;
  std::string with = "x,y,z,confidence\n";
  for (int i = 0; i < 5000; ++i) {
    with += (i % 5 == 0 ? "0,0,0," : std::to_string(1 + i) + ",1," + std::to_string(i % 7) + ",") + std::to_string(i) +
            "\n";
  }
  scene::ScanConfig a;
  a.file = folder.write("a.csv", with);
  a.units.unit = scene::LengthUnit::m;
  scene::ScanConfig b = a;
  b.file = folder.write("b.xyz", "1 2 3\n4 5 6\n7 8 8\n");
  std::vector<std::vector<float>> all;
  for (const ScanSet::Keep keep : {ScanSet::Keep::quickest, ScanSet::Keep::disk}) {
    Progress progress;
    ScanSet scans({a, b}, keep, false, progress, {"confidence"});
    EXPECT_EQ(scans.invalid(), 1000U);  // what a camera writes where it saw nothing
    std::vector<float>& values = all.emplace_back();
    scans.stream(
        [&](const CloudBlock& block) {
          for (std::size_t k = 0; k < block.points.size(); ++k) {
            values.push_back(block.fields[0].empty() ? -1.0F : block.fields[0][k]);
            const double x = static_cast<double>(block.points[k].x()) + scans.origin_m().x();
            if (values.back() < 0.0F) continue;
            EXPECT_EQ(values.back() + 1.0F, static_cast<float>(x));
          }
        },
        progress);
    const Cloud cloud = scans.load(scans.origin_m(), progress);
    ASSERT_EQ(cloud.fields.size(), 1U);
    ASSERT_EQ(cloud.fields[0].values.size(), 4003U);
    for (std::size_t i = 0; i < 4000; ++i) EXPECT_EQ(cloud.fields[0].values[i], values[i]);
    EXPECT_TRUE(std::isnan(cloud.fields[0].values[4002]));
    EXPECT_EQ(values[4002], -1.0F);
  }
  EXPECT_EQ(all[0], all[1]);
}

std::string proposed(const std::string& name, const std::vector<float>& values) {
  const std::vector<Worth> worth = worth_of({tally_of(name, values)});
  return worth.empty() ? "nothing" : worth[0].filter ? worth[0].text() : "unknown";
}

TEST(Worth, IsProposedWhereTheMeaningIsKnown) {
  EXPECT_EQ(proposed(PointField::kClass, {2, 2, 7, 5, 18}), "classes: {drop: [7, 18]}");
  EXPECT_EQ(proposed(PointField::kClass, {2, 2, 5}), "nothing");
  EXPECT_EQ(proposed(PointField::kClass, {7, 7}), "nothing");
  EXPECT_EQ(proposed("confidence", {0, 2, 1}), "field: {name: confidence, min: 1}");
  EXPECT_EQ(proposed("confidence", {2, 2, 2}), "nothing");
  EXPECT_EQ(proposed("confidence", {kNaN, kNaN}), "nothing");
  EXPECT_EQ(proposed("confidence", {0.25F, 0.75F}), "field: {name: confidence, min: 0.5}");
  EXPECT_EQ(proposed("confidence", {-1.0F, 0.75F}), "field: {name: confidence, min: 0.5}");
  EXPECT_EQ(proposed("confidence", {-1.0F, 0.0F, 2.0F}), "field: {name: confidence, min: 1}");
  EXPECT_EQ(proposed("confidence", {12.5F, 99.5F}), "field: {name: confidence, min: 50}");
  EXPECT_EQ(proposed("confidence", {1.0F, 59.0F}), "unknown");
  EXPECT_EQ(proposed("confidence", {-8.5F, -0.5F}), "unknown");
  EXPECT_EQ(proposed("quality", {0.0F, 200.0F}), "unknown");
  EXPECT_EQ(proposed("opacity", {0.004F, 0.98F}), "field: {name: opacity, min: 0.5}");
  EXPECT_EQ(proposed("opacity", {0.0F, 255.0F}), "field: {name: opacity, min: 128}");
  EXPECT_EQ(proposed("intensity", {0.0F, 255.0F}), "nothing");
  EXPECT_EQ(proposed("withheld", {0.0F, 1.0F, 0.0F}), "field: {name: withheld, max: 0}");
  EXPECT_EQ(proposed("withheld", {1.0F, 1.0F}), "nothing");
  EXPECT_EQ(proposed("withheld", {0.0F, 7.0F}), "nothing");
}

TEST(Worth, OfPointsThatAnyFormatMarksAsWithheldIsToLeaveThemOut) {
  const ScanFolder folder;
  std::string rows;
  for (int k = 0; k < 500; ++k) rows += fmt::format("{} {} 0.5 {}\n", k % 25, k / 25, k % 10 == 0 ? 1 : 0);
  std::string csv = "x,y,z,withheld\n" + rows;
  std::replace(csv.begin(), csv.end(), ' ', ',');
  const std::pair<std::string, std::string> files[] = {
      {"w.csv", csv},
      {"w.ply",
       "ply\nformat ascii 1.0\nelement vertex 500\nproperty float x\nproperty float y\nproperty float z\nproperty "
       "float "
       "scalar_Withheld\nend_header\n" +
           rows},
      {"w.pcd",
       "FIELDS x y z withheld\nSIZE 4 4 4 1\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 500\nHEIGHT 1\nPOINTS "
       "500\nDATA ascii\n" +
           rows}};
  for (const auto& [name, bytes] : files) {
    const std::vector<Worth> worth = worth_of(folder.read(name, bytes).tallies);
    ASSERT_EQ(worth.size(), 1U) << name;
    EXPECT_EQ(worth[0].text(), "field: {name: withheld, max: 0}");
    EXPECT_EQ(worth[0].kept, 450U);
    EXPECT_THAT(worth[0].reason, ::testing::StartsWith("50 of 500 points (10 %) are withheld"));
  }
}

TEST(ScanStatistics, HasThePointsThatTheProposedFilterLeavesInMemoryAndStreamed) {
  const ScanFolder folder;
  std::string text = "x,y,z,confidence\n";
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(0.0, 1.0);
  for (int i = 0; i < 3000; ++i) {
    text += std::to_string(anywhere(random)) + "," + std::to_string(anywhere(random)) +
            (i % 3 == 0 ? ",0.5,0\n" : ",0,2\n");
  }
  const std::filesystem::path file = folder.write("a.csv", text);
  for (const std::uint64_t large : {std::uint64_t{0}, std::uint64_t{256'000'000}}) {
    Progress progress;
    const ScanStatistics statistics = scan_statistics(file, progress, large);
    EXPECT_EQ(statistics.scan.points.size(), 2000U);
    EXPECT_EQ(statistics.scan.records, 2000U);
    for (const Eigen::Vector3d& p : statistics.scan.points) EXPECT_EQ(p.z(), 0.0);
    ASSERT_EQ(statistics.worth.size(), 1U);
    EXPECT_EQ(statistics.worth[0].kept, 2000U);
  }
}

}  // namespace
}  // namespace sparsha::pipeline
