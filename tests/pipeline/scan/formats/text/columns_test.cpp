// Which column of a text table is what: told by names, by values or by their places. Tables are written as other
// programs write them; their true points are what the test wrote.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "pipeline/scan/set.h"
#include "pipeline/scan/statistics.h"
#include "scene/config/config.h"
#include "tests/pipeline/scan/formats/text/relief_table.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::expect_refused;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(TextTable, SaysWhatToldItsColumns) {
  const RawScan by_position = read("1 2 3 10 20 30\n1 2 4 1 2 3\n");
  ASSERT_TRUE(by_position.table);
  EXPECT_EQ(by_position.table->by, TextTable::By::position);
  EXPECT_THAT(by_position.table->columns, ElementsAre("x", "y", "z", "red", "green", "blue"));
  const RawScan by_names = read("id,z,y,x\n1,2,3,4\n");
  ASSERT_TRUE(by_names.table);
  EXPECT_EQ(by_names.table->by, TextTable::By::names);
  EXPECT_THAT(by_names.table->columns, ElementsAre("skip", "z", "y", "x"));
  EXPECT_FALSE(read("v 1 2 3\nv 4 5 6\n", "a.obj").table);
}

TEST(TextTable, NamesWinOverPlacesBehindEveryCommentSignAndSeparator) {
  const Relief relief;
  for (const std::string sign : {"", "#", "# ", "//", "// ", ";", "; ", "%", "% ", "## ", "!", "* "}) {
    for (const std::string separator : {" ", "\t", ",", ", ", ";"}) {
      if (separator == ";" && sign == ";") continue;  // an empty first column
      const std::string header = sign + "Nr" + separator + "Z" + separator + "Y" + separator + "X\n";
      const RawScan scan = expect_relief(relief, relief.numbered(header, separator, "zyx"));
      EXPECT_THAT(scan.warnings, IsEmpty()) << header;
    }
  }
  expect_relief(relief, relief.numbered("# Nr, Z, Y, X\n", " ", "zyx"));  // as numpy writes it
  expect_relief(relief, relief.numbered("Survey of 12 March 2019\nby 4 people\nID X Y Z\n"));
  expect_relief(relief, relief.numbered("48\nID X Y Z\n"));
}

