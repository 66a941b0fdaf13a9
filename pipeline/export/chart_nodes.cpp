// Nodes of a whole object, in the scan's own frame.
#include <cstdint>
#include <limits>

#include "base/error.h"
#include "base/text/lower_case.h"
#include "pipeline/export/chart_nodes.h"
#include "pipeline/export/formats.h"
#include "pipeline/export/output.hpp"
#include "pipeline/export/vertex_colour.hpp"
#include "pipeline/solid/vertex_colours.h"
#include "scene/scene.h"

namespace sparsha::pipeline {

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
  for_each_chart_node(
      scene, progress, [&](const Eigen::Vector3d& p, const Eigen::Vector3d& n, std::size_t chart, std::size_t node) {
        const std::uint32_t rgba = colour ? charts.sheets[chart].colour_rgba[node] : 0;
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
