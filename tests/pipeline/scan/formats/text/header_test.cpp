// Tables as spreadsheets, surveyors and scanners of several countries write them: never silently another column.
#include <gmock/gmock.h>

#include "pipeline/scan/formats/text/header.h"
#include "pipeline/scan/writer.h"
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

TEST(XyzReader, NamesOfSurveysMayTellTheirSystemAndLatitudesTheirUnit) {
  const ScanFolder folder;
  const RawScan survey =
      folder.read("a.csv", "Name,Grid Northing (m),Grid Easting (m),Elevation (m),Code\nA,20,10,30,c\nB,21,11,31,c\n");
  EXPECT_THAT(survey.points, ElementsAre(Eigen::Vector3d(10, 20, 30), Eigen::Vector3d(11, 21, 31)));
  EXPECT_EQ(survey.unit, scene::LengthUnit::m);
  EXPECT_TRUE(folder.read("b.csv", "lat_deg,lon_deg,alt_m\n48.1,11.5,500\n48.2,11.6,501\n").degrees);
  EXPECT_THAT(folder.read("c.csv", "%time,seq,field.x,field.y,field.z\n7,1,10,20,30\n").points,
              ElementsAre(Eigen::Vector3d(10, 20, 30)));
}

TEST(XyzReader, SeveralSetsOfCoordinatesAreSaidUnlessOneIsPlain) {
  const ScanFolder folder;
  const RawScan two = folder.read("a.csv", "x_local,y_local,z_local,x_world,y_world,z_world\n1,2,3,10,20,30\n");
  EXPECT_THAT(two.points, ElementsAre(Eigen::Vector3d(1, 2, 3)));
  EXPECT_THAT(two.warnings, Contains(HasSubstr("several sets of coordinates; columns 1, 2 and 3 are taken")));
  EXPECT_THAT(folder.read("b.csv", "x_local,y_local,z_local,x,y,z\n1,2,3,10,20,30\n").warnings, IsEmpty());
}

TEST(XyzReader, AHeaderThatNamesAnglesOrNoHeightIsRefused) {
  for (const auto& [names, part] : {std::pair{"Range[m],Theta[deg],Phi[deg]", "angles 'theta', 'phi'"},
                                    {"Hz,V,SD", "angles 'hz', 'v'"},
                                    {"range,azimuth,elevation", "angles 'azimuth', 'elevation'"},
                                    {"rho,alpha,beta", "angles 'alpha', 'beta'"},
                                    {"pan,tilt,d", "angles 'pan', 'tilt'"},
                                    {"HA,VA,SD", "angles 'ha', 'va'"},
                                    {"azimuth_deg,sphericalElevationAngle,rho", "angles 'azimuth_deg'"},
                                    {"x,y,intensity", "no z, but 'intensity'"},
                                    {"id,x,y,red,green", "no z, but 'id'"}}) {
    const auto error = error_of_bytes("a.csv", std::string(names) + "\n1,2,3\n4,5,6\n");
    const std::string wide = std::string(names) + "\n1,2,3,4,5\n4,5,6,7,8\n";
    const auto again = error ? error : error_of_bytes("a.csv", wide);
    ASSERT_TRUE(again) << names;
    EXPECT_EQ(again->place().line, 1) << names;
    EXPECT_THAT(again->wrong(), HasSubstr(part));
  }
}

TEST(XyzReader, AnglesDistancesAndIndicesBesidePlacesAreNoPlaces) {
  const ScanFolder folder;
  for (const char* names :
       {"x,y,elevation,range,azimuth", "x,y,elevation,depth,v", "easting,northing,elevation,hz,v", "x,y,depth,u,v",
        "x,y,value,level,a", "x,y,elevation,z0,a", "easting,northing,Z_AHD,x0,y0"}) {
    const RawScan scan = folder.read("a.csv", std::string(names) + "\n1,2,3,4,5\n6,7,8,9,10\n");
    EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(6, 7, 8))) << names;
  }
}

TEST(XyzReader, NumbersOfRowsBeforeAnglesDoNotMakeThemCoordinates) {
  const auto error =
      error_of_bytes("a.csv", "Nr;Hz[gon];V[gon];SD[m]\n1;2.5;100.25;2.5\n2;3.5;100.5;2.5\n3;4.5;99.5;2\n");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->place().line, 1);
  EXPECT_THAT(error->wrong(), HasSubstr("angles 'hz', 'v'"));
}

