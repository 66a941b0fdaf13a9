// Files that are no scan are refused by the name of their kind, whatever their own name ends with.
#include <gmock/gmock.h>

#include <array>
#include <string>
#include <vector>

#include "pipeline/scan/foreign_text.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using namespace std::string_view_literals;
using testing::error_of_bytes;
using ::testing::HasSubstr;
using testing::put;
using testing::ScanFolder;

constexpr std::array kEndings{"ply", "pcd", "obj", "off", "stl", "xyz", "txt", "asc", "csv",
                              "pts", "ptx", "las", "laz", "e57", "grd", "bin", ""};

/// With every ending, behind blank lines and behind a byte order mark where the kind is text.
void expect_named(std::string_view bytes, const char* name, bool is_text = false) {
  for (const char* ending : kEndings) {
    std::vector<std::string> variants{std::string(bytes)};
    if (is_text) {
      variants.push_back("\xEF\xBB\xBF" + variants[0]);
      variants.push_back("\r\n" + variants[0]);
    }
    for (const std::string& variant : variants) {
      const auto error = error_of_bytes(std::string("scan.") + ending, variant);
      ASSERT_TRUE(error) << name << " as ." << ending;
      EXPECT_THAT(error->wrong(), HasSubstr(name)) << "as ." << ending;
      EXPECT_FALSE(error->expected().empty()) << name;
      EXPECT_EQ(error->kind(), ErrorKind::input);
    }
  }
}

TEST(ForeignFiles, AStandInForAFileIsNamed) {
  expect_named("version https://git-lfs.github.com/spec/v1\noid sha256:01\nsize 61093\n", "a Git LFS pointer", true);
  expect_named("version https://git-lfs.github.com/spec/v1\r\noid sha256:01\r\nsize 61093\r\n", "a Git LFS pointer");
  expect_named("/annex/objects/SHA256E-s61093--01.ply\n", "a git-annex pointer");
  expect_named("../.git/annex/objects/xX/SHA256E-s61093--01.ply", "a git-annex pointer");
  expect_named("[InternetShortcut]\nURL=https://example.org/scan.ply\n", "a link to a page", true);
  expect_named("\0\x05\x16\x07\0\x02\0\0Mac OS X"sv, "what macOS keeps beside a file");
  expect_named("L\0\0\0\x01\x14\x02\0\0\0\0\0\xC0"sv, "a Windows shortcut");
  expect_named("404: Not Found", "no such file", true);
  expect_named("HTTP/1.1 403 Forbidden\r\nContent-Length: 0\r\n\r\n", "the answer of a server", true);
  expect_named(std::string(5000, '\0'), "empty but for zeros");
}

TEST(ForeignFiles, PagesAndOtherMarkupAreNamed) {
  expect_named("<!DOCTYPE html>\n<html><body>1 2 3</body></html>\n", "a page of HTML", true);
  expect_named("<HTML lang=\"en\"><HEAD></HEAD></HTML>", "a page of HTML", true);
  expect_named("<!-- saved from url -->\n<html>\n</html>\n", "a page of HTML", true);
  expect_named("<?xml version=\"1.0\"?>\n<Error><Code>AccessDenied</Code></Error>", "a server's message", true);
  expect_named("<?xml version=\"1.0\"?>\n<!DOCTYPE X3D PUBLIC \"x\" \"y\">\n<X3D></X3D>\n", "an X3D scene", true);
  expect_named("<VTKFile type=\"PolyData\" version=\"0.1\">\n</VTKFile>", "a VTK file in XML", true);
  expect_named("<?xml version=\"1.0\"?><COLLADA></COLLADA>", "a COLLADA model", true);
  expect_named("<?xml version=\"1.0\"?><gml:Surface></gml:Surface>", "text in XML", true);
  expect_named("<!DOCTYPE MeshLabDocument>\n<MeshLabProject></MeshLabProject>\n", "a MeshLab project", true);
  expect_named("{\n  \"version\": 2, \"means\": {}, \"scales\": {}, \"quats\": {}}", "(SOG)", true);
  expect_named("{\"type\": \"FeatureCollection\", \"features\": []}", "GeoJSON", true);
  expect_named("{}", "text in JSON", true);
  expect_named("[[1, 2, 3], [4, 5, 6]]", "text in JSON", true);
}