TEST(TextTable, NamesOfOtherProgramsAreKnown) {
  const Relief relief;
  const auto rest = [&](const std::string& before, const std::string& separator, const std::string& behind,
                        const std::string& order = "xyz") {
    return [&relief, before, separator, behind, order](std::size_t k) {
      return before + separator + relief.at(k, separator, order) + behind;
    };
  };
  const auto named = [&](const std::string& header, const Relief::Row& row) {
    const RawScan scan = expect_relief(relief, relief.table(header, row));
    EXPECT_THAT(scan.warnings, IsEmpty()) << header;
    ASSERT_TRUE(scan.table);
    EXPECT_EQ(scan.table->by, TextTable::By::names) << header;
  };
  named(
      "#CoordinateSystem: LOCAL_CS[\"Local "
      "(m)\",UNIT[\"metre\",1]]\n#Label,X/Easting,Y/Northing,Z/Altitude,Error_(m)\n",
      rest("point 7", ",", ",0.1"));                                                                // Metashape
  named("#name,x,y,alt,heading,pitch,roll\n", rest("IMG 1.JPG", ",", ",1,2,3"));                    // RealityCapture
  named("PointId;Easting;Northing;Ortho. Height;Code\n", rest("GCP 1", ";", ";wall top"));          // Leica
  named("Point ID,Northing,Easting,Elevation,Code\n", rest("TP1", ",", ",CORNER OF WALL", "yxz"));  // Trimble
  named("Row Column X Y Z R G B\n", rest("4 7", " ", " 1 2 3"));                                    // FARO
  named("Version,Slot ID,Timestamp,X,Y,Z,Reflectivity,Tag\n", rest("5,1,100", ",", ",17,0"));       // Livox
  named("\"intensity\",\"azimuth\",\"Points_m_XYZ:0\",\"Points_m_XYZ:1\",\"Points_m_XYZ:2\"\n",
        rest("3,20", ",", ""));  // VeloView
  named("\"Normals:0\",\"Normals:1\",\"Normals:2\",\"Points:0\",\"Points:1\",\"Points:2\"\n",
        rest("0,0,1", ",", ""));                                                    // ParaView
  named("fid,name,POINT_X,POINT_Y,POINT_Z\n", rest("1,\"wall, north\"", ",", ""));  // GIS
  named("#F=N X Y Z\n", rest("A1", " ", ""));                                       // MicMac
  named("TITLE = \"wall\"\nVARIABLES = \"I\", \"X\", \"Y\", \"Z\"\nZONE I=8, J=6, F=POINT\n", rest("3", " ", ""));
  named("id P[x] P[y] P[z]\n", rest("9", " ", ""));               // Houdini
  named("wall\n5\nid\nX\nY\nZ\nvalue\n", rest("17", " ", " 7"));  // GSLIB
  named("# Columns: id X Y Z\n", rest("17", " ", ""));
  named("# FIELDS id x y z\n", rest("17", " ", ""));
  named("Point No. X Y Z R G B\n", rest("17", " ", " 1 2 3"));
  named("Point Name X Y Z\n", rest("17 P1", " ", ""));
  named("Row Code X Y Z\n", rest("17 P1", " ", ""));
  named("Nr;X-Koordinate;Y-Koordinate;Z-Koordinate\n", rest("17", ";", ""));
  named("Nr;Coord. X;Coord. Y;Coord. Z\n", rest("17", ";", ""));
  named("\xEF\xBB\xBFid,x,y,z\n", rest("17", ",", ""));
  named("Nr,Code,X,Y,Z\n", rest("17,12 34", ",", ""));
  named("Nr;Rechtswert (Y);Hochwert (X);H\xC3\xB6he (Z)\n", rest("17", ";", ""));
  named("Nr;X (East);Y (North);Z (Up)\n", rest("17", ";", ""));
  named("Nr;East [X];North [Y];Up\n;;;\nNr;X_;Y_;Z_\n", rest("17", ";", ""));
}

TEST(TextTable, OfDataFramesHaveAColumnOfRowNamesWithoutAName) {
  const Relief relief;
  const auto row = [&](const std::string& open, const std::string& separator) {
    return [&relief, open, separator](std::size_t k) {
      return open + std::to_string(k) + open + separator + relief.at(k, separator);
    };
  };
  expect_relief(relief, relief.table(",x,y,z\n", row("", ",")));
  expect_relief(relief, relief.table(" x y z\n", row("", " ")));
  expect_relief(relief, relief.table("\tx\ty\tz\n", row("", "\t")));
  expect_relief(relief, relief.table("      x      y      z\n", row("", "  ")));
  expect_relief(relief, relief.table("\"x\" \"y\" \"z\"\n", row("\"", " ")));
  expect_relief(relief, relief.table("\"\",\"x\",\"y\",\"z\"\n", row("\"", ",")));
  expect_relief(relief, relief.table("\"name\" \"x\" \"y\" \"z\"\n", [&](std::size_t k) {
    return fmt::format("\"{}\" \"north wall\" {}", k + 1, relief.at(k));
  }));
}

