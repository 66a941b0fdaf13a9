// Tables as other programs and people write them, that must not be read as something else: what is refused says why.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using testing::expect_refused;

void expect_read(const std::string& text, const std::string& name = "t.csv") {
  const auto error = testing::error_of_bytes(name, text);
  EXPECT_FALSE(error) << error->what();
}

std::string rows(const std::string& header, const std::string& row, int count = 30) {
  std::string text = header;
  for (int k = 0; k < count; ++k) text += row + std::to_string(k) + "\n";
  return text;
}

TEST(Dialects, ThousandsBetweenBlanksAreRefusedWhereOtherSeparatorsPartTheValues) {
  for (const char* row :
       {"1 234.50;2 345.25;1.", "1 234,50;2 345,25;1,", "-12 345 678.5\t2 345.0\t0.", "1.5;2 345;0."}) {
    expect_refused("t.csv", rows("", row), "blanks part the thousands", 1);
  }
  expect_refused("t.csv", rows("X;Y;Z\n", "1 234,50;2 345,25;1,"), "blanks part the thousands", 2);
  expect_refused("t.csv", rows("", "\"1 234.5\",\"2 345.0\",1."), "blanks part the thousands", 1);
}

TEST(Dialects, BlanksBesideSeparatorsAndColoursBetweenBlanksAreNoThousands) {
  expect_read(rows("", "1.5; 2.5; 0."));
  expect_read(rows("", " 1.5 ;\t2.5 ; 0."));
  expect_read(rows("", "234 500 1."));
  expect_read(rows("", "412,5 812,3 12,"));
  expect_read(rows("", "123,456 234,567 345,"));
  expect_read(rows("", "0.5,0.25,0.1,255 128 10"));
}

TEST(Dialects, CharactersThatLookLikeAsciiAreNamed) {
  expect_refused("t.csv", rows("", "\u22120.5 0.25 0."), "<U+2212>0.5");
  expect_refused("t.csv", rows("X;Y;Z\n", "412\u202f345,5;1,5;0,"), "412<U+202F>345,5");
  expect_refused("t.csv", rows("", "0.5\u00a00.25\u00a00."), "<U+00A0>");
}

TEST(Dialects, LettersOfOtherAlphabetsInNumbersAreNamedToo) {
  const std::string sound = rows("", "0.5 0.25 0.", 20);
  expect_refused("t.csv", sound + "0.5 0.25 \u041e.5\n", "'<U+041E>.5' is not a number", 21);
  expect_refused("t.csv", sound + "\uff11.5 0.25 0.5\n", "<U+FF11>.5", 21);
  for (const char* digits :
       {"1\u043e0", "1\u03bf0", "1\uff100", "\u06f1\u06f0\u06f0", "10\u200b0", "\u2212100", "1\u00a0000"}) {
    SCOPED_TRACE(digits);
    const std::string odd = std::string("0.5 0.25 0.5 255 ") + digits + " 3\n";
    expect_refused("t.csv", "x y z r g b\n0.5 0.25 0.5 255 100 3\n" + odd, "is not a number", 3);
    expect_refused("t.csv", "0.5 0.25 0.5 255 100 3\n" + odd, "is not a number", 2);
  }
}

TEST(Dialects, AFirstRowWithSuchCharactersIsNoTitle) {
  using namespace std::string_literals;
  const std::string others = rows("", "0.5 0.25 0.");
  for (const std::string& row :
       {"\u22120.5 0.25 0.5"s, "\uff10.5 0.25 0.5"s, "\u00a00.5 0.25 0.5"s, "\u041e.5 0.25 0.5"s, "\u03bf.5 0.25 0.5"s,
        "\x96\x30.5 0.25 0.5"s, "0.5\xa0\x30.25\xa0\x30.5"s}) {
    SCOPED_TRACE(row);
    expect_refused("t.csv", row + "\n" + others, "is not a row of numbers", 1);
  }
}

TEST(Dialects, WordsWithSuchCharactersAreWords) {
  for (const char* word :
       {"\u2014", "\u041e", "\u0422\u043e\u0447\u043a\u0430-5", "12\u00b030", "\u21165", "5\u043c"}) {
    SCOPED_TRACE(word);
    expect_read("x y z name\n" + rows("", "0.5 0.25 0.125 ") + "0.5 0.25 0.125 " + word + "\n");
  }
  expect_refused("t.csv", rows("", "0.5 0.25 0.") + "0.5 0.25 \u0437\u043e\u043d\u0430\n",
                 "'\u0437\u043e\u043d\u0430'");
}

