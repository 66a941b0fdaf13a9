// 3MF: units, transforms, components in other parts; packages that are cut, damaged or lie.
#include <gmock/gmock.h>
#include <zlib.h>

#include <random>
#include <utility>

#include "tests/support/deflated.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::ElementsAre;
using testing::expect_refused;
using ::testing::HasSubstr;
using testing::put;

using Parts = std::vector<std::pair<std::string, std::string>>;

std::string deflated(const std::string& bytes) { return testing::deflated(bytes, -MAX_WBITS); }

std::string zip(const Parts& parts, bool packs = true) {
  std::string bytes, directory;
  for (const auto& [name, text] : parts) {
    const std::string packed = packs ? deflated(text) : text;
    std::string head;  // what local and central headers share
    put(head, std::uint16_t{0});
    put(head, static_cast<std::uint16_t>(packs ? 8 : 0));
    put(head, std::uint32_t{0});
    put(head, static_cast<std::uint32_t>(
                  crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size()))));
    put(head, static_cast<std::uint32_t>(packed.size()));
    put(head, static_cast<std::uint32_t>(text.size()));
    put(head, static_cast<std::uint16_t>(name.size()));
    put(head, std::uint16_t{0});
    directory += std::string("PK\x01\x02\x14\0\x14\0", 8) + head + std::string(10, '\0');
    put(directory, static_cast<std::uint32_t>(bytes.size()));
    directory += name;
    bytes += std::string("PK\x03\x04\x14\0", 6) + head + name + packed;
  }
  const std::size_t begin = bytes.size();
  bytes += directory + std::string("PK\x05\x06\0\0\0\0", 8);
  for (int k = 0; k < 2; ++k) put(bytes, static_cast<std::uint16_t>(parts.size()));
  put(bytes, static_cast<std::uint32_t>(directory.size()));
  put(bytes, static_cast<std::uint32_t>(begin));
  put(bytes, std::uint16_t{0});
  return bytes;
}

const std::string kTriangle =
    "<mesh><vertices><vertex x='1' y=\"2\" z='3' /><vertex x='4' y='2' z='3'/><vertex z='3' y='5' x='1e0'></vertex>"
    "</vertices><triangles><triangle v1='0' v2='1' v3='2' pid='1'/></triangles></mesh>";

std::string model(const std::string& inside, const std::string& unit = "unit='millimeter'") {
  return "<?xml version='1.0'?>\n<!-- <vertex/> -->\n<model " + unit +
         " xmlns='http://schemas.microsoft.com/3dmanufacturing/core/2015/02' xmlns:p='x'>\n" + inside + "</model>\n";
}

std::string package(const std::string& text, bool packs = true) {
  return zip({{"[Content_Types].xml", "<Types/>"}, {"3D/3dmodel.model", text}}, packs);
}

std::string one_object(const std::string& build = "<item objectid='1'/>") {
  return model("<resources><object id='1' type='model'>" + kTriangle + "</object></resources><build>" + build +
               "</build>");
}

TEST(ThreeMf, UnitsAreThoseOfTheModel) {
  const std::tuple<const char*, scene::LengthUnit, double> units[] = {
      {"unit='millimeter'", scene::LengthUnit::mm, 1.0}, {"", scene::LengthUnit::mm, 1.0},
      {"unit='micron'", scene::LengthUnit::mm, 0.001},   {"unit='centimeter'", scene::LengthUnit::cm, 1.0},
      {"unit='inch'", scene::LengthUnit::mm, 25.4},      {"unit='foot'", scene::LengthUnit::ft, 1.0},
      {"unit='meter'", scene::LengthUnit::m, 1.0}};
  for (const auto& [unit, expected, factor] : units) {
    for (const bool packs : {false, true}) {
      const RawScan scan = read_scan_bytes(package(model("<resources><object id='1'>" + kTriangle +
                                                             "</object></resources><build><item objectid='1'/></build>",
                                                         unit),
                                                   packs),
                                           "a.3mf");
      EXPECT_EQ(scan.format, "3MF");
      EXPECT_EQ(scan.unit, expected);
      EXPECT_THAT(scan.points, ElementsAre(factor * Eigen::Vector3d(1, 2, 3), factor * Eigen::Vector3d(4, 2, 3),
                                           factor * Eigen::Vector3d(1, 5, 3)));
      EXPECT_THAT(scan.faces, ElementsAre(std::array<std::uint32_t, 3>{0, 1, 2}));
    }
  }
  expect_refused("a.3mf", package(model("", "unit='ell'")), "the 3MF model's unit is 'ell'");
}