TEST(TextTable, TakesUnitsFromNamesAndFromTheRowBelowThem) {
  const Relief relief;
  for (const std::string header :
       {"Nr X (mm) Y (mm) Z (mm)", "Nr X [mm] Y [mm] Z [mm]", "Nr x_mm y_mm z_mm", "Nr X[mm] Y[mm] Z[mm]",
        "Nr Xmm Ymm Zmm", "Nr X/mm Y/mm Z/mm", "Nr;X in mm;Y in mm;Z in mm", "Nr\tX, mm\tY, mm\tZ, mm",
        "Nr X Y Z\n- mm mm mm", "Nr;X;Y;Z\n;(mm);(mm);(mm)", "# Nr X Y Z\n# - [mm] [mm] [mm]",
        "Nr,X,Y,Z\n-,mm,mm,mm"}) {
    const std::string separator = header.find(';') != std::string::npos    ? ";"
                                  : header.find('\t') != std::string::npos ? "\t"
                                  : header.find(',') != std::string::npos  ? ","
                                                                           : " ";
    const RawScan scan = expect_relief(relief, relief.numbered(header + "\n", separator));
    ASSERT_TRUE(scan.unit) << header;
    EXPECT_EQ(*scan.unit, scene::LengthUnit::mm) << header;
    EXPECT_THAT(scan.warnings, IsEmpty()) << header;
  }
  EXPECT_EQ(read("X [US ft],Y [US ft],Z [US ft]\n1,2,3\n").unit, scene::LengthUnit::us_ft);
  EXPECT_EQ(read("Range (mm), X (m), Y (m), Z (m)\n5, 1, 2, 3\n").unit, scene::LengthUnit::m);
  EXPECT_FALSE(read("id,x,y,z\nint,float,float,float\n1,2,3,4\n").unit);
  expect_refused("a.csv", "X [m],Y [m],Z [mm]\n1,2,3\n", "x in m, y in m, z in mm", 1);
  EXPECT_THAT(read("X [in],Y [in],Z [in]\n1,2,3\n").warnings, ElementsAre(HasSubstr("'in'")));
}

TEST(TextTable, RowsMayVaryInLengthBehindTheCoordinates) {
  const Relief relief;
  const std::vector<std::string> remarks = {"", " north wall", " a \"b\" c", " top", " 1 of 2"};
  const auto remark = [&](std::size_t k) { return remarks[k % remarks.size()]; };
  const RawScan blanks = expect_relief(
      relief, relief.table("Nr X Y Z Remark\n", [&](std::size_t k) { return "7 " + relief.at(k) + remark(k); }));
  EXPECT_THAT(blanks.warnings, IsEmpty());
  expect_relief(relief, relief.table("Nr,Remark,X,Y,Z\n",
                                     [&](std::size_t k) { return "7," + remark(k) + "," + relief.at(k, ","); }));
  expect_relief(relief, relief.table("Remark\tX\tY\tZ\n",
                                     [&](std::size_t k) { return "wall" + remark(k) + "\t" + relief.at(k, "\t"); }));
  const RawScan short_rows = expect_relief(relief, relief.table("ID,X,Y,Z,R,G,B,Quality\n", [&](std::size_t k) {
    return "7," + relief.at(k, ",") + ",1,2,3";
  }));
  EXPECT_EQ(short_rows.rgba, std::vector<std::uint32_t>(relief.points.size(), 0xFF030201U));
  EXPECT_THAT(short_rows.warnings, ElementsAre(HasSubstr("8 columns, the rows have 7; x, y and z are taken from "
                                                         "columns 2, 3 and 4")));
  const RawScan some_colours = expect_relief(relief, relief.table("ID X Y Z R G B\n", [&](std::size_t k) {
    return "7 " + relief.at(k) + (k % 2 == 0 ? " 1 2 3" : "");
  }));
  EXPECT_EQ(some_colours.rgba[0], 0xFF030201U);
  EXPECT_THAT(some_colours.warnings, ElementsAre(HasSubstr("24 of 48 points have no colour")));
  expect_refused("a.txt", "ID X Y Z\n1 2 3 4\n1 2 3\n", "a row of 3 values; at least 4", 3);
}

TEST(TextTable, NamesWithBlanksBeforeTheCoordinatesAreRefusedWhereBlanksPartColumns) {
  const Relief relief;
  const std::string text = relief.table(
      "Name X Y Z\n", [&](std::size_t k) { return fmt::format("wall {} {}", relief.ids[k], relief.at(k)); });
  expect_refused("a.txt", text, "names in them may hold blanks", 1);
}

