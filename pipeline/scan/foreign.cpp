#include "pipeline/scan/foreign.h"

#include <algorithm>
#include <array>
#include <string>

#include "base/text/lower_case.h"
#include "pipeline/scan/foreign_text.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

using namespace std::string_view_literals;

constexpr const char* kUnpack = "unpack it, and give the scan that is in it";
constexpr const char* kExportMesh = "export it from a program that opens it as PLY, OBJ or STL";
constexpr const char* kExportGlb = "export it as GLB, from the program that wrote it or one that opens it";
constexpr const char* kExportPoints = "export it from the program that wrote it as E57, LAS, PLY or XYZ text";
constexpr const char* kSplatRemedy =
    "save them uncompressed, as a PLY with x, y, z and opacity (the 'standard' or 'uncompressed' PLY of splat editors)";
constexpr const char* kPicture =
    "pictures hold no distances; give the cloud or mesh that was made of them, or of a raster of heights its ESRI "
    "ASCII "
    "grid ('gdal_translate -of AAIGrid')";
constexpr const char* kTable = "save the sheet as CSV text with a column each for x, y and z";
constexpr const char* kGridText =
    "convert it to an ESRI ASCII grid, for example 'gdal_translate -of AAIGrid IN OUT.asc'";

bool contains(std::string_view bytes, std::string_view word) { return bytes.find(word) != std::string_view::npos; }

/// Looks into the names of a zip archive's first files and of its directory.
bool zip_holds(const ScanFile& file, std::string_view name) {
  constexpr std::size_t kLooked = 1 << 16;
  if (!file.bytes.starts_with("PK\x03\x04"sv)) return false;
  const std::size_t end = file.bytes.size();
  return contains(file.bytes.substr(0, 4096), name) || contains(file.bytes.substr(end - std::min(end, kLooked)), name);
}

/// In lower case, behind blanks and blank lines.
std::string beginning(const ScanFile& file) {
  std::string_view head = file.bytes.substr(0, 1024);
  head.remove_prefix(std::min(head.find_first_not_of(" \t\r\n"), head.size()));
  return lower_case(head);
}

bool element_is(const ScanFile& file, std::string_view name) { return first_element(file.bytes) == name; }

using Test = bool (*)(const ScanFile&);

/// One kind, told by its bytes at a place, by the beginning of its text in any case, or by a test.
struct Kind {
  const char* what;
  const char* remedy;
  std::string_view mark{};
  std::size_t at = 0;
  std::string_view text{};  ///< lower case
  Test test = nullptr;
};
constexpr Kind marked(std::string_view mark, const char* what, const char* remedy, std::size_t at = 0) {
  return {what, remedy, mark, at, {}, nullptr};
}
constexpr Kind text(std::string_view text, const char* what, const char* remedy) {
  return {what, remedy, {}, 0, text, nullptr};
}
constexpr Kind tested(Test test, const char* what, const char* remedy) { return {what, remedy, {}, 0, {}, test}; }

