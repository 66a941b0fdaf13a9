// Draws, encodes and writes what the report consists of.
#include "pipeline/check/report.h"

#include "pipeline/base/files.h"
#include "pipeline/check/report_html.h"
#include "pipeline/check/report_images.h"
#include "pipeline/check/report_png.h"

namespace sparsha::pipeline {

void write_report(const Scene& scene, const Report& report, const std::filesystem::path& folder, ThreadPool& pool) {
  write_file(folder / "report.json", report_json(scene, report));
  const SceneDescription& description = scene.description();
  const Layers* in_memory = scene.in_memory(0);
  const Layers read = in_memory != nullptr ? Layers() : scene.read_level(0);
  const Layers& base = in_memory != nullptr ? *in_memory : read;
  const std::vector<Picture> pictures = make_pictures(base, description, report, pool);
  const double pixel_m = nodes_per_pixel(base.grid.lattice) * base.grid.lattice.spacing_m;
  std::vector<std::string> encoded(pictures.size());
  pool.for_ranges(pictures.size(), 1, [&](std::size_t begin, std::size_t) {
    const Picture& picture = pictures[begin];
    encoded[begin] = encode_png(picture.pixels, picture.width, picture.height, picture.palette, pixel_m);
  });
  for (std::size_t k = 0; k < pictures.size(); ++k) write_file(folder / (pictures[k].name + ".png"), encoded[k]);
  write_file(folder / "report.html", report_html(scene, report, pictures, encoded));
}

}  // namespace sparsha::pipeline