/// Rows of COLMAP's points3D.txt; tracks of `k` are of many lengths.
std::string colmap(const Relief& relief, const std::string& header) {
  return relief.table(header, [&](std::size_t k) {
    std::string row = fmt::format("{} {} 1 2 3 0.71", relief.ids[k] * 31, relief.at(k));
    for (std::size_t n = 0; n < 2 + k % 40; ++n) row += fmt::format(" {} {}", n + 1, 17 * n);
    return row;
  });
}

TEST(TextTable, OfColmapHasItsPointsInColumnsTwoToFour) {
  const Relief relief;
  const std::string header =
      "# 3D point list with one line of data per point:\n"
      "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n"
      "# Number of points: 48, mean track length: 3.5\n";
  const RawScan named = expect_relief(relief, colmap(relief, header));
  EXPECT_EQ(named.rgba, std::vector<std::uint32_t>(relief.points.size(), 0xFF030201U));
  EXPECT_THAT(named.warnings, IsEmpty());
  const RawScan unnamed = expect_relief(relief, colmap(relief, ""));
  EXPECT_EQ(unnamed.rgba, named.rgba);
  EXPECT_EQ(unnamed.table->by, TextTable::By::shape);
  EXPECT_THAT(unnamed.warnings, ElementsAre(HasSubstr("points3D.txt")));
}

TEST(TextTable, OfColmapTellsHowManyPicturesShowAPoint) {
  const Relief relief;
  // The rows that are looked at first are alike; later ones are longer, up to more values than a row keeps.
  std::string text = "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
  const auto track = [](std::size_t n) { return n < 1100 ? 2 : 2 + n % 40; };
  for (std::size_t n = 0; n < 1400; ++n) {
    text += fmt::format("{} {} 1 2 3 0.71", n + 1, relief.at(n % relief.points.size()));
    for (std::size_t k = 0; k < track(n); ++k) text += fmt::format(" {} {}", k + 1, 17 * k);
    text += '\n';
  }
  ReadOptions options;
  options.fields = {"error", "track_length"};
  for (const bool named : {true, false}) {
    const RawScan scan = read_scan_bytes(named ? text : text.substr(text.find('\n') + 1), "points3D.txt", options);
    ASSERT_EQ(scan.points.size(), 1400U);
    if (!named) continue;  // the first rows do not tell
    EXPECT_THAT(scan.warnings, IsEmpty());
    EXPECT_THAT(scan.notes, ElementsAre(HasSubstr("COLMAP")));
    for (std::size_t n = 0; n < 1400; ++n) {
      ASSERT_EQ(scan.values[0][n], 0.71F);
      ASSERT_EQ(scan.values[1][n], static_cast<float>(track(n))) << n;
    }
  }
  const RawScan unnamed = read_scan_bytes(colmap(relief, ""), "points3D.txt", options);
  EXPECT_EQ(unnamed.values[1][47], static_cast<float>(2 + 47 % 40));
}

TEST(TextTable, OfAFlatWallHasItsNormalsBehindColours) {
  std::string text;
  for (int k = 0; k < 100; ++k) text += fmt::format("{} {} 0.0 10 {} 30 0.000 0.100 0.995\n", 0.1 * k, 0.2 * k, k % 7);
  const RawScan scan = read(text);
  EXPECT_THAT(scan.fields, ElementsAre("x", "y", "z", "red", "green", "blue", "nx", "ny", "nz"));
  ASSERT_EQ(scan.normals.size(), 100U);
  EXPECT_EQ(scan.normals[5], Eigen::Vector3f(0.0F, 0.1F, 0.995F));
}