/// The first that fits counts: narrow kinds stand before wide ones.
constexpr Kind kKinds[] = {
    // Stand-ins for a file that is elsewhere.
    text("version https://git-lfs", "a Git LFS pointer, which stands for the scan", "fetch the scan: 'git lfs pull'"),
    tested(
        [](const ScanFile& f) {
          const std::string_view line = f.bytes.substr(0, f.bytes.substr(0, 4096).find('\n'));
          return (line.starts_with('.') || line.starts_with('/')) && contains(line, "annex/objects/");
        },
        "a git-annex pointer, which stands for the scan", "fetch the scan: 'git annex get FILE'"),
    text("[internetshortcut]", "a link to a page", "download the scan that it leads to"),
    marked("L\0\0\0\x01\x14\x02\0"sv, "a Windows shortcut", "give the file that it leads to"),
    marked("\0\x05\x16\x07"sv, "what macOS keeps beside a file ('._NAME')", "give the file without '._' in its name"),
    text("http/1.", "the answer of a server with its header", "download the scan itself"),
    text("404: not found", "a server's word that there is no such file",
         "download the scan again, from its right address"),
    // Pages and other markup.
    tested([](const ScanFile& f) { return element_is(f, "html") || element_is(f, "head") || element_is(f, "body"); },
           "a page of HTML, as servers send when a file is not there or needs a login",
           "download the scan itself and look at it"),
    tested([](const ScanFile& f) { return element_is(f, "error"); }, "a server's message of an error, in XML",
           "download the scan again"),
    tested([](const ScanFile& f) { return element_is(f, "x3d"); }, "an X3D scene", kExportMesh),
    tested([](const ScanFile& f) { return element_is(f, "vtkfile"); }, "a VTK file in XML",
           "export it from ParaView as PLY or STL, or its points as CSV"),
    tested([](const ScanFile& f) { return element_is(f, "collada"); }, "a COLLADA model", kExportMesh),
    tested([](const ScanFile& f) { return element_is(f, "svg"); }, "an SVG drawing", kPicture),
    tested([](const ScanFile& f) { return element_is(f, "landxml"); }, "a LandXML survey", kExportPoints),
    tested([](const ScanFile& f) { return element_is(f, "kml"); }, "a KML map", kExportPoints),
    tested([](const ScanFile& f) { return element_is(f, "meshlabproject"); },
           "a MeshLab project, which names its meshes", "give the meshes, or export them into one PLY"),
    tested([](const ScanFile& f) { return first_element(f.bytes).has_value(); }, "text in XML, but no scan",
           kKnownFormats),
    tested(
        [](const ScanFile& f) {
          return is_object_of_json(f.bytes, {"\"means\"", "\"scales\"", "\"quats\""});
        },
        "the description of compressed Gaussian splats (SOG)", kSplatRemedy),
    tested(
        [](const ScanFile& f) {
          return is_object_of_json(f.bytes, {"\"type\"", "Feature"});
        },
        "GeoJSON", kExportPoints),
    tested([](const ScanFile& f) { return is_object_of_json(f.bytes, {"CityJSON"}); }, "a CityJSON model", kExportMesh),
    tested([](const ScanFile& f) { return is_json(f.bytes); }, "text in JSON, but no scan", kKnownFormats),
    tested([](const ScanFile& f) { return is_sparsha_config(f.bytes) && has_line(f.bytes, "scene:"); },
           "the description of a Sparsha scene (scene.yaml)", "give the folder that it lies in, or the scans"),
    tested([](const ScanFile& f) { return is_sparsha_config(f.bytes); }, "a Sparsha configuration, which names scans",
           "build it ('sparsha build CONFIG.yaml'; its name must end with .yaml), or give the scans that it names"),
    tested([](const ScanFile& f) { return is_markdown_table(f.bytes); }, "a table in Markdown",
           "save it as CSV text: commas in place of the bars, without the line of dashes"),
    // Models and meshes.
    text("# vtk datafile", "a legacy VTK file", "export it from ParaView as PLY or STL, or its points as CSV"),
    text("#vrml", "a VRML scene", kExportMesh),
    tested(
        [](const ScanFile& f) {
          return beginning(f).starts_with("iso-10303-21") && contains(f.bytes.substr(0, 1 << 16), "'IFC");
        },
        "an IFC building model", kExportMesh),
    text("iso-10303-21", "a STEP model", "export it from a CAD program as STL or PLY, with a fine mesh"),
    tested([](const ScanFile& f) { return is_iges(f.bytes); }, "an IGES model",
           "export it from a CAD program as STL or PLY, with a fine mesh, or its points as XYZ text"),
    tested([](const ScanFile& f) { return is_dxf(f.bytes); }, "a DXF drawing",
           "export its mesh as STL, OBJ or PLY, or its points as XYZ text, from a CAD program or CloudCompare"),
    text("autocad binary dxf", "a binary DXF drawing", kExportMesh),
    tested([](const ScanFile& f) { return f.bytes.starts_with("AC10") && looks_binary(f.bytes); }, "a DWG drawing",
           kExportMesh),
    tested([](const ScanFile& f) { return is_element_list(f.bytes); },
           "a list of triangles or tetrahedra of Triangle or TetGen (.ele), which has numbers of points and no places",
           "save the mesh as PLY, OBJ, OFF or STL"),
    tested([](const ScanFile& f) { return is_node_list(f.bytes); },
           "a list of nodes of Triangle or TetGen (.node), whose first line is no point",
           "take the first line away, name the file .xyz, and give 'columns: [skip, x, y, z]' in the configuration"),
    tested([](const ScanFile& f) { return lower_case(f.bytes.substr(0, 16)).find("off binary") < 6; },
           "a binary OFF mesh", "save it as OFF in text, or as PLY, OBJ or STL"),
    tested([](const ScanFile& f) { return is_tecplot_mesh(f.bytes); },
           "a mesh or blocks of columns of Tecplot, whose rows are no points alone",
           "export its points as CSV text, or the mesh as PLY or STL"),
    text("$meshformat", "a Gmsh mesh", kExportMesh),
    text("meshversionformatted", "a Medit mesh", kExportMesh),
    text("#usda", "a USD scene", kExportGlb),
    marked("PXR-USDC"sv, "a USD scene", kExportGlb),
    marked("Kaydara FBX Binary"sv, "an FBX model", kExportMesh),
    text("; fbx", "an FBX model", kExportMesh),
    marked("BLENDER"sv, "a Blender file", kExportMesh),
    marked("3D Geometry File Format"sv, "a Rhino model", kExportMesh),
    marked("\xFF\xFE\xFF\x0ES\0k\0e\0t\0c\0h\0U\0p\0"sv, "a SketchUp model", kExportMesh),
    marked("DRACO"sv, "a Draco cloud or mesh", "decode it ('draco_decoder -i IN -o OUT.ply')"),
    marked("CCB2"sv, "a CloudCompare entity (.bin)", "save it from CloudCompare as PLY, LAS or E57"),
    tested([](const ScanFile& f) { return is_3ds(f.bytes); }, "a 3DS model", kExportMesh),
    text("xof 0", "a DirectX model (.x)", kExportMesh),
    text("//maya ascii", "a Maya scene", kExportMesh),
    marked("QC4DC4D"sv, "a Cinema 4D scene", kExportMesh),
    marked("LWO2"sv, "a LightWave model", kExportMesh, 8),
    marked("VOX "sv, "a voxel model (.vox)", kExportMesh),
    text("nrrd000", "a volume of voxels (NRRD)", "export its surface as STL or PLY"),
    // Clouds of other programs, and splats.
    tested([](const ScanFile& f) { return is_colmap_images(f.bytes); }, "COLMAP's list of pictures (images.txt)",
           "give its points3D.txt, or the fused.ply of its dense cloud"),
    text("# camera list with one line", "COLMAP's list of cameras (cameras.txt)",
         "give its points3D.txt, or the fused.ply of its dense cloud"),
    tested([](const ScanFile& f) { return is_colmap_visibility(f.bytes); },
           "COLMAP's list of pictures that show each point (.vis)", "give the fused.ply that lies beside it"),
    tested([](const ScanFile& f) { return f.name.ends_with("images.bin"); }, "COLMAP's list of pictures (images.bin)",
           "give its points3D.bin, or the fused.ply of its dense cloud"),
    tested([](const ScanFile& f) { return f.name.ends_with("cameras.bin"); }, "COLMAP's list of cameras (cameras.bin)",
           "give its points3D.bin, or the fused.ply of its dense cloud"),
    tested([](const ScanFile& f) { return is_pose_list(f.bytes); },
           "a list of poses, a turn and a place in twelve numbers each, as of KITTI", "give the scans that it places"),
    tested(
        [](const ScanFile& f) { return has_line(f.bytes, "bmesh "); },
        "Stanford's list of scans with their places (.conf)",
        "give the scans that it names, each with its 'pose' in a configuration, or let 'sparsha register' place them"),
    text("# bundle file v", "a Bundler reconstruction", "export its points as PLY"),
    text("nvm_v3", "a VisualSFM reconstruction (.nvm)", "export its points as PLY"),
    marked("b3dm"sv, "a tile of 3D Tiles", "take the glTF out of it ('3d-tiles-tools b3dmToGlb')"),
    marked("pnts"sv, "a tile of 3D Tiles with points", kExportPoints),
    tested(
        [](const ScanFile& f) {
          return lower_case(f.bytes.substr(0, 3)) == "ply" && contains(f.bytes.substr(0, 8192), "packed_position");
        },
        "Gaussian splats in packed form", kSplatRemedy),
    tested(
        [](const ScanFile& f) {
          return lower_case(f.bytes.substr(0, 3)) == "ply" && contains(f.bytes.substr(0, 8192), "element codebook");
        },
        "Gaussian splats whose values stand in codebooks", kSplatRemedy),
    tested([](const ScanFile& f) { return f.extension == "ksplat" && looks_binary(f.bytes); },
           "Gaussian splats (.ksplat)", kSplatRemedy),
    tested([](const ScanFile& f) { return zip_holds(f, "meta.json") && zip_holds(f, "means"); },
           "Gaussian splats in packed form (SOG)", kSplatRemedy),
    text("riegl lms rdb", "a RIEGL database of points", kExportPoints),
    text("#rosbag", "a recording of ROS", "export its clouds as PCD ('pcl_ros bag_to_pcd')"),
    marked("\x89MCAP"sv, "a recording of ROS (MCAP)", "export its clouds as PCD"),
    // Grids in other forms.
    marked("DSBB"sv, "a binary Surfer 6 grid",
           "save it in Surfer as 'GS ASCII' (DSAA), or convert it to an ESRI ASCII grid"),
    marked("DSRB"sv, "a binary Surfer 7 grid",
           "save it in Surfer as 'GS ASCII' (DSAA), or convert it to an ESRI ASCII grid"),
    tested(
        [](const ScanFile& f) {
          const std::string head = beginning(f);
          return head.starts_with("ncols") && contains(head, "byteorder");
        },
        "the header of a binary grid (.flt)", kGridText),
    tested(
        [](const ScanFile& f) {
          const std::string head = beginning(f);
          return head.starts_with("north:") && contains(head, "rows:");
        },
        "a GRASS ASCII grid", "export it as an ESRI ASCII grid ('r.out.gdal format=AAIGrid')"),
    marked("\x89HDF\r\n\x1A\n"sv, "an HDF5 or NetCDF file", kGridText),
    marked("CDF\x01"sv, "a NetCDF file", kGridText),
    marked("CDF\x02"sv, "a NetCDF file", kGridText),
    marked("EHFA_HEADER_TAG"sv, "an ERDAS Imagine raster", kGridText),
    marked("\0\0\x27\x0A\0\0\0\0"sv, "an Esri shapefile", kExportPoints),
    // Documents, sheets and data of programs.
    tested([](const ScanFile& f) { return zip_holds(f, "xl/work") || zip_holds(f, "xl/styles"); }, "an Excel workbook",
           kTable),
    tested([](const ScanFile& f) { return zip_holds(f, "application/vnd.oasis.opendocument.spreadsheet"); },
           "an OpenDocument sheet", kTable),
    tested([](const ScanFile& f) { return zip_holds(f, "word/"); }, "a Word document",
           "give the scan, not the text about it"),
    tested([](const ScanFile& f) { return zip_holds(f, "application/vnd.oasis.opendocument"); }, "an OpenDocument text",
           "give the scan, not the text about it"),
    tested([](const ScanFile& f) { return zip_holds(f, "ppt/"); }, "a PowerPoint presentation",
           "give the scan, not the text about it"),
    tested([](const ScanFile& f) { return zip_holds(f, "doc.kml"); }, "a KMZ map", kExportPoints),
    tested([](const ScanFile& f) { return zip_holds(f, ".usdc") || zip_holds(f, ".usda"); }, "a USDZ scene",
           kExportGlb),
    tested([](const ScanFile& f) { return zip_holds(f, ".npy"); }, "an archive of NumPy arrays",
           "save the points as text ('numpy.savetxt') or PLY"),
    marked("\x93NUMPY"sv, "a NumPy array", "save the points as text ('numpy.savetxt') or PLY"),
    marked("\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"sv,
           "a file of an older Office program (Word, Excel) or another compound file", kTable),
    text("%pdf", "a PDF document", "give the scan, not the text about it"),
    text("{\\rtf", "an RTF document", "save it as plain text"),
    text("%!ps", "a PostScript document", "give the scan, not the text about it"),
    marked("SQLite format 3"sv, "an SQLite database, as GeoPackages and projects are", kExportPoints),
    marked("MATLAB 5.0 MAT-file"sv, "a MATLAB file", "save the points as text ('writematrix') or PLY ('pcwrite')"),
    marked("PAR1"sv, "a Parquet table", "save it as CSV text"),
    marked("\x7F"
           "ELF"sv,
           "a program", kKnownFormats),
    tested([](const ScanFile& f) { return f.bytes.starts_with("MZ") && contains(f.bytes.substr(0, 1024), "PE\0\0"sv); },
           "a program", kKnownFormats),
    marked("DICM"sv, "a DICOM picture", "export its surface as STL or PLY", 128),
    // Archives.
    marked("\x1F\x8B"sv, "a gzip archive", kUnpack),
    marked("PK\x03\x04"sv, "a zip archive", kUnpack),
    marked("PK\x05\x06"sv, "an empty zip archive", kKnownFormats),
    marked("7z\xBC\xAF\x27\x1C"sv, "a 7z archive", kUnpack),
    marked("\xFD"
           "7zXZ\0"sv,
           "an xz archive", kUnpack),
    marked("BZh"sv, "a bzip2 archive", kUnpack),
    marked("\x28\xB5\x2F\xFD"sv, "a zstd archive", kUnpack),
    marked("\x04\x22\x4D\x18"sv, "an lz4 archive", kUnpack),
    marked("Rar!\x1A\x07"sv, "a rar archive", kUnpack),
    marked("\x1F\x9D"sv, "an archive of compress (.Z)", kUnpack),
    marked("MSCF\0\0\0\0"sv, "a cabinet archive", kUnpack),
    marked("ustar"sv, "a tar archive", kUnpack, 257),
    // Pictures, sound and films.
    marked("\x89PNG"sv, "a PNG picture", kPicture),
    marked("\xFF\xD8\xFF"sv, "a JPEG picture", kPicture),
    marked("II*\0"sv, "a TIFF picture or GeoTIFF", kPicture),
    marked("MM\0*"sv, "a TIFF picture or GeoTIFF", kPicture),
    marked("II+\0"sv, "a BigTIFF picture or GeoTIFF", kPicture),
    marked("MM\0+"sv, "a BigTIFF picture or GeoTIFF", kPicture),
    marked("GIF8"sv, "a GIF picture", kPicture),
    marked("8BPS"sv, "a Photoshop picture", kPicture),
    marked("\x76\x2F\x31\x01"sv, "an OpenEXR picture", kPicture),
    marked("\0\0\0\x0CjP  "sv, "a JPEG 2000 picture", kPicture),
    tested([](const ScanFile& f) { return f.bytes.starts_with("BM") && f.bytes.size() > 26 && looks_binary(f.bytes); },
           "a BMP picture", kPicture),
    marked("WEBP"sv, "a WebP picture", kPicture, 8),
    marked("WAVE"sv, "a recording of sound", kKnownFormats, 8),
    marked("fLaC"sv, "a recording of sound", kKnownFormats),
    marked("OggS"sv, "a recording of sound", kKnownFormats),
    marked("ID3"sv, "a recording of sound", kKnownFormats),
    marked("AVI "sv, "a film", kKnownFormats, 8),
    marked("ftyp"sv, "a film or an HEIC picture", kKnownFormats, 4),
    tested(
        [](const ScanFile& f) {
          const std::string_view head = f.bytes.substr(0, 1 << 16);
          return head.size() >= 4 && head.find_first_not_of('\0') == std::string_view::npos;
        },
        "empty but for zeros, as broken downloads and copies are", "copy or download it again"),
};

bool is_word(std::string_view mark) {
  return std::all_of(mark.begin(), mark.end(), [](char c) { return c >= ' ' && c < 127; });
}

/// A mark that is a word of letters may also be the name of a column: then the rest must be binary.
bool fits(const Kind& kind, const ScanFile& file, const std::string& head) {
  if (kind.test != nullptr) return kind.test(file);
  if (!kind.text.empty()) return head.starts_with(kind.text);
  return file.bytes.size() > kind.at && file.bytes.substr(kind.at).starts_with(kind.mark) &&
         (!is_word(kind.mark) || looks_binary(file.bytes));
}

}  // namespace

void refuse_foreign(const ScanFile& file) {
  const std::string head = beginning(file);
  for (const Kind& kind : kKinds) {
    if (fits(kind, file, head)) throw file.error(std::string("the file is ") + kind.what, kind.remedy);
  }
  if (const char* const encoding = wide_encoding(file.bytes)) {
    throw file.error(std::string("the text is ") + encoding,
                     std::string("ASCII or UTF-8; convert it first: 'iconv -f ") + encoding + " -t UTF-8 IN > OUT'");
  }
}

}  // namespace sparsha::pipeline
