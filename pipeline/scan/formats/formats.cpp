// The table of formats, in the order in which a file is asked.
#include "pipeline/scan/formats/formats.h"

#include <algorithm>

#include "pipeline/scan/formats/colmap.h"
#include "pipeline/scan/formats/e57/e57.h"
#include "pipeline/scan/formats/gltf/gltf.h"
#include "pipeline/scan/formats/grid/esri.h"
#include "pipeline/scan/formats/grid/surfer.h"
#include "pipeline/scan/formats/las/las.h"
#include "pipeline/scan/formats/obj/obj.h"
#include "pipeline/scan/formats/off.h"
#include "pipeline/scan/formats/pcd/pcd.h"
#include "pipeline/scan/formats/ply/ply.h"
#include "pipeline/scan/formats/ptx.h"
#include "pipeline/scan/formats/splat/splat.h"
#include "pipeline/scan/formats/splat/spz.h"
#include "pipeline/scan/formats/stl.h"
#include "pipeline/scan/formats/text/xyz.h"
#include "pipeline/scan/formats/threemf/threemf.h"

namespace sparsha::pipeline {
namespace {

/// Whether one of the first lines holds the words.
bool says(const ScanFile& file, std::string_view words) {
  return file.bytes.substr(0, 4096).find(words) != std::string_view::npos;
}
bool always(const ScanFile& /*file*/) { return true; }
/// Any element beside the vertices.
bool has_more_than_vertices(const ScanFile& file) {
  const std::string_view header = file.bytes.substr(0, std::min(file.bytes.find("end_header"), file.bytes.size()));
  return header.find("element ", header.find("element ") + 1) != std::string_view::npos;
}
bool is_fixed_width_ply(const ScanFile& file) {
  return says(file, "format binary") && says(file, "end_header") && !says(file, "element face") &&
         !says(file, "element tristrip") && !says(file, "property list");
}
bool is_uncompressed_las(const ScanFile& file) {
  return file.bytes.size() > 104 && (static_cast<unsigned char>(file.bytes[104]) & 0xC0) == 0;
}
bool is_binary_pcd(const ScanFile& file) { return says(file, "DATA binary\n") || says(file, "DATA binary\r\n"); }

[[noreturn]] void refuse_stl(const ScanFile& file, ScanWriter& /*out*/) {
  throw file.error("neither ASCII nor binary STL", "'solid' and facets, or 84 bytes and more");
}

constexpr auto kSignature = Format::Told::by_signature;
constexpr auto kWriting = Format::Told::by_writing;

constexpr std::array kFormats = {
    // The first 80 bytes of a binary STL may be anything.
    Format{.name = "STL",
           .endings = {"stl"},
           .told = kSignature,
           .is = is_binary_stl,
           .read = read_stl,
           .z_up = true,
           .by_ending = true,
           .may_hold_faces = always},
    Format{.name = "glTF",
           .endings = {"gltf"},
           .told = kSignature,
           .is = is_gltf,
           .read = read_gltf,
           .y_up = true,
           .may_hold_faces = always},
    Format{.name = "GLB",
           .endings = {"glb"},
           .told = kSignature,
           .is = is_gltf,
           .read = read_gltf,
           .y_up = true,
           .missing = "the signature 'glTF'",
           .may_hold_faces = always},
    Format{.name = "3MF",
           .endings = {"3mf"},
           .told = kSignature,
           .is = is_3mf,
           .read = read_3mf,
           .z_up = true,
           .missing = "a zip package",
           .may_hold_faces = always},
    Format{.name = "SPZ",
           .endings = {"spz"},
           .told = kSignature,
           .is = is_spz,
           .read = read_spz,
           .missing = "a gzip stream of splats",
           .points_only = true},
    Format{.name = "PLY",
           .endings = {"ply"},
           .is = is_ply,
           .read = read_ply,
           .missing = "a first line 'ply'",
           .may_hold_faces = has_more_than_vertices,
           .quick_to_stream = is_fixed_width_ply},
    Format{.name = "LAS",
           .endings = {"las", "laz"},
           .is = is_las,
           .read = read_las,
           .z_up = true,
           .missing = "the signature 'LASF'",
           .points_only = true,
           .quick_to_stream = is_uncompressed_las},
    Format{.name = "LAZ", .endings = {"laz"}, .is = is_las, .read = read_las, .z_up = true, .points_only = true},
    Format{.name = "E57",
           .endings = {"e57"},
           .is = is_e57,
           .read = read_e57,
           .z_up = true,
           .missing = "the signature 'ASTM-E57'",
           .points_only = true},
    Format{.name = "STL",
           .endings = {"stl"},
           .is = is_ascii_stl,
           .read = read_stl,
           .z_up = true,
           .may_hold_faces = always},
    Format{.name = "PCD",
           .endings = {"pcd"},
           .is = is_pcd,
           .read = read_pcd,
           .missing = "lines such as 'FIELDS x y z'; plain columns of numbers should end in .xyz",
           .points_only = true,
           .quick_to_stream = is_binary_pcd},
    Format{.name = "COLMAP", .endings = {"bin"}, .is = is_colmap, .read = read_colmap, .points_only = true},
    Format{.name = "splat", .endings = {"splat"}, .is = is_splat, .read = read_splat, .points_only = true},
    Format{.name = "ESRI",
           .endings = {"asc", "grd"},
           .told = kWriting,
           .is = is_esri_grid,
           .read = read_esri_grid,
           .z_up = true},
    Format{.name = "Surfer",
           .endings = {"grd"},
           .told = kWriting,
           .is = is_surfer_grid,
           .read = read_surfer_grid,
           .z_up = true},
    Format{
        .name = "OFF", .endings = {"off"}, .told = kWriting, .is = is_off, .read = read_off, .may_hold_faces = always},
    Format{.name = "OBJ",
           .endings = {"obj"},
           .told = kWriting,
           .is = is_obj,
           .read = read_obj,
           .by_ending = true,
           .may_hold_faces = always},
    Format{.name = "PTX",
           .endings = {"ptx"},
           .told = kWriting,
           .is = is_ptx,
           .read = read_ptx,
           .z_up = true,
           .by_ending = true,
           .points_only = true},
    Format{.name = "STL", .endings = {"stl"}, .told = kWriting, .read = refuse_stl, .z_up = true, .by_ending = true},
    Format{.name = "PTS",
           .endings = {"pts"},
           .told = kWriting,
           .read = read_xyz,
           .z_up = true,
           .by_ending = true,
           .points_only = true},
    Format{.name = "XYZ",
           .endings = {"xyz", "txt"},
           .told = kWriting,
           .read = read_xyz,
           .by_ending = true,
           .points_only = true},
};

}  // namespace

std::span<const Format> formats() { return kFormats; }

}  // namespace sparsha::pipeline
