// Columns of numbers: every separator, header and meaning of columns.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::ElementsAre;
using testing::expect_refused;
using ::testing::HasSubstr;
using testing::ScanFolder;

TEST(XyzReader, ReadsBlanksTabsCommasAndSemicolons) {
  const ScanFolder folder;
  for (const std::string text : {"1 2 3\n4 5 6\n", "1\t2\t3\r\n4\t5\t6\r\n", "1,2,3\n4,5,6", "1;2;3\n4;5;6\n",
                                 " 1 , 2 , 3 \n\n\n4 , 5 , 6\n", "\"1\",\"2\",\"3\"\n\"4\",\"5\",\"6\"\n"}) {
    const RawScan scan = folder.read("a.xyz", text);
    EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6))) << text;
    EXPECT_EQ(scan.format, "XYZ text");
  }
}

TEST(XyzReader, ReadsDecimalCommasBetweenSemicolons) {
  const ScanFolder folder;
  EXPECT_THAT(folder.read("a.csv", "X;Y;Z\n1,5;2,25;-3,125\n4;5,5;6\n").points,
              ElementsAre(Eigen::Vector3d(1.5, 2.25, -3.125), Eigen::Vector3d(4, 5.5, 6)));
}

TEST(XyzReader, UsesTheNamesOfAHeaderInAnyOrder) {
  const ScanFolder folder;
  const RawScan scan = folder.read("a.csv",
                                   "\"Name\",\"Intensity\",\"Z\",\"Y [m]\",\"X(m)\",\"Blue\",\"Green\",\"Red\"\n"
                                   "p1,0.5,3,2,1,30,20,10\np2,0.25,6,5,4,3,2,255\n");
  EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
  EXPECT_THAT(scan.intensity, ElementsAre(0.5F, 0.25F));
  EXPECT_THAT(scan.rgba, ElementsAre(0xFF1E140AU, 0xFF0302FFU));
}

TEST(XyzReader, KeepsIntensityAndColoursOfCloudCompare) {
  const ScanFolder folder;
  const RawScan scan = folder.read("a.asc", "//X Y Z Rf Gf Bf Intensity\n2\n1 2 3 0 0.5 1 15.0\n4 5 6 1 1 1 7\n");
  EXPECT_EQ(scan.records, 2U);
  EXPECT_THAT(scan.rgba, ElementsAre(0xFFFF8000U, 0xFFFFFFFFU));
  EXPECT_THAT(scan.intensity, ElementsAre(15.0F, 7.0F));
  EXPECT_THAT(scan.fields, ElementsAre("x", "y", "z", "rf", "gf", "bf", "intensity"));
}

TEST(XyzReader, GuessesColumnsWithoutAHeader) {
  const ScanFolder folder;
  EXPECT_THAT(folder.read("a.xyz", "1 2 3 117 73 49\n1 2 4 0 255 7\n").rgba, ElementsAre(0xFF314975U, 0xFF07FF00U));
  EXPECT_TRUE(folder.read("n.xyz", "1 2 3 0 0 -1\n1 2 4 0.6 0 0.8\n").rgba.empty()) << "normals are no colours";
  const RawScan measured = folder.read(
      "m.xyz", "1 2 3 9 8 7 0 0 -1 12\n1 2 4 1 2 3 0.6 0 0.8 3\n1 2 5 1 2 3 0 1 0 4\n");  // normals, then a confidence
  EXPECT_THAT(measured.fields, ElementsAre("x", "y", "z", "red", "green", "blue", "nx", "ny", "nz", "column 10"));
  EXPECT_EQ(measured.rgba.size(), 3U);
  const RawScan pts = folder.read("a.pts", "2\r\n1 2 3 -1200 10 20 30\r\n1 2 4 17 1 2 3\r\n");
  EXPECT_THAT(pts.intensity, ElementsAre(-1200.0F, 17.0F));
  EXPECT_THAT(pts.rgba, ElementsAre(0xFF1E140AU, 0xFF030201U));
  EXPECT_THAT(folder.read("i.xyz", "1 2 3 0.5\n1 2 4 7\n").intensity, ElementsAre(0.5F, 7.0F));
}