TEST(Dialects, AxesInLettersOfOtherAlphabetsAreWhatTheyLookLike) {
  for (const char* header : {"z \u0443 \u0445\n", "\u0396 \u03a5 \u03a7\n", "\uff5a \uff59 \uff58\n", "Z Y \u0425\n"}) {
    const RawScan scan = read_scan_bytes(header + std::string("1.5 2.5 3.5\n4.5 5.5 6.5\n"), "t.txt");
    EXPECT_THAT(scan.points, ::testing::ElementsAre(Eigen::Vector3d(3.5, 2.5, 1.5), Eigen::Vector3d(6.5, 5.5, 4.5)))
        << header;
  }
}

TEST(Dialects, OneDamagedRowMovesNoHeader) {
  // Nine names over twelve values: those behind belong to the last name, whatever is wrong with a row.
  const std::string header = "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[]\n";
  const std::string sound = rows(header, "7 0.5 0.25 0.125 1 2 3 0.5 1 2 2 ", 30);
  EXPECT_EQ(read_scan_bytes(sound, "t.txt").points.front(), Eigen::Vector3d(0.5, 0.25, 0.125));
  expect_refused("t.txt", sound + "8 0.5 0.2x5 0.125 1 2 3 0.5 1 2 2 3\n", "'0.2x5' is not a number", 32);
}

/// Rows of 400 points "<label>, 0.5, 0.25, 0.k" or, with labels behind, "0.5, 0.25, 0.k, <label>".
std::string labelled(const std::string& header, const std::vector<std::string>& labels, bool behind = false) {
  std::string text = header;
  for (std::size_t k = 0; k < 400; ++k) {
    const std::string& label = labels[k % labels.size()];
    const std::string point = "0.5,0.25,0." + std::to_string(k);
    text += (behind ? point + "," + label : label + "," + point) + "\n";
  }
  return text;
}

/// Labels of which every 15th, less than the share of damaged rows, is `odd`.
std::vector<std::string> mostly(const std::string& usual, const std::string& odd) {
  std::vector<std::string> labels(15, usual);
  labels[7] = odd;
  return labels;
}

TEST(Dialects, NumbersOfPointsWithALetterAreNoDamagedCoordinates) {
  for (const char separator : {',', ' ', '\t', ';'}) {
    SCOPED_TRACE(separator);
    std::string text = labelled("x,y,z\n", mostly("1964", "1965A"));
    std::replace(text.begin(), text.end(), ',', separator);
    const RawScan scan = read_scan_bytes(text, "t.csv");
    ASSERT_EQ(scan.points.size(), 400U);
    EXPECT_EQ(scan.points[7], Eigen::Vector3d(0.5, 0.25, 0.7));
    EXPECT_THAT(scan.warnings,
                ::testing::Contains(::testing::HasSubstr("x, y and z are taken from columns 2, 3 and 4")));
  }
  const std::string behind_name = labelled("name,x,y,z\n", mostly("wall,1964", "wall,1965A"));
  EXPECT_EQ(read_scan_bytes(behind_name, "t.csv").points.back(), Eigen::Vector3d(0.5, 0.25, 0.399));
}

TEST(Dialects, DamagedCoordinatesBelowAHeaderThatIsShorterMoveNothing) {
  expect_refused("t.csv", labelled("x,y,z\n", mostly("1.25", "1.2x5")), "'1.2x5' is not a number", 9);
  // Whole numbers, of which one has a letter that only looks like a digit.
  expect_refused("t.csv", labelled("x,y,z\n", mostly("100", "1\u041e0")),
                 "'1<U+041E>0' is not a number; at least 3 values, of which 1, 2 and 3", 9);
  expect_refused("t.csv", labelled("x,y,z\n", mostly("100", "\u2212100")),
                 "'<U+2212>100' is not a number; at least 3 values", 9);
}