TEST(ForeignFiles, OurOwnAndTablesInDocumentsAreNamed) {
  const char* const config = "a Sparsha configuration";
  expect_named("scans:\n  - {file: a.ply, units: m, pose: {translate: [0, 0, 0], quaternion: [0, 0, 0, 1]}}\n", config,
               true);
  expect_named("# A first configuration\n\n---\ngrid: {spacing_mm: 5}\nscans: [{file: a.ply}]\n", config, true);
  expect_named("scans:\r\n  - file: a.ply\r\n", config, true);
  const char* const scene = "the description of a Sparsha scene";
  expect_named("# A Sparsha scene\nscans:\n  - file: a.ply\nscene:\n  version: 1\n", scene, true);
  expect_named("# Scan\n\n| x | y | z |\n|---|:--|--:|\n| 0.1 | 0.2 | 0.3 |\n", "a table in Markdown", true);
  EXPECT_FALSE(error_of_bytes("scan.txt", "scans: x y z\n1 2 3\n4 5 6\n"));
  const auto bars = error_of_bytes("scan.txt", "x|y|z\n--|--|--\n1|2|3\n4|5|6\n");
  EXPECT_TRUE(!bars || bars->wrong().find("Markdown") == std::string::npos);
}

TEST(ForeignFiles, CornersOfTetGenAreNoPoints) {
  const char* const name = "a list of triangles or tetrahedra";
  expect_named("3 3 0\n1 1 2 53\n2 1 53 52\n3 2 3 54\n", name, true);
  expect_named("# corners\n2 4 1\n0 7 1 2 53 9\n1 1 53 52 8 9\n", name, true);
  expect_named("3 3 0 0\n1 0.5 0 2\n2 1 1 5\n3 2 2 5\n", "a list of nodes", true);
  expect_named("3 3 0 0\n1 0 0 2\n2 1 1 5\n3 2 2 5\n", "a list of nodes", true);
}

TEST(ForeignFiles, ListsOfPosesAreNoPoints) {
  const std::string turned = "0.6 -0.8 0 1.5 0.8 0.6 0 2.5 0 0 1 3.5\n";
  expect_named("1 0 0 0 0 1 0 0 0 0 1 0\n" + turned + turned, "a list of poses", true);
  EXPECT_FALSE(is_pose_list("1 0 0 0 0 1 0 0 0 0 1 0\n1 2 3 4 5 6 7 8 9 10 11 12\n"));
  EXPECT_FALSE(is_pose_list(turned + "0.6 -0.8 0 1.5 0.8 0.6 0 2.5 0 0 1\n"));
  expect_named("camera -0.017 -0.1 -0.05 -0.2 0.22 -0.006 0.97\nbmesh bun000.ply 0 0 0 0 0 0 1\n", "Stanford's list",
               true);
}