TEST(XyzReader, ReadsSeveralCountedBlocksAsScans) {
  const ScanFolder folder;
  const RawScan scan = folder.read("a.pts", "2\n1 2 3\n4 5 6\n1\n7 8 9\n");
  EXPECT_EQ(scan.records, 3U);
  EXPECT_EQ(scan.scans, 2U);
  EXPECT_EQ(folder.read("z.pts", "0\n").records, 0U);
}

TEST(XyzReader, CountedBlocksWithAndWithoutColoursKeepWhatTheyHave) {
  const ScanFolder folder;
  const std::string grey = "2\n0 0 0 -900\n1 0 0 -900\n";
  const std::string coloured = "2\n0 1 0 -800 1 2 3\n1 1 0 -700 200 5 6\n";
  const RawScan first = folder.read("a.pts", grey + coloured);
  EXPECT_THAT(first.rgba, ElementsAre(kNoColour, kNoColour, 0xFF030201U, 0xFF0605C8U));
  EXPECT_THAT(first.intensity, ElementsAre(-900.0F, -900.0F, -800.0F, -700.0F));
  EXPECT_THAT(first.fields, ElementsAre("x", "y", "z", "intensity", "red", "green", "blue"));
  EXPECT_THAT(first.warnings, ::testing::IsEmpty());
  const RawScan last = folder.read("b.pts", coloured + "1\n5 5 5\n" + grey);
  EXPECT_THAT(last.rgba, ElementsAre(0xFF030201U, 0xFF0605C8U, kNoColour, kNoColour, kNoColour));
  EXPECT_THAT(last.intensity, ElementsAre(-800.0F, -700.0F, ::testing::IsNan(), -900.0F, -900.0F));
  EXPECT_EQ(last.scans, 3U);
}

TEST(XyzReader, TakesAMissingOrWrittenNanAsInvalid) {
  const ScanFolder folder;
  const RawScan scan = folder.read("a.csv", "x,y,z\n1,2,3\n1,,3\nnan,2,3\n1,2,\n");
  EXPECT_EQ(scan.records, 4U);
  EXPECT_EQ(scan.invalid, 3U);
}

TEST(XyzReader, SkipsCommentsByteOrderMarkAndWordsBeforeTheFirstRow) {
  const ScanFolder folder;
  EXPECT_EQ(folder.read("a.txt", "\xEF\xBB\xBF# scanned 2019\nStation A\n1 2 3\n# half way\n4 5 6\n").records, 2U);
}

TEST(XyzReader, TellsFormatByContentNotByEnding) {
  const ScanFolder folder;
  EXPECT_EQ(folder.read("a.txt", "v 1 2 3\nv 4 5 6\n").format, "OBJ");
  EXPECT_EQ(folder
                .read("a.obj",
                      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                      "property float z\nend_header\n1 2 3\n")
                .format,
            "PLY ascii");
  EXPECT_EQ(folder.read("scan", "1 2 3\n").format, "XYZ text");
}

TEST(XyzReader, RefusesBrokenRowsWithTheirLine) {
  const ScanFolder folder;
  const auto refuse = [](const std::string& text, int line, const char* message) {
    expect_refused("b.txt", text, message, line);
  };
  refuse("1 2 3\n4 5\n", 2, "a row of 2 values");
  refuse("1 2 3\n4 five 6\n", 2, "'five' is not a number");
  refuse("1 2 3\nend of scan\n", 2, "not a row of numbers");
  refuse("3\n1 2 3\n4 5 6\n", 3, "only 2 rows follow the count 3");
  refuse("1 2\n3 4\n", 1, "a row of 2 values");
  refuse("nothing here\n", 1, "no rows of numbers");
  refuse(std::string("\x01\x02\x03\0\x05", 5), 0, "binary data");
}