TEST(ThreeMf, TransformsOfComponentsAndItemsFollowOneAnother) {
  // A part of its own, turned by a quarter about z, then moved; the second item is mirrored in x.
  const std::string child = model("<resources><object id='7'>" + kTriangle + "</object></resources>");
  const std::string root = model(
      "<resources><object id='2'><components>"
      "<component p:path='/3D/Objects/a.model' objectid='7' transform='0 1 0 -1 0 0 0 0 1 10 0 0'/></components>"
      "</object><object id='3' type='support'>" +
      kTriangle +
      "</object></resources><build><item objectid='2' transform='1 0 0 0 1 0 0 0 1 0 0 5'/>"
      "<item objectid='2' transform='-1 0 0 0 1 0 0 0 1 0 0 0'/><item objectid='3'/></build>");
  const std::string bytes =
      zip({{"_rels/.rels",
            "<Relationships><Relationship Id='r' Type='http://schemas.microsoft.com/3dmanufacturing/2013/"
            "01/3dmodel' Target='/3D/other.MODEL'/></Relationships>"},
           {"3D/other.model", root},
           {"3D/Objects/a.model", child}});
  const RawScan scan = read_scan_bytes(bytes, "a.3mf");
  EXPECT_THAT(scan.points,
              ElementsAre(Eigen::Vector3d(8, 1, 8), Eigen::Vector3d(8, 4, 8), Eigen::Vector3d(5, 1, 8),
                          Eigen::Vector3d(-8, 1, 3), Eigen::Vector3d(-8, 4, 3), Eigen::Vector3d(-5, 1, 3)));
  EXPECT_THAT(scan.faces, ElementsAre(std::array<std::uint32_t, 3>{0, 1, 2}, std::array<std::uint32_t, 3>{3, 5, 4}));
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("1 supports are left out")));
  EXPECT_THAT(scan.notes, ElementsAre(HasSubstr("2 meshes built of 3 objects")));
}

TEST(ThreeMf, WithoutABuildWhatIsNoComponentIsTaken) {
  const std::string text = model("<resources><object id='1'>" + kTriangle +
                                 "</object><object id='2'><components><component objectid='1'/></components></object>"
                                 "</resources><build/>");
  EXPECT_EQ(read_scan_bytes(package(text), "a.3mf").points.size(), 3U);
}

std::string with_extension(const std::string& name, const std::string& inside = "", const char* required = "e") {
  std::string text = one_object();
  text.replace(text.find("<model "), 7,
               "<model requiredextensions='" + std::string(required) +
                   "' xmlns:e='http://schemas.microsoft.com/3dmanufacturing/" + name + "' ");
  text.insert(text.find("<mesh>"), inside);
  return package(text);
}

TEST(ThreeMf, ExtensionsThatAreRequiredAndUnknownAreRefusedByName) {
  for (const char* const name : {"slice/2015/07", "beamlattice/2017/02", "displacement/2022/07", "new/2031/01"})
    expect_refused("a.3mf", with_extension(name), std::string("requires the extension 'e' ('") + name + "')");
  expect_refused("a.3mf", with_extension("material/2015/02", "", "e  b"), "'b', which it does not declare");
  for (const char* const name : {"material/2015/02", "production/2015/06", "trianglesets/2021/07"}) {
    EXPECT_EQ(read_scan_bytes(with_extension(name), "a.3mf").points.size(), 3U) << name;
    EXPECT_THAT(read_scan_bytes(with_extension(name), "a.3mf").warnings, ::testing::IsEmpty());
  }
  // What is not required may be left out, and is said.
  const RawScan scan =
      read_scan_bytes(with_extension("beamlattice/2017/02", "<e:beam v1='0' v2='1'/><e:beam/>", ""), "a.3mf");
  EXPECT_EQ(scan.points.size(), 3U);
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("the 2 elements 'beam' of its objects")));
}

TEST(ThreeMf, ObjectsWithoutFormAreSaidAndEnd) {
  // What follows the object that closes itself is not its own.
  const RawScan scan = read_scan_bytes(
      package(model("<resources><object id='1'>" + kTriangle + "</object><object id='2'/>" + kTriangle +
                    "<object id='3'></object></resources><build><item objectid='1'/><item objectid='2'/><item "
                    "objectid='3'/></build>")),
      "a.3mf");
  EXPECT_EQ(scan.points.size(), 3U);
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("2 objects that are built have neither meshes nor components")));
}

TEST(ThreeMf, PartsOfAnotherUnitAreConvertedToTheModels) {
  const auto read = [](const std::string& unit_of_part) {
    return read_scan_bytes(
        zip({{"3D/3dmodel.model",
              model("<resources><object id='2'><components><component p:path='/3D/a.model' objectid='9' "
                    "transform='1 0 0 0 1 0 0 0 1 100 0 0'/></components></object></resources><build><item "
                    "objectid='2'/></build>",
                    "unit='centimeter'")},
             {"3D/a.model",
              model("<resources><object id='8'>" + kTriangle +
                        "</object><object id='9'><components><component objectid='8' transform='1 0 0 0 1 0 0 0 1 0 7 "
                        "0'/></components></object></resources>",
                    unit_of_part)}}),
        "a.3mf");
  };
  const RawScan inches = read("unit='inch'");
  ASSERT_EQ(inches.points.size(), 3U);
  EXPECT_EQ(inches.unit, scene::LengthUnit::cm);
  EXPECT_LT((inches.points[0] - Eigen::Vector3d(100 + 2.54, 9 * 2.54, 3 * 2.54)).norm(), 1e-9);
  EXPECT_THAT(inches.warnings, ElementsAre(HasSubstr("the part '3d/a.model' is in the unit inch, the model in "
                                                     "centimeter: its coordinates are converted")));
  for (const char* const same : {"", "unit='centimeter'"}) {
    const RawScan scan = read(same);
    EXPECT_EQ(scan.points.at(0), Eigen::Vector3d(101, 9, 3));
    EXPECT_THAT(scan.warnings, ::testing::IsEmpty());
  }
}

