// PLY, OBJ and GLB of a closed mesh.
#include "pipeline/export/whole_mesh.h"

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "base/error.h"
#include "base/files/files.h"
#include "base/text/lower_case.h"
#include "pipeline/export/formats.h"
#include "pipeline/export/glb_file.h"
#include "pipeline/export/output.hpp"
#include "pipeline/export/vertex_colour.hpp"
#include "pipeline/solid/vertex_colours.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

const char* remark(Holes holes) {
  return holes == Holes::close ? "closed mesh of the whole object in the scan frame, metres"
                               : "mesh of the whole object in the scan frame, metres; open where no scan saw it";
}

/// A mesh in the frame of the scans.
class ScanMesh {
 public:
  /// `colours`: one a vertex, or none.
  ScanMesh(const scene::Scene& scene, const ClosedMesh& mesh, std::vector<std::uint32_t> colours)
      : mesh_(mesh),
        colours_(std::move(colours)),
        m_(scene.description().scan_from_grid),
        origin_m_(scene.description().charts->origin_m),
        mirrored_(m_.topLeftCorner<3, 3>().determinant() < 0.0) {}

  [[nodiscard]] MeshCounts counts() const { return {mesh_.vertices_m.size(), mesh_.triangles.size()}; }
  [[nodiscard]] bool has_colours() const { return !colours_.empty(); }
  /// Calls vertex(place, colour), where 0 is none.
  template <typename Vertex>
  void for_each_vertex(const Vertex& vertex) const {
    for (std::size_t k = 0; k < mesh_.vertices_m.size(); ++k)
      vertex(place_m(mesh_.vertices_m[k].cast<double>()), has_colours() ? colours_[k] : std::uint32_t{0});
  }
  /// The middle of its box, in whole metres.
  [[nodiscard]] Eigen::Vector3d middle_m() const {
    Eigen::Vector3f low = mesh_.vertices_m.front(), high = low;
    for (const Eigen::Vector3f& p : mesh_.vertices_m) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    return place_m(0.5 * (low + high).cast<double>()).array().round();
  }
  template <typename Triangle>
  void for_each_triangle(const Triangle& triangle) const {
    for (const auto& t : mesh_.triangles) {
      mirrored_ ? triangle(t[0], t[2], t[1]) : triangle(t[0], t[1], t[2]);
    }
  }

 private:
  [[nodiscard]] Eigen::Vector3d place_m(const Eigen::Vector3d& from_origin) const {
    return m_.topLeftCorner<3, 3>() * (origin_m_ + from_origin) + m_.topRightCorner<3, 1>();
  }
  const ClosedMesh& mesh_;
  std::vector<std::uint32_t> colours_;
  const Eigen::Matrix4d& m_;
  Eigen::Vector3d origin_m_;
  bool mirrored_;
};

void write_ply(const ScanMesh& mesh, Holes holes, const std::filesystem::path& file, const std::string& shown) {
  Output output(file, shown);
  output.print("ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\n", remark(holes),
               mesh.counts().vertices);
  for (const char* axis : {"x", "y", "z"}) output.print("property double {}\n", axis);
  if (mesh.has_colours()) output.print("{}", kPlyColours);
  output.print("element face {}\nproperty list uchar int vertex_indices\nend_header\n", mesh.counts().triangles);
  mesh.for_each_vertex([&](const Eigen::Vector3d& p, std::uint32_t rgba) {
    for (int axis = 0; axis < 3; ++axis) output.put(p[axis]);
    if (mesh.has_colours()) put_ply_colour(output, rgba);
  });
  mesh.for_each_triangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    output.put(std::uint8_t{3});
    for (const std::uint32_t corner : {a, b, c}) output.put(corner);
  });
  output.close();
}

void write_obj(const ScanMesh& mesh, Holes holes, const std::filesystem::path& file, const std::string& shown) {
  Output output(file, shown);
  output.print("# {}\n", remark(holes));
  mesh.for_each_vertex([&](const Eigen::Vector3d& p, std::uint32_t rgba) {
    output.print("v {} {} {}", p.x(), p.y(), p.z());
    if (mesh.has_colours()) print_obj_colour(output, rgba);
    output.print("\n");
  });
  mesh.for_each_triangle(
      [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) { output.print("f {} {} {}\n", a + 1, b + 1, c + 1); });
  output.close();
}