/// Rows of `first(k)` and a relief's x, y and z.
template <typename First>
std::string rows_with(const First& first) {
  std::string text;
  for (int k = 0; k < 400; ++k) {
    const double x = 0.02 * (k % 20);
    const double y = 0.02 * (k / 20);
    text += first(k) + " " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(0.01 * x * y) + "\n";
  }
  return text;
}

std::string doubt_of(const std::string& text) {
  const RawScan scan = read_scan_bytes(text, "a.xyz");
  std::string all;
  for (const std::string& warning : scan.warnings) all += warning + "\n";
  if (all.find("first column") == std::string::npos) return {};
  return all;
}

/// Unless the reader takes the columns behind it for x, y and z by itself.
bool is_doubted_or_told(const std::string& text, const std::string& words) {
  const RawScan scan = read_scan_bytes(text, "a.xyz");
  const bool told = scan.table && scan.table->by != TextTable::By::position;
  return told || doubt_of(text).find(words) != std::string::npos;
}

TEST(XyzReader, AFirstColumnThatIsRatherANumberATimeOrAnAngleIsDoubted) {
  std::mt19937 random(3);
  std::vector<int> order(400);
  std::iota(order.begin(), order.end(), 1);
  std::shuffle(order.begin(), order.end(), random);
  const auto whole = [](int k) { return std::to_string(k); };
  const auto at = [&](int k) { return static_cast<std::size_t>(k); };
  EXPECT_TRUE(
      is_doubted_or_told(rows_with([&](int k) { return whole(1001 + k); }), "rise from row to row (1001 to 1400)"));
  EXPECT_TRUE(is_doubted_or_told(rows_with([&](int k) { return whole(3 * k + k % 2); }), "rise from row to row"));
  EXPECT_TRUE(is_doubted_or_told(rows_with([&](int k) { return whole(order[at(k)]); }), "never repeat"));
  EXPECT_TRUE(is_doubted_or_told(rows_with([&](int k) { return std::to_string(1e-4 * k); }), "as a time does"));
  EXPECT_TRUE(is_doubted_or_told(rows_with([&](int k) { return whole(18 * (k % 20) - 180); }), "as an angle does"));
}

TEST(XyzReader, AFirstColumnThatIsXIsNotDoubted) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  std::string raster;
  std::string millimetres;
  std::string sorted;
  std::string scattered;
  for (int k = 0; k < 400; ++k) {
    const auto row = [](double x, double y, double z) {
      return std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
    };
    raster += row(0.02 * (k % 20), 0.02 * (k / 20), 0.001 * (k % 7));
    millimetres += std::to_string(k % 20) + " " + std::to_string(k / 20) + " " + std::to_string(0.1 * (k % 7)) + "\n";
    sorted += row(0.01 * k + 0.009 * unit(random), unit(random), 0.1 * unit(random));
    scattered += row(unit(random), unit(random), 0.1);
  }
  for (const std::string& text : {raster, millimetres, scattered}) EXPECT_EQ(doubt_of(text), "");
  EXPECT_EQ(doubt_of(sorted), "") << "sorted by x, but unevenly";
  EXPECT_EQ(doubt_of("x y z\n" + rows_with([](int k) { return std::to_string(k); })), "") << "the file says so";
}

/// A relief in rows of 40 that a scanner swept over: place k of 1600 as x, y and z, off its lattice by chance.
class SweptRelief {
 public:
  explicit SweptRelief(unsigned seed) : random_(seed) {}