TEST(ThreeMf, TextInUtf16IsRefusedByName) {
  for (const bool marked : {false, true}) {
    std::string wide = marked ? "\xFF\xFE" : "";
    for (const char c : one_object()) wide += std::string{c, '\0'};
    expect_refused("a.3mf", package(wide), "the archive's part '3d/3dmodel.model' is text in UTF-16");
  }
}

TEST(ThreeMf, APackageThatIsCutIsRefused) {
  for (const bool packs : {false, true}) {
    const std::string bytes = package(one_object(), packs);
    for (std::size_t size = 0; size < bytes.size(); ++size) expect_refused("a.3mf", bytes.substr(0, size), "");
    const std::string text = one_object();
    for (std::size_t size = 0; size < text.find("</model>") + 8; ++size) {
      expect_refused("a.3mf", package(text.substr(0, size), packs), "");
    }
  }
}

TEST(ThreeMf, WhatLiesIsRefusedWithItsPlace) {
  expect_refused("a.3mf", package(one_object("<item objectid='9'/>")), "uses an object '9' that is not there");
  expect_refused("a.3mf", package(one_object("<item objectid='1' transform='1 0 0 0 1 0 0 0 1 0 0'/>")),
                 "line 4 of its model: a transform has no number 12");
  expect_refused("a.3mf", package(one_object("<item objectid='1' transform='1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1'/>")),
                 "a transform has more than twelve numbers");
  expect_refused("a.3mf", package(model("<build/>")), "builds no mesh");
  expect_refused("a.3mf", package("<html></html>"), "is no 3MF model");
  expect_refused("a.3mf", zip({{"other.xml", "<a/>"}}), "the archive has no part");
  const std::string loop = "<object id='1'><components><component objectid='1'/></components></object>";
  expect_refused("a.3mf", package(model(loop + "<build><item objectid='1'/></build>")), "components");
  // Each object twice the one before: a thousand million triangles of some lines.
  std::string many = "<object id='0'>" + kTriangle + "</object>";
  for (int i = 1; i <= 30; ++i) {
    const std::string use = "<component objectid='" + std::to_string(i - 1) + "'/>";
    many += "<object id='" + std::to_string(i) + "'><components>" + use + use + "</components></object>";
  }
  expect_refused("a.3mf", package(model(many + "<build><item objectid='30'/></build>")), "components");
  std::string far = one_object();
  far.replace(far.find("v3='2'"), 6, "v3='9'");
  EXPECT_TRUE(read_scan_bytes(package(far), "a.3mf").faces.empty());
  far.replace(far.find("v3='9'"), 6, "v3='x'");
  expect_refused("a.3mf", package(far), "'x' is no number");
  std::string damaged = package(one_object(), false);
  damaged[damaged.find("x='1'") + 3] = '2';
  expect_refused("a.3mf", damaged, "its checksum is another one");
}

TEST(ThreeMf, APartThatUnpacksWithoutEndIsRefused) {
  std::string bytes = package(one_object() + std::string(65'000'000, ' '));
  expect_refused("a.3mf", bytes, "unpacks to far more than it holds");
}

TEST(ThreeMf, ChangedBytesGivePointsOrAnError) {
  std::mt19937 random(4);
  for (const bool packs : {false, true}) {
    const std::string bytes = package(one_object(), packs);
    for (int trial = 0; trial < 3000; ++trial) {
      std::string changed = bytes;
      for (int k = 0; k < 2; ++k) changed[random() % changed.size()] = static_cast<char>(random());
      try {
        (void)read_scan_bytes(changed, "a.3mf");
      } catch (const Error&) {
      }
    }
    // The text alone, with the right checksum.
    for (int trial = 0; trial < 3000; ++trial) {
      std::string text = one_object("<item objectid='1' transform='1 0 0 0 1 0 0 0 1 0 0 5'/>");
      for (int k = 0; k < 3; ++k) text[random() % text.size()] = "<>/='\" 19-e"[random() % 11];
      try {
        (void)read_scan_bytes(package(text, packs), "a.3mf");
      } catch (const Error&) {
      }
    }
  }
}

}  // namespace
}  // namespace sparsha::pipeline
