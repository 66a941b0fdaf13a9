// E57: colours of points that have none, from the pictures of their station.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "base/png/png.h"
#include "tests/pipeline/scan/formats/e57/e57_file.h"

namespace sparsha::pipeline {
namespace {

using testing::E57File;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::reals;
using testing::ScanFolder;

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

TEST(E57Pictures, AWorldWithTheColoursOfItsDirectionsGetsThemBack) {
  const ScanFolder folder;
  const std::string name = folder.write("two.txt", "").replace_extension().string();
  const std::string command = std::string(SPARSHA_PYTHON) + " \"" + SPARSHA_TWO_STATIONS + "\" \"" + name + "\"";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  const RawScan scan = read_scan(name + ".e57");
  EXPECT_THAT(scan.warnings, ::testing::IsEmpty());
  std::ifstream truth(name + ".csv");
  std::size_t number = 0, coloured = 0;
  for (std::string line; std::getline(truth, line); ++number) {
    double x = 0, y = 0, z = 0, seen = 0, r = 0, g = 0, b = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &x, &y, &z, &seen, &r, &g, &b), 7);
    ASSERT_LT(number, scan.points.size());
    ASSERT_LT((scan.points[number] - Eigen::Vector3d(x, y, z)).norm(), 1e-12) << "the order of the file";
    const auto byte = [](double value) { return static_cast<std::uint32_t>(value); };
    EXPECT_EQ(scan.rgba[number], seen > 0.5 ? pack_rgba(byte(r), byte(g), byte(b)) : kNoColour) << line;
    coloured += seen > 0.5 ? 1 : 0;
  }
  EXPECT_EQ(number, scan.points.size());
  EXPECT_EQ(number, 400U);
  EXPECT_GT(coloured, 225U) << "all of the panorama, some of the camera";
  EXPECT_LT(coloured, 275U);
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
