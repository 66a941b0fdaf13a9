// PLY, OBJ and XYZ in the scan's own frame.
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "pipeline/export/formats.h"
#include "pipeline/export/node_rows.h"
#include "pipeline/export/output.hpp"
#include "pipeline/export/vertex_colour.hpp"

namespace sparsha::pipeline {
namespace {

/// What every header says: the frame, and that filled nodes are among the vertices.
std::string remark(bool nodes_only) {
  return nodes_only ? "measured nodes in the scan frame, metres"
                    : "measured and filled nodes in the scan frame, metres";
}

/// What a mesh is made of. A scene without a whole cell has no faces, and its nodes are written alone.
struct Pieces {
  Nodes nodes = Nodes::measured;
  MeshCounts counts;
};

Pieces pieces_of(const scene::Scene& scene, bool nodes_only, Progress& progress) {
  Pieces pieces;
  if (!nodes_only) {
    pieces.nodes = Nodes::of_cells;
    pieces.counts = count_mesh(scene, pieces.nodes, progress);
    if (pieces.counts.triangles > 0) return pieces;
    pieces.nodes = Nodes::known;
  }
  pieces.counts = count_mesh(scene, pieces.nodes, progress);
  return pieces;
}

}  // namespace

void export_ply(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown, bool nodes_only,
                Progress& progress) {
  const auto [nodes, counts] = pieces_of(scene, nodes_only, progress);
  if (counts.vertices > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorKind::failure, {shown, 0, 0}, "more vertices than PLY indices can count",
                "expected at most 2^32 nodes");
  }
  const bool colour = scene.description().has_colour;
  // Many readers know signed indices only; unsigned ones are for meshes that need them.
  const char* index = counts.vertices > std::numeric_limits<std::int32_t>::max() ? "uint" : "int";
  Output output(file, shown);
  output.print("ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\n", remark(nodes_only),
               counts.vertices);
  for (const char* axis : {"x", "y", "z"}) output.print("property double {}\n", axis);
  if (colour) output.print("{}", kPlyColours);
  if (!nodes_only) output.print("element face {}\nproperty list uchar {} vertex_indices\n", counts.triangles, index);
  output.print("end_header\n");
  for_each_vertex(scene, nodes, progress, [&](const Eigen::Vector3d& p, std::uint32_t rgba) {
    for (int axis = 0; axis < 3; ++axis) output.put(p[axis]);
    if (colour) put_ply_colour(output, rgba);
  });
  if (counts.triangles > 0) {
    for_each_triangle(scene, progress, [&](std::uint64_t a, std::uint64_t b, std::uint64_t c) {
      output.put(std::uint8_t{3});
      for (const std::uint64_t corner : {a, b, c}) output.put(static_cast<std::uint32_t>(corner));
    });
  }
  output.close();
}

void export_obj(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown, bool nodes_only,
                Progress& progress) {
  const auto [nodes, counts] = pieces_of(scene, nodes_only, progress);
  const bool colour = scene.description().has_colour;
  Output output(file, shown);
  output.print("# {}\n", remark(nodes_only));
  for_each_vertex(scene, nodes, progress, [&](const Eigen::Vector3d& p, std::uint32_t rgba) {
    output.print("v {} {} {}", p.x(), p.y(), p.z());
    if (colour) print_obj_colour(output, rgba);
    output.print("\n");
  });
  if (counts.triangles > 0) {
    for_each_triangle(scene, progress, [&](std::uint64_t a, std::uint64_t b, std::uint64_t c) {
      output.print("f {} {} {}\n", a + 1, b + 1, c + 1);
    });
  }
  output.close();
}

void export_xyz(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown, bool nodes_only,
                Progress& progress) {
  Output output(file, shown);
  for_each_vertex(scene, nodes_only ? Nodes::measured : Nodes::known, progress,
                  [&](const Eigen::Vector3d& p, std::uint32_t) { output.print("{} {} {}\n", p.x(), p.y(), p.z()); });
  output.close();
}

}  // namespace sparsha::pipeline