TEST(XyzReader, TheFirstOfSeveralReturnsAndMembersOfMessagesAreCoordinates) {
  const ScanFolder folder;
  const RawScan returns = folder.read("a.csv",
                                      "# TIME (ns), ROW, X1 (m), Y1 (m), Z1 (m), X2 (m), Y2 (m), Z2 (m)\n"
                                      "7, 0, 1, 2, 3, 10, 20, 30\n8, 1, 4, 5, 6, 40, 50, 60\n");
  EXPECT_THAT(returns.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
  EXPECT_EQ(returns.unit, scene::LengthUnit::m);
  EXPECT_THAT(returns.warnings, Contains(HasSubstr("several sets of coordinates; columns 3, 4 and 5 are taken")));
  EXPECT_THAT(folder
                  .read("b.csv",
                        "%time,field.normal.x,field.normal.y,field.normal.z,field.points0.x,"
                        "field.points0.y,field.points0.z\n7,0,0,1,10,20,30\n8,0,0,1,11,21,31\n")
                  .points,
              ElementsAre(Eigen::Vector3d(10, 20, 30), Eigen::Vector3d(11, 21, 31)));
}

TEST(XyzReader, NorthBeforeEastIsKnownWithEveryNameOfAHeight) {
  const ScanFolder folder;
  for (const char* names : {"id,north,east,up", "Nr;Hochwert;Rechtswert;Ortho", "Pt,Northing,Easting,Level",
                            "pt;nord;est;quota slm", "id;N_UTM;E_UTM;Z_ort"}) {
    const bool semicolons = std::string(names).find(';') != std::string::npos;
    const std::string rows = semicolons ? "\n1;20;10;30\n2;21;11;31\n" : "\n1,20,10,30\n2,21,11,31\n";
    EXPECT_THAT(folder.read("a.csv", names + rows).points,
                ElementsAre(Eigen::Vector3d(10, 20, 30), Eigen::Vector3d(11, 21, 31)))
        << names;
  }
}

TEST(XyzReader, TheUnitOfARemarkAboveTheRowsIsTakenOrSaid) {
  const ScanFolder folder;
  const std::string rows = "x y z\n1 2 3\n4 5 6\n";
  for (const auto& [remark, unit] : {std::pair{"# Units: mm", scene::LengthUnit::mm},
                                     {"// all units are in centimetres", scene::LengthUnit::cm},
                                     {"Coordinate unit = m", scene::LengthUnit::m}}) {
    const RawScan scan = folder.read("a.txt", remark + ("\n" + rows));
    EXPECT_EQ(scan.unit, unit) << remark;
    EXPECT_THAT(scan.notes, Contains(HasSubstr("a remark on line 1"))) << remark;
  }
  const RawScan inches = folder.read("b.txt", "# made by hand\n# Units: inches\n" + rows);
  EXPECT_EQ(inches.unit, std::nullopt);
  EXPECT_THAT(inches.warnings, Contains(HasSubstr("line 2 gives the coordinates in 'inches'")));
  EXPECT_EQ(folder.read("c.txt", "# Units: mm\nx[m] y[m] z[m]\n1 2 3\n4 5 6\n").unit, scene::LengthUnit::m)
      << "the names of the columns say it last";
  EXPECT_EQ(folder.read("d.txt", "# survey of unit mm-7 of the hall\n" + rows).unit, std::nullopt);
  for (const char* other :
       {"# Accuracy unit: mm", "# RMS error [unit: mm]", "# pixel size unit = mm", "# Sensor unit: FT",
        "# object unit_mm", "# vertical units: m", "# units in", "# Wavelength unit: nm", "# trench B, unit IN",
        "# Grid spacing unit: cm", "# units: mm\n# all units: m"}) {
    const RawScan scan = folder.read("e.txt", other + ("\n" + rows));
    EXPECT_EQ(scan.unit, std::nullopt) << other;
    EXPECT_THAT(scan.warnings, IsEmpty()) << other;
  }
  EXPECT_EQ(folder.read("f.csv", "x,y,z,error (unit: mm)\n1,2,3,4\n4,5,6,7\n").unit, std::nullopt);
  EXPECT_EQ(folder.read("g.txt", "# intensity units: um\n# units: m\n" + rows).unit, scene::LengthUnit::m);
}

TEST(XyzReader, ColoursThatAreNotReadOrMayBeOthersAreSaid) {
  const ScanFolder folder;
  const RawScan packed = folder.read("a.txt", "x y z rgb\n1 2 3 65279\n4 5 6 655366\n");
  EXPECT_TRUE(packed.rgba.empty());
  EXPECT_THAT(packed.warnings, Contains(HasSubstr("in one column, 'rgb', and are not read")));
  const RawScan either = folder.read("b.asc", "1.5,2,3,195,0,254,255\n4,5.5,6,255,10,0,6\n4,6,6,7,8,0,9\n");
  EXPECT_THAT(either.notes, Contains(HasSubstr("columns 4 to 6 are taken as red, green and blue")));
  EXPECT_THAT(either.warnings, IsEmpty());
  const RawScan clear = folder.read("c.asc", "1.5,2,3,195,0,254,2550\n4,5.5,6,255,10,0,6\n4,6,6,7,8,0,9\n");
  EXPECT_THAT(clear.warnings, IsEmpty());
}

TEST(XyzReader, GroupsOfThousandsBetweenQuotesAreRefused) {
  const auto error =
      error_of_bytes("a.csv", "X,Y,Z\n\"1,999.36\",\"2,997.67\",\"-0.56\"\n\"2,012.92\",\"3,000.85\",\"10.94\"\n");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->place().line, 2);
  EXPECT_THAT(error->what(), HasSubstr("separators of thousands"));
}