TEST(Dialects, LabelsThatLookLikeNumbersAreLabels) {
  const std::vector<std::string> rooms = {"\u04311", "\u04312", "\u04313", "\u04314", "\u041e2", "\u04171"};
  for (const bool behind : {true, false}) {
    const RawScan scan = read_scan_bytes(labelled(behind ? "x,y,z,room\n" : "room,x,y,z\n", rooms, behind), "t.csv");
    ASSERT_EQ(scan.points.size(), 400U) << behind;
    EXPECT_EQ(scan.points[399], Eigen::Vector3d(0.5, 0.25, 0.399)) << behind;
  }
  expect_read(labelled("x,y,z,room\n", {"\u04311", "hall", "", "2"}, true));
  // Nobody names the columns: labels are no intensity.
  for (const char* header : {"", "x,y,z\n"}) {
    EXPECT_TRUE(read_scan_bytes(labelled(header, rooms, true), "t.csv").intensity.empty()) << header;
  }
  for (const char* row : {"255,100,3,\u04311", "\u04311,255,100,3"}) {
    const RawScan scan = read_scan_bytes(labelled("", {row}, true), "t.csv");
    EXPECT_TRUE(scan.intensity.empty() && scan.rgba.size() == 400) << row;
  }
}

TEST(Dialects, ColumnsOfNumbersAndNamedAttributesAreNoLabels) {
  expect_refused("t.csv", labelled("x,y,z,room\n", mostly("12", "1\u041e"), true), "'1<U+041E>' is not a number", 9);
  expect_refused("t.csv", labelled("x,y,z,intensity\n", {"\uff11\uff12"}, true), "'<U+FF11><U+FF12>' is not", 2);
  expect_refused("t.csv", labelled("x,y,z,r,g,b\n", {"\uff11,2,3"}, true), "'<U+FF11>' is not a number", 2);
  expect_refused("t.csv", labelled("x,y,z,nx,ny,nz\n", {"0,0,\u22121"}, true), "'<U+2212>1' is not a number", 2);
  // Tables that were joined, where a colour of the second one has such a digit.
  expect_refused("t.xyz",
                 rows("", "0.5 0.25 0.", 1200) + rows("", "0.5 0.25 0.5 255 100 3", 30) + "1 2 3 25\u043e 4 5\n",
                 "'25<U+043E>' is not a number", 1231);
}

TEST(Dialects, ZeroBytesBehindTheRowsAreSaidToBeThat) {
  expect_refused("t.csv", rows("", "0.5 0.25 0.", 400) + std::string(512, '\0'), "zero bytes in place of", 401);
}

/// A relief of 20 x 30 points, millimetres or metres, whose rows are as `row` writes them.
template <typename Write>
std::string relief(const std::string& header, const Write& row) {
  std::string text = header;
  for (int k = 0; k < 600; ++k) {
    const double x = 0.004 * (k % 30), y = 0.005 * (k / 30), z = 0.01 * ((k % 30) * (k / 30) % 7);
    text += row(x, y, z) + "\n";
  }
  return text;
}
std::string three(const char* separator, double a, double b, double c) {
  return fmt::format("{:.4f}{}{:.4f}{}{:.4f}", a, separator, b, separator, c);
}

TEST(Dialects, NorthingsAsXAreDoubtedWhetherNamedOrNot) {
  using ::testing::Contains;
  using ::testing::HasSubstr;
  using ::testing::Not;
  struct Grid {
    double east, north;
  };
  const testing::ScanFolder folder;
  const auto read = [&](const std::string& header, const Grid& grid, bool swapped) {
    return folder.read("t.csv", relief(header, [&](double x, double y, double z) {
                         const double e = grid.east + x, n = grid.north + y;
                         return swapped ? three(";", n, e, z) : three(";", e, n, z);
                       }));
  };
  const auto doubted = Contains(HasSubstr("has the size of northings"));
  for (const Grid& grid : {Grid{432000, 5412000}, Grid{3456000, 5432000}, Grid{2600000, 1200000}}) {
    SCOPED_TRACE(grid.east);
    EXPECT_THAT(read("", grid, true).warnings, doubted);
    EXPECT_THAT(read("X;Y;Z\n", grid, true).warnings, doubted);
    EXPECT_THAT(read("Y;X;Z\n", grid, false).warnings, doubted) << "surveyors' X is north";
    EXPECT_THAT(read("", grid, false).warnings, Not(doubted));
    EXPECT_THAT(read("X;Y;Z\n", grid, false).warnings, Not(doubted));
    EXPECT_THAT(read("northing;easting;Z\n", grid, true).warnings, Not(doubted));
  }
  EXPECT_THAT(read("Y;X;Z\n", {0, 0}, false).warnings, Not(doubted));
}