TEST(TextTable, WhoseFirstColumnCountsAllRowsHasItsPointsBehindIt) {
  const Relief relief;
  const auto counted = [&](const std::string& separator, const std::string& behind) {
    return relief.table("", [&relief, separator, behind](std::size_t k) {
      return std::to_string(k + 500) + separator + relief.at(k, separator) + behind;
    });
  };
  for (const std::string behind : {"", " WALL", " 1 2 3"}) {
    const RawScan scan = expect_relief(relief, counted(" ", behind));
    EXPECT_THAT(scan.warnings, ElementsAre(AllOf(HasSubstr("counts the rows"), HasSubstr("'columns'"))));
    EXPECT_EQ(scan.table->by, TextTable::By::shape);
    EXPECT_EQ(scan.rgba.empty(), behind != " 1 2 3");
  }
  expect_relief(relief, counted(",", ",1,2,3"));
  // With other columns behind it nobody knows which are which.
  EXPECT_EQ(read(counted(" ", " 5")).table->by, TextTable::By::position);
  // One row far down tells that the numbers count nothing.
  std::string long_table;
  for (int k = 0; k < 3000; ++k)
    long_table += fmt::format("{} {} {} 0.5\n", k == 2500 ? 7 : k, k % 50 * 0.1, k / 50 * 0.1);
  const RawScan scan = read(long_table);
  EXPECT_EQ(scan.table->by, TextTable::By::position);
  EXPECT_EQ(scan.points[10].x(), 10.0);
  // A grid whose x are whole numbers begins anew in every line.
  std::string grid;
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 20; ++i) grid += fmt::format("{} {} {} 0.5\n", i, j, (i * j) % 7);
  EXPECT_EQ(read(grid).table->by, TextTable::By::position);
}

TEST(TextTable, CommentsInSentencesNameNoColumns) {
  const Relief relief;
  for (const std::string comment : {"# This file has x, y, z in metres and the intensity\n",
                                    "# exported with x y z by hand\n", "# x y z of the wall are in the file\n"}) {
    expect_relief(relief, relief.table(comment, [&](std::size_t k) { return relief.at(k) + " 5"; }));
  }
  EXPECT_THAT(read("alpha,beta,gamma\n1,2,3\n").warnings, ElementsAre(HasSubstr("does not name x, y and z once each")));
  EXPECT_THAT(read("O.5 1 2\n1 2 3\n").warnings, ElementsAre(HasSubstr("line 1 begins with a word")));
}

TEST(TextTable, OfJoinedFilesMayHaveItsHeaderAgain) {
  const Relief relief;
  const std::string text = relief.numbered("Nr,X,Y,Z\n", ",");
  const RawScan scan = read(text + text, "a.csv");
  EXPECT_EQ(scan.points.size(), 2 * relief.points.size());
  expect_refused("a.csv", text + "Nr,Y,X,Z\n" + text, "is not a row of numbers", 50);
}

TEST(TextTable, SaysWhatItTookForXYAndZ) {
  const RawScan survey = read("Code,Elevation,Northing,Easting\n7,3,2,1\n");
  EXPECT_THAT(survey.points, ElementsAre(Eigen::Vector3d(1, 2, 3)));
  EXPECT_THAT(survey.fields, ElementsAre("code", "elevation (z)", "northing (y)", "easting (x)"));
  EXPECT_THAT(survey.warnings, IsEmpty());
  const RawScan initials = read("Pt,N,E,H\n7,2,1,3\n");
  EXPECT_THAT(initials.points, ElementsAre(Eigen::Vector3d(1, 2, 3)));
  EXPECT_THAT(initials.warnings, ElementsAre(HasSubstr("'e', 'n' and 'h'")));
  EXPECT_TRUE(read("#Label,X/Longitude,Y/Latitude,Z/Altitude\nA,12.5,41.9,50\n").degrees);
  EXPECT_TRUE(read("x [deg],y [deg],z [m]\n12.5,41.9,50\n").degrees);
  expect_refused("a.csv", "x,y,z,x\n1,2,3,4\n", "a coordinate twice", 1);
}