  [[nodiscard]] double chance(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  [[nodiscard]] Eigen::Vector3d at(int k) {
    const double x = 0.01 * (k % 40) + chance(-0.003, 0.003);
    const double y = 0.01 * (k / 40) + chance(-0.003, 0.003);
    return {x, y, 0.02 * std::sin(25 * x) * std::cos(20 * y) + 0.03 * x};
  }
  /// `first(k)` before x, y and z, and `behind(k)` after them.
  template <typename First, typename Behind>
  [[nodiscard]] std::string rows(const First& first, const Behind& behind) {
    std::string text;
    for (int k = 0; k < 1600; ++k) {
      const Eigen::Vector3d p = at(k);
      text += fmt::format("{:.7f} {:.5f} {:.5f} {:.5f}{}\n", first(k), p.x(), p.y(), p.z(), behind(k));
    }
    return text;
  }

 private:
  std::mt19937 random_;
};

TEST(XyzReader, AFirstColumnThatNeverFallsIsDoubtedAsATimeWhateverItsSteps) {
  SweptRelief relief(33);
  const auto nothing = [](int) { return std::string(); };
  const auto intensity = [&](int) { return fmt::format(" {:.2f}", relief.chance(0, 2000)); };
  const auto is_time = [](const std::string& text) {
    return doubt_of(text).find("as a time does") != std::string::npos;
  };
  double time = 250312.1;
  const auto uneven = [&](int) { return time += relief.chance(5e-6, 3e-5); };
  EXPECT_TRUE(is_time(relief.rows(uneven, nothing)));
  EXPECT_TRUE(is_time(relief.rows(uneven, intensity)));
  EXPECT_TRUE(is_time(relief.rows([&](int) { return time += relief.chance(0, 1) < 0.25 ? 2e-5 : 1e-5; }, nothing)))
      << "a quarter of the shots has no return";
  EXPECT_TRUE(
      is_time(relief.rows([&](int k) { return time += k % 2 == 0 ? relief.chance(1e-3, 2e-3) : 0.0; }, nothing)))
      << "two returns have one time";
  EXPECT_TRUE(is_time(relief.rows([](int k) { return 1.7e9 + 0.1 * (k / 12); }, nothing))) << "frames of 12 points";
  EXPECT_TRUE(is_time(relief.rows([](int k) { return 1e-5 * k; }, intensity)));
}

TEST(XyzReader, AnXThatNeverFallsIsNotDoubtedAsATime) {
  SweptRelief relief(34);
  const auto row = [](double x, double y, double z) { return fmt::format("{:.5f} {:.5f} {:.5f}", x, y, z); };
  const auto wave = [](double x, double y) { return 0.02 * std::sin(25 * x) * std::cos(20 * y); };
  using Behind = std::function<std::string(double, double)>;
  // Without a fourth column, with an intensity of chance, with one that never changes, and with a smooth one.
  const std::vector<Behind> behinds = {
      [](double, double) { return std::string("\n"); },
      [&](double, double) { return fmt::format(" {:.2f}\n", relief.chance(0, 2000)); },
      [](double, double) { return std::string(" 0.5\n"); },
      [](double x, double y) { return fmt::format(" {:.4f}\n", 1 + std::sin(3 * x + 2 * y)); },
  };
  for (std::size_t kind = 0; kind < behinds.size(); ++kind) {
    SCOPED_TRACE("behind z: " + std::to_string(kind));
    std::vector<Eigen::Vector3d> sorted;
    for (int k = 0; k < 1600; ++k) sorted.push_back(relief.at(k));
    const auto by_x = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a.x() < b.x(); };
    std::sort(sorted.begin(), sorted.end(), by_x);
    std::string of_sorted, columns, there_and_back, turned, turned_little, level, slanted, circle, section, corrugated,
        road, strips;
    for (const Eigen::Vector3d& p : sorted) of_sorted += row(p.x(), p.y(), p.z()) + behinds[kind](p.x(), p.y());
    for (int k = 0; k < 1600; ++k) {
      const double u = 0.01 * (k / 40);
      const double v = 0.01 * (k % 40);
      const double back = k / 40 % 2 == 0 ? v : 0.39 - v;
      columns += row(u, v, wave(u, v)) + behinds[kind](u, v);
      there_and_back += row(u, back, wave(u, back)) + behinds[kind](u, back);
      const auto turn = [&](double angle) {
        return row(u * std::cos(angle) + v * std::sin(angle), v * std::cos(angle) - u * std::sin(angle), wave(u, v));
      };
      turned += turn(0.02) + behinds[kind](u, v);
      turned_little += turn(0.002) + behinds[kind](u, v);
      const double along = 0.002 * k + relief.chance(0, 0.0015);
      level += row(along, 0.2, 0.02 * std::sin(25 * along)) + behinds[kind](along, 0.25);
      slanted += row(along, 0.3 * along + 1, 0.02 * std::sin(25 * along)) + behinds[kind](along, 0.25);
      circle += row(u, 0.1 * std::cos(16 * v), 0.1 * std::sin(16 * v)) + behinds[kind](u, v);
      section += row(u, 0.1 * std::cos(16.11 * v + 0.7), 0.1 * std::sin(16.11 * v + 0.7)) + behinds[kind](u, v);
      corrugated += row(u, v, 0.02 * std::sin(75 * u)) + behinds[kind](u, v);
      road += row(along, std::sin(15 * along) + relief.chance(-0.1, 0.1), 0.1 * std::cos(3 * along)) +
              behinds[kind](along, 0.0);
      strips += row(0.01 * (k % 400), 0.1 * (k / 400), wave(u, v)) + behinds[kind](u, v);
    }
    EXPECT_EQ(doubt_of(of_sorted), "");
    EXPECT_EQ(doubt_of(columns), "");
    EXPECT_EQ(doubt_of(there_and_back), "");
    EXPECT_EQ(doubt_of(turned), "");
    EXPECT_EQ(doubt_of(turned_little), "");
    EXPECT_EQ(doubt_of(level), "");
    EXPECT_EQ(doubt_of(slanted), "");
    EXPECT_EQ(doubt_of(circle), "");
    EXPECT_EQ(doubt_of(section), "");
    EXPECT_EQ(doubt_of(corrugated), "");
    EXPECT_EQ(doubt_of(road), "");
    EXPECT_EQ(doubt_of(strips), "");
  }
  // A line scanner on a carriage, with the class of each point behind it.
  std::string carriage;
  double along = 0.0;
  for (int k = 0; k < 1600; ++k) {
    along += relief.chance(5e-6, 3e-5);
    const double across = 0.01 * (k / 40 % 2 == 0 ? k % 40 : 39 - k % 40);
    carriage += fmt::format("{:.7f} {:.5f} {:.5f} 2\n", along, across, wave(along, across));
  }
  EXPECT_EQ(doubt_of(carriage).find("as a time does"), std::string::npos);
}

TEST(XyzReader, RowsOfNineNumbersThatAreTrianglesAreSaid) {
  const auto row = [](std::initializer_list<std::array<double, 2>> corners) {
    std::string text;
    for (const auto& [x, y] : corners) text += fmt::format("{:.4f} {:.4f} {:.5f} ", x, y, 0.02 * std::sin(20 * x) * y);
    return text + "\n";
  };
  std::string triangles, epochs;
  for (int k = 0; k < 400; ++k) {
    const double x = 0.01 * (k % 20);
    const double y = 0.01 * (k / 20);
    triangles += row({{x, y}, {x + 0.01, y}, {x + 0.01, y + 0.01}});
    triangles += row({{x, y}, {x + 0.01, y + 0.01}, {x, y + 0.01}});
    epochs += row({{x, y}, {x + 0.0012, y + 0.0003}, {x + 0.0023, y + 0.0006}});
  }
  EXPECT_THAT(read_scan_bytes(triangles, "a.raw").warnings, ElementsAre(HasSubstr("corners of a triangle")));
  EXPECT_THAT(read_scan_bytes(epochs, "a.txt").warnings, ::testing::IsEmpty()) << "three surveys of the same points";
}

}  // namespace
}  // namespace sparsha::pipeline