TEST(Dialects, ARemarkBetweenRowsThatBeginsAnotherTableIsRefused) {
  const auto row = [](double x, double y, double z) { return three(",", x, y, z); };
  const std::string body = relief("", row);
  const std::string named = "# X,Y,Z\n" + body;
  expect_read(named + "# X,Y,Z\n" + body);
  expect_read(named + "# second part, from the north\n" + body);
  expect_read(body + "# X,Y,Z\n" + body);
  expect_refused("t.csv", named + "# Y,X,Z\n" + body, "names other columns than the header", 602);
  expect_refused("t.csv", "//X Y Z\n" + body + "//Y X Z\n" + body, "names other columns", 602);
  expect_refused("t.csv", body + "# Y,X,Z\n" + body, "names other columns than those that were read", 601);
  expect_refused("t.csv", "# X[m],Y[m],Z[m]\n" + body + "# X[mm],Y[mm],Z[mm]\n" + body, "another unit", 602);
  expect_refused("t.csv", "# Units: m\n" + body + "# Units: mm\n" + body, "another unit", 602);
  expect_read("# Units: m\n" + body + "# Units: metres\n" + body);
}

TEST(Dialects, UnitsOfSeveralWordsAndOfOtherRemarksAreTaken) {
  const testing::ScanFolder folder;
  const auto unit_of = [&](const std::string& remark) {
    return folder.read("t.txt", relief(remark + "\n", [](double x, double y, double z) { return three(" ", x, y, z); }))
        .unit;
  };
  for (const char* remark : {"% Units: mm", "! Units: mm", "# X Y Z in mm"})
    EXPECT_EQ(unit_of(remark), scene::LengthUnit::mm) << remark;
  for (const char* remark : {"# Units: US survey feet", "# Units: survey feet", "# units = US Survey Foot"})
    EXPECT_EQ(unit_of(remark), scene::LengthUnit::us_ft) << remark;
  EXPECT_EQ(unit_of("# Units: international feet"), scene::LengthUnit::ft);
  EXPECT_EQ(unit_of("# Units of the accuracy: US survey feet"), std::nullopt);
  EXPECT_EQ(unit_of("# X Y Z in the order of the scan"), std::nullopt);
}

TEST(Dialects, BlocksOfAsManyColumnsMayMeanOthers) {
  const testing::ScanFolder folder;
  std::string text = "600\n", normals = "600\n";
  int k = 0;
  text += relief("", [&](double x, double y, double z) {
    ++k;
    return three(" ", x, y, z) + fmt::format(" {} {} {}", k % 256, 255 - k % 256, k * 7 % 256);
  });
  normals += relief("", [&](double x, double y, double z) {
    ++k;
    const double a = 0.01 * (k % 100);
    return three(" ", x, y, z) + fmt::format(" {:.6f} {:.6f} 0.0", std::cos(a + 1.0), std::sin(a + 1.0));
  });
  const RawScan scan = folder.read("t.pts", text + normals);
  ASSERT_EQ(scan.records, 1200U);
  EXPECT_EQ(scan.rgba[1] & 0xFFFFFFU, 0x0EFD02U);
  EXPECT_EQ(scan.rgba[700], kNoColour) << "a normal is no colour";
}

TEST(Dialects, HeightsThatPointDownAreSaid) {
  const testing::ScanFolder folder;
  const auto row = [](double x, double y, double z) { return three(",", x, y, z); };
  const auto said = ::testing::Contains(::testing::HasSubstr("z points down"));
  EXPECT_THAT(folder.read("t.csv", relief("X,Y,Z (down)\n", row)).warnings, said);
  EXPECT_THAT(folder.read("t.csv", relief("X,Y,Z (up)\n", row)).warnings, ::testing::Not(said));
}
}  // namespace
}  // namespace sparsha::pipeline