TEST(TextTable, HearsWhichAxisItsHeaderCallsNorth) {
  for (const char* const names :
       {"X(North),Y(East),Z", "X_North,Y_East,Z_Up", "X (Northing) [m],Y (Easting) [m],Z [m]", "X/Northing,Y/Easting,Z",
        "X(N),Y(E),Z(H)", "XNorthing,YEasting,ZHeight", "North_X,East_Y,Z", "x (Hochwert),y (Rechtswert),z",
        "X north [m],Y east [m],Z [m]", "X (north),Y,Z", "X,Y (east),Z"}) {
    const RawScan scan = read(names + std::string("\n2,1,3\n20,10,30\n"));
    EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(10, 20, 30))) << names;
    EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("which of its x and y is north"))) << names;
    EXPECT_EQ(scan.unit.has_value(), std::string_view(names).find("[m]") != std::string_view::npos) << names;
  }
  EXPECT_THAT(read("X (North) [m] Y (East) [m] Z [m]\n2 1 3\n20 10 30\n").points,
              ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(10, 20, 30)));
  for (const char* const names :
       {"X(East),Y(North),Z", "X_East,Y_North,Z_Up", "X (Easting) [m],Y (Northing) [m],Z [m]", "X/Easting,Y/Northing,Z",
        "X(E),Y(N),Z(H)", "X (east),Y,Z", "X,Y (north),Z", "X (north),Y (north),Z", "X,Y,Z"}) {
    const RawScan scan = read(names + std::string("\n1,2,3\n10,20,30\n"));
    EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(10, 20, 30))) << names;
    EXPECT_THAT(scan.warnings, IsEmpty()) << names;
  }
  const RawScan normals = read("x,y,z,n_x,n_y,n_z\n1,2,3,0,0,1\n10,20,30,0,1,0\n");
  EXPECT_THAT(normals.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(10, 20, 30)));
  EXPECT_TRUE(read("X (latitude),Y (longitude),Z\n41.9,12.5,50\n").degrees);
  // Words that are others': estimated, a length, and columns beside the plain ones.
  for (const char* const names : {"x,y (est),z", "x_long,y_lat,z", "x [long],y [lat],z"}) {
    const RawScan scan = read(names + std::string("\n1,2,3\n10,20,30\n"));
    EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(10, 20, 30))) << names;
    EXPECT_FALSE(scan.degrees) << names;
  }
  for (const char* const names : {"upx,upy,upz,x,y,z", "alt_x,alt_y,0,x,y,z", "north_x,north_y,north_z,x,y,z"}) {
    const RawScan scan = read(names + std::string("\n0,0,1,1,2,3\n0,1,0,10,20,30\n"));
    EXPECT_THAT(scan.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(10, 20, 30))) << names;
  }
}

TEST(TextTable, WithCoordinatesBehindMoreColumnsThanARowMayHaveIsRefused) {
  std::string names;
  std::string row;
  for (int k = 0; k < 64; ++k) {
    names += "f" + std::to_string(k) + ",";
    row += "1,";
  }
  expect_refused("a.csv", names + "x,y,z\n" + row + "1,2,3\n", "behind too many columns", 1);
  EXPECT_THAT(read(names.substr(0, names.size() - 12) + "x,y,z,f\n" + row + "1\n").points.size(), 1U);
  ReadOptions options;
  options.columns.assign(65, "skip");
  for (std::size_t k = 0; k < 3; ++k) options.columns[62 + k] = std::string(1, "xyz"[k]);
  EXPECT_THROW((void)read(row + "1,2,3\n", "a.csv", options), Error);
}

TEST(TextTable, OfCommasAloneThatMayBeDecimalIsRefused) {
  const Relief relief;
  const auto decimal = [](std::string text) {
    std::replace(text.begin(), text.end(), '.', ',');
    return text;
  };
  const auto refuse = [&](const std::string& header, const Relief::Row& row, int line) {
    const std::string text = header + decimal(relief.table("", row));
    expect_refused("a.csv", text, "nobody can tell", line);
  };
  refuse(
      "", [&](std::size_t k) { return relief.at(k, ","); }, 1);
  refuse(
      "X,Y,Z\n", [&](std::size_t k) { return relief.at(k, ","); }, 2);
  refuse(
      "", [&](std::size_t k) { return std::to_string(k) + "," + relief.at(k, ",") + ",WALL"; }, 1);
  refuse(
      "",
      [&](std::size_t k) {  // decimals of any length, or none
        std::string text;
        for (const std::string& value : relief.texts[k]) {
          text += (text.empty() ? "" : ",") + fmt::format("{}", std::stod(value));
        }
        return text;
      },
      1);
  // Whole numbers with colours, and quoted decimals, are what they are.
  EXPECT_EQ(read("120,340,-5,255,0,10\n121,340,-4,25,100,9\n").points.size(), 2U);
  expect_relief(relief, "\"X\",\"Y\",\"Z\"\n" + relief.table("", [&](std::size_t k) {
    return decimal(fmt::format("\"{}\",\"{}\"", relief.texts[k][0], relief.texts[k][1])) + ",\"" +
           decimal(relief.texts[k][2]) + "\"";
  }));
  expect_relief(relief, "X\tY\tZ\tRemark\n" + relief.table("", [&](std::size_t k) {
    return decimal(relief.at(k, "\t")) + "\tleft, upper wall";
  }));
}

