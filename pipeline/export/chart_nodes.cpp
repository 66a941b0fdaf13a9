// Nodes of a whole object, in the scan's own frame.
#include <cstdint>
#include <limits>

#include <Eigen/LU>

#include "base/error.h"
#include "base/text/lower_case.h"
#include "pipeline/export/formats.h"
#include "pipeline/export/output.hpp"
#include "pipeline/export/vertex_colour.hpp"
#include "pipeline/solid/vertex_colours.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

// Calls node(position, outward unit normal, number of the sheet, colour or 0) for each.
template <typename Node>
void for_each_node(const scene::Scene& scene, Progress& progress, const Node& node) {
  const scene::SceneDescription& description = scene.description();
  const scene::Charts& charts = *description.charts;
  const Eigen::Matrix4d& m = description.scan_from_grid;
  // Normals stay across the surface when it is sheared or scaled.
  const Eigen::Matrix3d of_normals = m.topLeftCorner<3, 3>().inverse().transpose();
  for (std::size_t s = 0; s < charts.sheets.size(); ++s) {
    progress.at(static_cast<double>(s) / static_cast<double>(charts.sheets.size()));
    const scene::Sheet& sheet = charts.sheets[s];
    for (int j = 0; j < sheet.ny; ++j) {
      for (int i = 0; i < sheet.nx; ++i) {
        if (!sheet.measured(sheet.index(i, j))) continue;
        const Eigen::Vector3d grid_m = charts.origin_m + charts.place_m(sheet, i, j);
        node(Eigen::Vector3d(m.topLeftCorner<3, 3>() * grid_m + m.topRightCorner<3, 1>()),
             Eigen::Vector3d((of_normals * scene::Charts::normal(sheet, i, j)).normalized()), s,
             sheet.colour_rgba.empty() ? std::uint32_t{0} : sheet.colour_rgba[sheet.index(i, j)]);
      }
    }
  }
}

}  // namespace

void export_chart_nodes(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown,
                        Progress& progress) {
  const std::string ending = ending_of(shown);
  const scene::Charts& charts = *scene.description().charts;
  if (charts.sheets.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw Error(ErrorKind::failure, {shown, 0, 0}, "more charts than PLY integers can count", "fewer than 2^31");
  }
  const char* const remark = "measured nodes of all charts in the scan frame, metres; outward normals";
  const bool colour = has_colours(charts);
  Output output(file, shown);
  if (ending == ".ply") {
    output.print("ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\n", remark,
                 charts.measured_nodes());
    for (const char* name : {"x", "y", "z"}) output.print("property double {}\n", name);
    for (const char* name : {"nx", "ny", "nz"}) output.print("property float {}\n", name);
    if (colour) output.print("{}", kPlyColours);
    output.print("property int chart\nend_header\n");
  } else if (ending == ".obj") {
    output.print("# {}\n", remark);
  }
  for_each_node(scene, progress,
                [&](const Eigen::Vector3d& p, const Eigen::Vector3d& n, std::size_t chart, std::uint32_t rgba) {
                  if (ending == ".ply") {
                    for (int axis = 0; axis < 3; ++axis) output.put(p[axis]);
                    for (int axis = 0; axis < 3; ++axis) output.put(static_cast<float>(n[axis]));
                    if (colour) put_ply_colour(output, rgba);
                    output.put(static_cast<std::int32_t>(chart));
                  } else if (ending == ".obj") {
                    output.print("v {} {} {}", p.x(), p.y(), p.z());
                    if (colour) print_obj_colour(output, rgba);
                    output.print("\nvn {:.6f} {:.6f} {:.6f}\n", n.x(), n.y(), n.z());
                  } else {
                    output.print("{} {} {} {:.6f} {:.6f} {:.6f} {}\n", p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), chart);
                  }
                });
  output.close();
}

}  // namespace sparsha::pipeline