void write_glb(const ScanMesh& mesh, const Eigen::Matrix3d& turn, const std::filesystem::path& file,
               const std::string& shown) {
  const Eigen::Vector3d middle = mesh.middle_m();
  const auto local = [&](const Eigen::Vector3d& p) { return Eigen::Vector3f((p - middle).cast<float>()); };
  GlbBox box;
  mesh.for_each_vertex([&](const Eigen::Vector3d& p, std::uint32_t) { box.add(local(p)); });
  const GlbDescription description(mesh.counts(), box, middle, turn, mesh.has_colours(), {});
  Output output(file, shown);
  begin_glb(description, output, shown);
  mesh.for_each_vertex([&](const Eigen::Vector3d& p, std::uint32_t) {
    const Eigen::Vector3f q = local(p);
    for (int axis = 0; axis < 3; ++axis) output.put(q[axis]);
  });
  if (mesh.has_colours())
    mesh.for_each_vertex([&](const Eigen::Vector3d&, std::uint32_t rgba) { put_glb_colour(output, rgba); });
  mesh.for_each_triangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    for (const std::uint32_t corner : {a, b, c}) output.put(corner);
  });
  output.close();
}

/// Vertices that no triangle has, as of crumbs and of surface that is left open, go.
void drop_loose_vertices(ClosedMesh& mesh) {
  constexpr std::uint32_t kLoose = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(mesh.vertices_m.size(), kLoose);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) number[corner] = 0;
  std::uint32_t next = 0;
  for (std::size_t k = 0; k < number.size(); ++k) {
    if (number[k] == kLoose) continue;
    mesh.vertices_m[next] = mesh.vertices_m[k];
    number[k] = next++;
  }
  mesh.vertices_m.resize(next);
  for (auto& triangle : mesh.triangles)
    for (std::uint32_t& corner : triangle) corner = number[corner];
}

/// The closed mesh without loose vertices, and their colours where the scene has any.
std::pair<ClosedMesh, std::vector<std::uint32_t>> coloured_mesh(const scene::Scene& scene, Holes holes,
                                                                const Context& context) {
  const scene::Charts& charts = *scene.description().charts;
  ClosedMesh closed = make_closed_mesh(charts, holes, context);
  drop_loose_vertices(closed);
  std::vector<std::uint32_t> colours;
  if (has_colours(charts)) colours = vertex_colours(charts, closed.vertices_m, context);
  return {std::move(closed), std::move(colours)};
}

}  // namespace

bool is_mesh(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  return ending == ".ply" || ending == ".obj" || ending == ".glb";
}

WholeMesh whole_mesh(const scene::Scene& scene, Holes holes, const Context& context) {
  context.progress.begin("mesh");
  auto [closed, colours] = coloured_mesh(scene, holes, context);
  WholeMesh result;
  const ScanMesh mesh(scene, closed, std::move(colours));
  result.places_m.reserve(mesh.counts().vertices);
  result.triangles.reserve(mesh.counts().triangles);
  mesh.for_each_vertex([&](const Eigen::Vector3d& p, std::uint32_t rgba) {
    result.places_m.push_back(p);
    if (mesh.has_colours()) result.colours.push_back(rgba);
  });
  mesh.for_each_triangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    result.triangles.push_back({a, b, c});
  });
  result.facts = closed.facts;
  context.progress.finish();
  return result;
}

ClosedMeshFacts export_whole_mesh(const scene::Scene& scene, const std::filesystem::path& file, Holes holes,
                                  const Context& context) {
  const std::string shown = file.string();
  if (!is_mesh(file)) {
    throw Error(ErrorKind::usage, {shown, 0, 0}, "the ending names no mesh", "expected .ply, .obj or .glb");
  }
  context.progress.begin("mesh");
  auto [closed, colours] = coloured_mesh(scene, holes, context);
  if (closed.vertices_m.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw Error(ErrorKind::failure, {shown, 0, 0}, "more vertices than 32 bits can count", "a larger grid.spacing_mm");
  }
  const ScanMesh mesh(scene, closed, std::move(colours));
  AtomicPath target(file);
  const std::string ending = ending_of(file);
  if (ending == ".ply") {
    write_ply(mesh, holes, target.temporary(), shown);
  } else if (ending == ".obj") {
    write_obj(mesh, holes, target.temporary(), shown);
  } else {
    write_glb(mesh, viewer_from_scan(scene), target.temporary(), shown);
  }
  target.commit();
  context.progress.finish();
  return closed.facts;
}

}  // namespace sparsha::pipeline
