// Tables as spreadsheets, surveyors and scanners of several countries write them: never silently another column.
#include <gmock/gmock.h>

#include "pipeline/scan/formats/text/header.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using testing::error_of_bytes;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ScanFolder;

TEST(XyzReader, ReadsDecimalCommasBetweenBlanksTabsQuotesAndCommasWithBlanks) {
  const ScanFolder folder;
  for (const std::string text : {
           "1,5 2,25 -3,125\n4 5,5 6\n",
           "1,5\t2,25\t-3,125\n4\t5,5\t6\n",
           "1,5;2,25;-3,125\n4;5,5;6\n",
           "\"1,5\",\"2,25\",\"-3,125\"\n\"4\",\"5,5\",\"6\"\n",
           "1,5, 2,25, -3,125\n4, 5,5, 6\n",
       }) {
    const RawScan scan = folder.read("a.txt", text);
    EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(1.5, 2.25, -3.125), Eigen::Vector3d(4, 5.5, 6))) << text;
    EXPECT_THAT(scan.warnings, IsEmpty()) << text;
  }
}

TEST(XyzReader, KnowsDecimalCommasThoughTheFirstRowHasNone) {
  const ScanFolder folder;
  EXPECT_THAT(folder.read("a.csv", "x;y;z\n1;2;3\n4;5,25;6\n").points,
              ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5.25, 6)));
}

TEST(XyzReader, TakesCommasBetweenWholeNumbersForSeparators) {
  const ScanFolder folder;
  EXPECT_THAT(folder.read("a.csv", "1,2,3\n4,5,6\n").points,
              ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
  EXPECT_THAT(folder.read("b.txt", "1.5 2.5 3.5 255,128,0\n").points, ElementsAre(Eigen::Vector3d(1.5, 2.5, 3.5)));
}

TEST(XyzReader, RefusesSeparatorsOfThousands) {
  const auto error = error_of_bytes("a.txt", "x y z\n1,234.5 6,789.1 2,345.6\n");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->place().line, 2);
  EXPECT_THAT(error->what(), HasSubstr("a comma and a point"));
  EXPECT_TRUE(error_of_bytes("b.csv", "1.234,5;6.789,1;2.345,6\n"));
}

TEST(XyzReader, FindsCoordinatesByTheNamesThatSurveyorsOfSeveralCountriesUse) {
  const ScanFolder folder;
  for (const std::string names :
       {"Punkt;Rechtswert;Hochwert;Höhe", "Nr;Ost;Nord;Hoehe", "Nr;Rechtswert;Hochwert;H\xF6he",
        "point;est;nord;altitude", "punto;este;norte;cota", "punto;est;nord;quota", "id;X [m];Y [m];Z [m]",
        "id;x_coord;y_coord;z_coord", "time;pos_x;pos_y;pos_z", "\"Normals:0\";\"Points:0\";\"Points:1\";\"Points:2\"",
        "Pt;UTM_E;UTM_N;Elev."}) {
    const RawScan scan = folder.read("a.csv", names + "\n7;10,5;20;30\n8;11,5;21;31\n");
    EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(10.5, 20, 30), Eigen::Vector3d(11.5, 21, 31))) << names;
    EXPECT_THAT(scan.warnings, IsEmpty()) << names;
  }
}

TEST(XyzReader, SaysThatAHeaderWithoutKnownNamesIsNotUsed) {
  const ScanFolder folder;
  EXPECT_THAT(folder.read("a.csv", "foo,bar,baz,qux\n1,10,20,30\n").warnings,
              ElementsAre(HasSubstr("does not name x, y and z")));
  EXPECT_THAT(folder.read("b.txt", "# id x y\n1 10 20 30\n2 11 21 31\n").warnings, IsEmpty())
      << "a comment of another length may be any";
}

TEST(XyzReader, KnowsLongitudeAndLatitudeForDegrees) {
  const ScanFolder folder;
  const RawScan scan = folder.read("a.csv", "id,latitude,longitude,altitude\n1,50.25,7.5,30\n");
  EXPECT_TRUE(scan.degrees);
  EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(7.5, 50.25, 30)));
}

TEST(XyzReader, LeavesOutTheEmptyColumnBehindSeparatorsAtLineEnds) {
  const ScanFolder folder;
  const RawScan scan = folder.read("a.csv", "1,2,3,\n4,5,6,\n");
  EXPECT_THAT(scan.fields, ElementsAre("x", "y", "z"));
  EXPECT_TRUE(scan.intensity.empty());
  EXPECT_THAT(scan.warnings, IsEmpty());
}

TEST(XyzReader, PassesOverCommentsOfEveryKindBetweenRows) {
  const ScanFolder folder;
  EXPECT_EQ(folder.read("a.xyz", "1 2 3\n# a\n// b\n% c\n! d\n4 5 6\n").records, 2U);
}

TEST(XyzReader, NamesTheFirstLineThatIsNoRow) {
  const auto error = error_of_bytes("a.txt", "\n# notes\nThis is a readme.\n");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->place().line, 3);
  EXPECT_THAT(error->what(), HasSubstr("'This is a readme.'"));
}

TEST(HeaderNames, AreNotTakenFromALineOfMegabytes) {
  EXPECT_THAT(parse_header(std::string(1 << 20, 'a') + " b c").names, IsEmpty());
}

TEST(ParseNumber, RoundsWhatIsBelowTheSmallestDoubleToZeroAndWhatIsBeyondTheLargestToInfinity) {
  const ScanFolder folder;
  const std::string zeros(400, '0');
  const RawScan scan = folder.read("a.xyz", "0." + zeros + "1 1" + zeros + "e-400 1e-99999999999\n1e400 0 0\n1" +
                                                zeros + " 0 0\n0." + zeros + "1e9999 0 0\n");
  EXPECT_EQ(scan.records, 4U);
  EXPECT_EQ(scan.invalid, 3U) << "infinite ones";
  EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(0, 1, 0)));
}

}  // namespace
}  // namespace sparsha::pipeline
