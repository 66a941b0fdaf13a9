// Scans after public bug reports in formats other than tables of points, as they lie beside the real scans: each has
// the points that its table of expected values says, or is refused with the true reason.
#include <gmock/gmock.h>

#include "pipeline/scan/worth.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::HasSubstr;

struct Reported {
  const char* file;
  std::uint64_t points;  ///< valid ones
  bool faces;
  const char* error;  ///< part of the message; null when the file reads
};

const Reported kScans[] = {
    {"mesh_20x20.obj", 400, true, nullptr},
    {"mesh_5_faces.obj", 400, true, nullptr},
    {"r01_lower_type.pcd", 546, false, nullptr},
    {"r02_padding.pcd", 546, false, nullptr},
    {"r04_bad_matrix.ptx", 0, false, ":291: error:"},
    {"r06_colour_then_bw.ptx", 546, false, nullptr},
    {"r08_transposed_matrix.ptx", 0, false, ":7: error:"},
    {"r22b_bom_in_body.ply", 0, false, ":8: error:"},
    {"r23_comment_bytes.ply", 546, false, nullptr},
    {"r24_splats.ply", 546, false, nullptr},
    {"r25_packed_splats.ply", 0, false, "packed form"},
    {"r26_zero_vertices_mesh.ply", 530, true, nullptr},
    {"r28_continued_crlf.obj", 546, true, nullptr},
    {"r29_count_zero.stl", 0, false, "room for 128"},
    {"r30_count_ffff.stl", 0, false, "room for 128"},
    {"r31_magics_colour.stl", 81, true, nullptr},
    {"r32_bom_ascii.stl", 81, true, nullptr},
    {"r35_camera_frame.ply", 546, false, nullptr},
    {"r42_face_name.ply", 81, true, nullptr},
    {"r43_wedge_texcoord.ply", 81, true, nullptr},
    {"r44_tristrip_be.ply", 81, true, nullptr},
    {"r45_utm_float.ply", 546, false, nullptr},
    {"r46_cr_blank_lines.ply", 546, false, nullptr},
    {"r47_vertex_list_colour16.ply", 546, false, nullptr},
    {"r50_phantom_zero.e57", 546, false, nullptr},
    {"r51_azimuth_2pi.e57", 546, false, nullptr},
    {"r52_two_poses.e57", 546, false, nullptr},
    {"r53_images_only.e57", 0, false, "no 3D data"},
    {"r55_duplicate_namespace.e57", 546, false, nullptr},
    {"r60_zero_bbox.las", 546, false, nullptr},
    {"r61_zero_scale.las", 0, false, "scale of 0"},
    {"r62_pf7_legacy0_extra.las", 546, false, nullptr},
    {"r63_scale_1e-9.las", 546, false, nullptr},
    {"r65_box_swapped.las", 546, false, nullptr},
    {"r82_points.node", 0, false, "list of nodes"},
    {"r83_legacy.vtk", 0, false, "VTK"},
    {"r86_lfs_pointer.ply", 0, false, "Git LFS pointer"},
    {"r95_crlf_binary.pcd", 513, false, nullptr},
    {"r99_wall_utm_float32.ply", 1625, false, nullptr},
    {"r100_site_lonlat.xyz", 494, false, nullptr},
    {"r109_confidence_30percent.ply", 786, false, nullptr},
    {"r110_noise_class_10percent.las", 606, false, nullptr},
    {"r111_islands.ply", 558, true, nullptr},
    {"r117_splat_haze.ply", 546, false, nullptr},
    {"r115_points.igs", 0, false, "IGES"},
    {"r116_points.dxf", 0, false, "DXF"},
};

TEST(ReportedScans, AreReadAsExpectedOrRefusedForTheTrueReason) {
  SPARSHA_REAL_SCANS_OR_SKIP(folder);
  for (const Reported& expected : kScans) {
    SCOPED_TRACE(expected.file);
    const std::filesystem::path file = folder / "reported" / expected.file;
    ScanInfo info;
    try {
      info = inspect_scan(file);
    } catch (const Error& error) {
      ASSERT_NE(expected.error, nullptr) << error.what();
      EXPECT_THAT(error.what(), HasSubstr(expected.error));
      continue;
    }
    ASSERT_EQ(expected.error, nullptr) << "read";
    EXPECT_EQ(info.points - info.invalid, expected.points);
    EXPECT_EQ(!read_scan(file).faces.empty(), expected.faces);
  }
}

struct Said {
  const char* file;
  std::vector<const char*> words;  ///< one sentence each, in any order; no other is said
};

const Said kSaid[] = {
    {"mesh_20x20.obj", {}},
    {"mesh_5_faces.obj", {"389 of 400 vertices belong to no face"}},
    {"r24_splats.ply", {"120 of 666 splats are no surface"}},
    {"r26_zero_vertices_mesh.ply", {"16 of 546 vertices stand at 0 0 0"}},
    {"r35_camera_frame.ply", {}},
    {"r45_utm_float.ply", {"x in steps of 0.0312 units, y in steps of 0.5 units"}},
    {"r99_wall_utm_float32.ply", {"x in steps of 0.0312 units, y in steps of 0.5 units"}},
    {"r100_site_lonlat.xyz", {"look like degrees"}},
    {"r109_confidence_30percent.ply", {"240 of 786 points (30.5 %) have a confidence of 0"}},
    {"r110_noise_class_10percent.las", {"60 of 606 points (9.9 %) are of class 18"}},
    {"r111_islands.ply", {"4 separate pieces"}},
    {"r117_splat_haze.ply", {"1100 of 1646 splats are no surface"}},
};

TEST(ReportedScans, WhatTheyMakeDoubtfulIsSaidAndNothingElse) {
  SPARSHA_REAL_SCANS_OR_SKIP(folder);
  for (const Said& expected : kSaid) {
    SCOPED_TRACE(expected.file);
    const ScanInfo info = inspect_scan(folder / "reported" / expected.file);
    std::vector<std::string> said = info.warnings;
    for (const Worth& worth : worth_of(info.tallies)) said.push_back(worth.reason);
    std::vector<::testing::Matcher<std::string>> words;
    for (const char* sentence : expected.words) words.emplace_back(HasSubstr(sentence));
    EXPECT_THAT(said, ::testing::UnorderedElementsAreArray(words));
  }
}

}  // namespace
}  // namespace sparsha::pipeline