TEST(XyzReader, GroupsOfThousandsInAnotherColumnRefuseNothing) {
  const ScanFolder folder;
  EXPECT_THAT(folder.read("a.csv", "parcel,area,x,y,z\n7,\"1,234.5\",1,2,3\n8,\"2,345.5\",4,5,6\n").points,
              ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
}

TEST(XyzReader, GroupsOfThousandsBetweenTabsAreRefused) {
  const auto error = error_of_bytes("a.txt", "X\tY\tZ\n4,501,066.72\t4,502,052.85\t500.25\n");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->place().line, 2);
  EXPECT_THAT(error->what(), HasSubstr("separators of thousands"));
}

TEST(XyzReader, LinesMayEndAsConversionsOfConversionsLeaveThem) {
  const ScanFolder folder;
  for (const std::string end : {"\r\n", "\r\r\n", "\n\r", "\r"}) {
    const RawScan scan = folder.read("a.csv", "x,y,z" + end + "1,2,3" + end + "4,5,6" + end);
    EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
  }
}

TEST(XyzReader, WhatProgramsWriteForNoNumberIsInvalid) {
  const ScanFolder folder;
  for (const std::string word :
       {"-",       "--", "*",  "?",       "n.a.", "NULL",      "<null>", "\\N",  "NoData", "#VALUE!", "N/A",
        "missing", ".",  "..", "Missing", "None", "UNDEFINED", "nil",    "void", "#NAME?", "n.d."}) {
    const RawScan named = folder.read("a.csv", "x,y,z\n1,2,3\n4,5," + word + "\n7,8,9\n");
    EXPECT_EQ(named.points.size(), 2U) << word;
    EXPECT_EQ(named.invalid, 1U) << word;
    EXPECT_EQ(folder.read("b.txt", "1 2 3\n4 5 " + word + "\n7 8 9\n").invalid, 1U) << word;
  }
}

TEST(XyzReader, WordsForNoNumberMayHaveABlankBetweenSeparators) {
  const ScanFolder folder;
  EXPECT_EQ(folder.read("a.csv", "x,y,z\n1,2,3\n4,5,No Data\n7,8,9\n").invalid, 1U);
}

TEST(XyzReader, JoinedTablesKeepTheirOwnColumns) {
  const ScanFolder folder;
  std::string grey;
  std::string coloured;
  for (int k = 0; k < 1500; ++k) {
    const std::string place = std::to_string(0.01 * (k % 40)) + " " + std::to_string(0.01 * (k / 40)) + " 0.125";
    grey += place + "\n";
    coloured += place + " 200 40 60\n";
  }
  const RawScan behind = folder.read("a.txt", grey + coloured);
  ASSERT_EQ(behind.points.size(), 3000U);
  ASSERT_EQ(behind.rgba.size(), 3000U);
  EXPECT_EQ(behind.rgba[1499], kNoColour);
  EXPECT_EQ(behind.rgba[1500], pack_rgba(200, 40, 60));
  EXPECT_THAT(behind.warnings, Contains(HasSubstr("changes at line 1501, from 3 to 6")));
  const RawScan before = folder.read("b.xyz", coloured + grey + coloured);
  ASSERT_EQ(before.points.size(), 4500U);
  EXPECT_EQ(before.rgba[1499], pack_rgba(200, 40, 60));
  EXPECT_EQ(before.rgba[1500], kNoColour);
  EXPECT_EQ(before.rgba[4499], pack_rgba(200, 40, 60));
  EXPECT_THAT(before.warnings, Contains(HasSubstr("and 1 times more")));
  EXPECT_TRUE(error_of_bytes("c.txt", coloured + "1 2 3\n")) << "a row that is cut off is no block";
}