TEST(ForeignFiles, ModelsAreNamed) {
  expect_named("# vtk DataFile Version 3.0\nrelief\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\n",
               "a legacy VTK file", true);
  expect_named("#VRML V2.0 utf8\nShape {}\n", "a VRML scene", true);
  expect_named("ISO-10303-21;\nHEADER;\n", "a STEP model", true);
  const auto card = [](std::string text, const char* end) { return text + std::string(72 - text.size(), ' ') + end; };
  const std::string start = card("", "S      1");
  const std::string global = card("1H,,1H;,4Hscan;", "G      1");
  expect_named(start + "\n" + global + "\n", "an IGES model");
  expect_named(start + "\r\n" + card("", "S      2") + "\r\n" + global + "\r\n", "an IGES model");
  expect_named("0\nSECTION\n2\nENTITIES\n0\nPOINT\n8\n0\n10\n1.0\n20\n2.0\n30\n3.0\n0\nEOF\n", "a DXF drawing");
  expect_named("999\nmade by hand\n  0\r\nSECTION\r\n  2\r\nHEADER\r\n", "a DXF drawing");
  expect_named("3 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n", "Triangle or TetGen");
  expect_named("# nodes\n2 2 1 1\n\n 0 0.5 0.5 7 1 # first\n 1 1.5 0.5 7 1\n", "Triangle or TetGen");
  expect_named("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "a Gmsh mesh", true);
  expect_named("Kaydara FBX Binary  \0\x1A\0"sv, "an FBX model");
  expect_named("DRACO\x02\x02\0\0\0\0"sv, "a Draco cloud");
}

TEST(ForeignFiles, PackedSplatsAreNamed) {
  const std::string head = "element chunk 1\nproperty float min_x\nelement vertex 256\nproperty uint packed_position\n";
  expect_named("ply\nformat binary_little_endian 1.0\n" + head + "end_header\n" + std::string(4100, '\1'),
               "Gaussian splats in packed form");
  expect_named(
      "ply\nformat binary_little_endian 1.0\nelement vertex_0 10\nproperty float x\nelement codebook_centers 4\n"
      "property float f_dc_0\nend_header\n" +
          std::string(400, '\1'),
      "Gaussian splats whose values stand in codebooks");
  const auto error = error_of_bytes("a.ksplat", std::string(320, '\x01'));
  ASSERT_TRUE(error);
  EXPECT_THAT(error->wrong(), HasSubstr("(.ksplat)"));
}

/// The beginning of a zip archive whose first file has this name.
std::string zip(const std::string& name) {
  std::string bytes("PK\x03\x04\x14\0\0\0\0\0", 10);
  bytes.resize(26);
  put(bytes, static_cast<std::uint16_t>(name.size()));
  put(bytes, std::uint16_t{0});
  return bytes + name + "data";
}

TEST(ForeignFiles, DocumentsArchivesAndPicturesAreNamed) {
  expect_named(zip("scan.ply"), "a zip archive");
  expect_named(zip("[Content_Types].xml") + zip("xl/workbook.xml"), "an Excel workbook");
  expect_named(zip("word/document.xml"), "a Word document");
  expect_named(zip("meta.json") + zip("means_l.webp"), "(SOG)");
  expect_named(zip("arr_0.npy"), "an archive of NumPy arrays");
  expect_named("\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1\0\0"sv, "an older Office program");
  expect_named("%PDF-1.7\n%\xE2\xE3\n1 0 obj\n", "a PDF document", true);
  expect_named("\x1F\x8B\x08\0\0"sv, "a gzip archive");
  expect_named("7z\xBC\xAF\x27\x1C\0\x04"sv, "a 7z archive");
  expect_named("\x89PNG\r\n\x1A\n\0\0\0"sv, "a PNG picture");
  expect_named("\xFF\xD8\xFF\xE0\0\x10JFIF"sv, "a JPEG picture");
  expect_named("II*\0\x08\0\0\0"sv, "a TIFF picture");
  expect_named("RIFF\x24\0\0\0WAVEfmt "sv, "a recording of sound");
  expect_named("\x93NUMPY\x01\0"sv, "a NumPy array");
  expect_named(std::string("SQLite format 3\0\x10\0", 18), "an SQLite database");
  expect_named("DSBB\x0A\0\x0A\0\0\0"sv, "a binary Surfer 6 grid");
  expect_named("DSRB\x04\0\0\0\x02\0\0\0"sv, "a binary Surfer 7 grid");
  expect_named("ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\nbyteorder LSBFIRST\n", "a binary grid (.flt)",
               true);
  expect_named("north: 2\nsouth: 0\neast: 2\nwest: 0\nrows: 2\ncols: 2\n1 2\n3 4\n", "a GRASS ASCII grid", true);
  expect_named("Rar!\x1A\x07\0"sv, "a rar archive");
  const std::string tecplot = "TITLE = \"a\"\nVARIABLES = \"X\", \"Y\", \"Z\"\n";
  for (const char* zone :
       {"ZONE N=3, E=1, F=FEPOINT, ET=TRIANGLE", "ZONE T=\"a\", NODES=3, ELEMENTS=1, DATAPACKING=POINT",
        "Zone Nodes = 3\nZONETYPE = FETriangle", "ZONE I=3, F=BLOCK"}) {
    expect_named(tecplot + zone + "\n0 0 0\n1 0 0\n0 1 0\n1 2 3\n", "a mesh or blocks of columns of Tecplot", true);
  }
}

TEST(ForeignFiles, ATecplotZoneOfPointsIsATable) {
  const ScanFolder folder;
  const std::string text = "TITLE=\"a\"\nVARIABLES=\"X\",\"Y\",\"Z\"\nZONE I=4, F=POINT\n1 2 3\n4 5 6\n7 8 9\n1 5 9\n";
  EXPECT_EQ(folder.read("a.dat", text).records, 4U);
}

TEST(ForeignFiles, ANameOfAColumnIsNoMark) {
  const ScanFolder folder;
  for (const char* word : {"PAR1", "BLENDER", "GIF8", "BZh", "DRACO", "ID3", "BM", "MZ", "glTF"}) {
    EXPECT_EQ(folder.read("a.txt", std::string(word) + " x y z\n7 1 2 3\n7 4 5 6\n7 7 8 8\n").records, 3U) << word;
  }
  EXPECT_EQ(folder.read("b.txt", "<X> <Y> <Z>\n1 2 3\n4 5 6\n").records, 2U);
  // Five points of four whole numbers whose first row looks like the counts of a list of nodes.
  EXPECT_EQ(folder.read("c.xyz", "5 3 0 0\n1 0 0 0\n2 1 0 0\n9 1 1 0\n").records, 4U);
}

TEST(ForeignFiles, ABinaryStlMayBeginLikeAnything) {
  const ScanFolder folder;
  for (const char* word : {"PK\x03\x04", "%PDF", "BLENDER", "<html>", "\x1F\x8B"}) {
    std::string bytes(word);
    bytes.resize(80);
    put(bytes, std::uint32_t{1});
    for (const float value : {0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) put(bytes, value);
    put(bytes, std::uint16_t{0});
    EXPECT_EQ(folder.read("a.stl", bytes).records, 3U) << word;
  }
}

std::string widened(std::string_view text, std::size_t width, bool big, std::string_view mark) {
  std::string bytes(mark);
  for (const char c : text) {
    std::string one(width, '\0');
    one[big ? width - 1 : 0] = c;
    bytes += one;
  }
  return bytes;
}

TEST(ForeignFiles, WideTextIsNamedWithAndWithoutItsMark) {
  for (const char* text : {"1 2 3\n4 5 6\n7 8 9\n", "ply\nformat ascii 1.0\n", "v 1 2 3\nv 4 5 6\n"}) {
    for (const std::string_view mark : {"\xFF\xFE"sv, ""sv}) {
      expect_named(widened(text, 2, false, mark), "the text is UTF-16");
    }
    expect_named(widened(text, 2, true, "\xFE\xFF"), "the text is UTF-16");
    expect_named(widened(text, 2, true, ""), "the text is UTF-16");
    expect_named(widened(text, 4, false, "\xFF\xFE\0\0"sv), "the text is UTF-32");
    expect_named(widened(text, 4, true, ""), "the text is UTF-32");
  }
}

TEST(TextBehindAByteOrderMark, IsReadInEveryFormat) {
  const ScanFolder folder;
  const std::string mark = "\xEF\xBB\xBF";
  const std::string head = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  std::string binary;
  for (const float value : {1.0F, 2.0F, 3.0F}) put(binary, value);
  const std::string pcd = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ";
  for (const auto& [name, bytes] : {
           std::pair{"a.ply", "ply\nformat ascii 1.0\n" + head + "1 2 3\n"},
           {"b.ply", "ply\nformat binary_little_endian 1.0\n" + head + binary},
           {"a.pcd", "VERSION 0.7\n" + pcd + "ascii\n1 2 3\n"},
           {"b.pcd", "# .PCD v0.7\n" + pcd + "binary\n" + binary},
           {"a.obj", std::string("v 1 2 3\n")},
           {"a.xyz", std::string("1 2 3\n")},
           {"a.pts", std::string("1\n1 2 3\n")},
           {"a.csv", std::string("x,y,z\n1,2,3\n")},
           {"a.ptx", std::string("1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5\n")},
       }) {
    const RawScan scan = folder.read(name, mark + bytes);
    ASSERT_EQ(scan.points.size(), 1U) << name;
    EXPECT_EQ(scan.points[0], Eigen::Vector3d(1, 2, 3)) << name;
    EXPECT_EQ(scan.format, folder.read(name, bytes).format) << name;
    EXPECT_EQ(is_quick_to_stream(folder.write(name, mark + bytes)), is_quick_to_stream(folder.write(name, bytes)));
  }
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  EXPECT_EQ(folder.read("a.stl", mark + "solid a\n" + facet + "endsolid a\n").records, 3U);
}

TEST(ForeignFiles, ModelsAndTilesOfOtherProgramsAreNamed) {
  expect_named("ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC4'));\n", "an IFC building model", true);
  expect_named("ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\n", "a STEP model", true);
  expect_named("xof 0303txt 0032\nMesh { 3; 0;0;0;, 1;0;0;, 0;1;0;; }\n", "a DirectX model", true);
  expect_named("//Maya ASCII 2020 scene\nrequires maya \"2020\";\n", "a Maya scene", true);
  expect_named("NRRD0004\ntype: float\nsizes: 3 3 3\n\n", "a volume of voxels", true);
  expect_named("QC4DC4D6\0\0\x01\x02"sv, "a Cinema 4D scene");
  expect_named("FORM\0\0\x01\0LWO2\0\x01"sv, "a LightWave model");
  expect_named("VOX \x96\0\0\0MAIN\0"sv, "a voxel model");
  expect_named("b3dm\x01\0\0\0\x40\0"sv, "a tile of 3D Tiles");
  expect_named("pnts\x01\0\0\0\x40\0"sv, "a tile of 3D Tiles with points");
  std::string model = "MM";
  put(model, std::uint32_t{18});
  put(model, std::uint16_t{0x0002});
  put(model, std::uint32_t{10});
  put(model, std::uint32_t{3});
  put(model, std::uint16_t{0});
  expect_named(model, "a 3DS model");
}

TEST(ForeignFiles, OtherFilesOfReconstructionsAreNamed) {
  const std::string pictures =
      "1 0.99 0.1 0.05 0.08 -1.5 2.25 3 1 IMG_1.jpg\n10.5 20.5 -1 30.25 40.5 7\n2 1 0 0 0 0 0 0 1 IMG_2.jpg\n";
  expect_named(pictures, "COLMAP's list of pictures");
  expect_named("# Image list with two lines of data per image:\n" + pictures, "COLMAP's list of pictures");
  expect_named("# Camera list with one line of data per camera:\n1 PINHOLE 100 100 1 1 50 50\n",
               "COLMAP's list of cameras", true);
  std::string seen;
  put(seen, std::uint64_t{3});
  for (const std::uint32_t length : {2U, 0U, 3U}) {
    put(seen, length);
    for (std::uint32_t k = 0; k < length; ++k) put(seen, 7 * k);
  }
  expect_named(seen, "COLMAP's list of pictures that show each point");
  const auto error = error_of_bytes("images.bin", std::string(100, '\1'));
  ASSERT_TRUE(error);
  EXPECT_THAT(error->wrong(), HasSubstr("images.bin"));
  expect_named("# Bundle file v0.3\n2 3\n500 0 0\n1 0 0\n0 1 0\n0 0 1\n", "a Bundler reconstruction", true);
  expect_named("NVM_V3\n\n2\nimg1.jpg 2000 1 0 0 0 0 0 0 0 0\n", "a VisualSFM reconstruction", true);
}

}  // namespace
}  // namespace sparsha::pipeline