TEST(TextTable, NumbersOfOtherLanguagesAreRefusedAtTheirLine) {
  expect_refused("a.txt",
                 "X\tY\tZ\n412\xC2\xA0"
                 "345,00\t5\xC2\xA0"
                 "654\xC2\xA0"
                 "321,00\t100,00\n",
                 "is not a number", 2);
  expect_refused("a.csv", "X;Y;Z\n412.345,0000;5.654.321,0000;100,0000\n", "'412.345,0000' is not a number", 2);
  expect_refused("a.txt",
                 "0.0 0.0 \xE2\x88\x92"
                 "0.1\n",
                 "is not a number", 1);
  expect_refused("a.txt", "0.0|0.0|0.1\n0.1|0.0|0.1\n", "stand between bars", 1);
}

TEST(TextTable, HeightsThatStandForNoDataAreInvalid) {
  const Relief relief;
  const auto is_hole = [](std::size_t k) { return k >= 20 && k < 26; };
  std::vector<Eigen::Vector3d> rest;
  for (std::size_t k = 0; k < relief.points.size(); ++k)
    if (!is_hole(k)) rest.push_back(relief.points[k]);
  for (const std::string value :
       {"-9999", "-9999.0000", "-99999", "1.70141E+38", "1.70141e+038", "-3.4028234663852886e+38", "-32768", "9999"}) {
    const RawScan scan = read(relief.table(
        "", [&](std::size_t k) { return relief.at(k, " ", "xy") + " " + (is_hole(k) ? value : relief.texts[k][2]); }));
    EXPECT_EQ(scan.points, rest) << value;
    EXPECT_EQ(scan.invalid, 6U);
    EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("6 of 48 points have the no-data value"))) << value;
  }
  // Heights about such a value are heights, and two of it are no bulk.
  EXPECT_EQ(read("0 0 -9999\n1 0 -9999\n2 0 -9999\n0 1 -9990\n1 1 -9995\n2 1 -9998\n").invalid, 0U);
  EXPECT_EQ(read("0 0 -9999\n1 0 -9999\n0 1 1\n1 1 2\n2 1 3\n").invalid, 0U);
  EXPECT_EQ(read("x,y,z\n1,2,NA\n1,2,3\n1,3,null\n").invalid, 2U);
}

TEST(TextTable, TablesOfThreeAndSixValuesMayBeJoined) {
  std::string first, second;
  for (int k = 0; k < 300; ++k) first += fmt::format("{:.3f} {:.3f} 0.5\n", 0.01 * (k % 30), 0.01 * (k / 30));
  for (int k = 0; k < 400; ++k) second += fmt::format("{:.3f} {:.3f} 0.7 10 20 30\n", 0.01 * (k % 30), 0.01 * (k / 30));
  for (const std::string& text : {first + second, "# scan 1\n" + first + "# scan 2\n" + second}) {
    const RawScan scan = read(text);
    ASSERT_EQ(scan.points.size(), 700U);
    EXPECT_EQ(scan.points[300], Eigen::Vector3d(0.0, 0.0, 0.7));
    EXPECT_EQ(scan.rgba.at(0), kNoColour);
    EXPECT_EQ(scan.rgba.at(300), 0xFF1E140AU);
  }
}

}  // namespace
}  // namespace sparsha::pipeline