TEST(XyzReader, AMatrixOfHeightsIsNoTableOfPoints) {
  std::string matrix;
  for (int j = 0; j < 6; ++j) {
    for (int i = 0; i < 40; ++i)
      matrix += (i > 0 ? "," : "") + std::to_string(0.5 + 0.001 * (i - 20) * (i - 20) - 0.02 * j);
    matrix += "\n";
  }
  const auto error = error_of_bytes("a.csv", matrix);
  ASSERT_TRUE(error);
  EXPECT_THAT(error->wrong(), HasSubstr("rows of 40 numbers that go on from one to the next are a matrix of heights"));
  EXPECT_THAT(error->expected(), HasSubstr("'ncols'"));
  const ScanFolder folder;
  const std::string zeros = " 0 1 0 0 1 0 0 0 1 0 0 0 1 0 0 0 1 0 0 0 1";
  std::string points;
  for (int k = 0; k < 9; ++k) {
    points += std::to_string(0.1 * k) + " " + std::to_string(0.2 * (k % 3)) + " 0.01 0 0 1 200 100 50 0.7\n";
  }
  EXPECT_EQ(folder.read("b.txt", points).points.size(), 9U);
  std::string survey;  // a step alone is large
  for (int k = 0; k < 9; ++k)
    survey += std::to_string(4000 + k) + " " + std::to_string(5000 + k % 3) + " 12" + zeros + "\n";
  EXPECT_EQ(folder.read("c.txt", survey).points.size(), 9U);
}

/// Rows of `before`, then x, y and z with decimals.
template <typename Before>
std::string table_of(const Before& before) {
  std::string text;
  for (int k = 0; k < 120; ++k) {
    text += before(k) + " " + std::to_string(0.013 * (k * 7 % 31) - 0.01) + " " + std::to_string(0.017 * (k * 5 % 23)) +
            " " + std::to_string(0.011 * (k * 3 % 17) - 0.05) + "\n";
  }
  return text;
}

TEST(XyzReader, WholeNumbersBeforeFractionsAreDoubtedUnlessTheyAreARastersOrALines) {
  const ScanFolder folder;
  const auto word = [](int number) { return std::to_string(number); };
  const auto said = [](const char* columns) { return HasSubstr(std::string("'columns: [") + columns + ", y, z]'"); };
  EXPECT_THAT(folder.read("class.txt", table_of([&](int k) { return word(k * 7 % 3); })).warnings,
              Contains(said("skip, x")));
  EXPECT_THAT(folder.read("place.txt", table_of([&](int k) { return word(k / 9) + " " + word(k % 9); })).warnings,
              Contains(said("skip, skip, x")));
  const auto colour = [&](int k) { return word(k * 37 % 256) + " " + word(k * 11 % 256) + " " + word(k * 91 % 256); };
  EXPECT_THAT(folder.read("colour.txt", table_of(colour)).warnings, Contains(said("red, green, blue, x")));
  EXPECT_THAT(folder.read("lines.txt", table_of([&](int k) { return word(k / 12); })).warnings,
              ::testing::Not(Contains(HasSubstr("whole numbers and the three behind"))));
  std::string normals;
  for (int k = 0; k < 120; ++k) {
    normals +=
        word(k % 11) + " " + word(k / 11) + " " + word(k * k % 7) + (k % 2 == 0 ? " 0.6 0.0 0.8\n" : " -0.6 0.0 0.8\n");
  }
  EXPECT_THAT(folder.read("normals.txt", normals).warnings, ::testing::Not(Contains(HasSubstr("whole numbers"))));
}

TEST(HeaderNames, OfColmapEndWithTheTrack) {
  const TableHeader header =
      parse_header("#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)");
  ASSERT_EQ(header.names.size(), 9U);
  EXPECT_EQ(header.names.back(), "track");
  EXPECT_EQ(parse_header("(x, y, z)").names.size(), 3U);
}

}  // namespace
}  // namespace sparsha::pipeline
