// Draws, encodes and writes what the report consists of.
#include "pipeline/report/report.h"

#include "base/files/files.h"
#include "base/png/png.h"
#include "pipeline/report/html.h"
#include "pipeline/report/images.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

std::string encode(const Picture& picture, double pixel_m) {
  PngFormat format;
  format.width = picture.width;
  format.height = picture.height;
  format.pixel = PngFormat::Pixel::palette8;
  for (const Rgb& colour : picture.palette) format.palette.push_back({colour.r, colour.g, colour.b});
  format.pixel_m = pixel_m;
  format.detailed = true;
  return encode_png(format, picture.pixels);
}

}  // namespace

void write_report(const scene::Scene& scene, const Report& report, const std::filesystem::path& folder,
                  ThreadPool& pool) {
  write_file(folder / "report.json", report_json(scene, report));
  const scene::SceneDescription& description = scene.description();
  const scene::Layers* in_memory = scene.in_memory(0);
  const scene::Layers read = in_memory != nullptr ? scene::Layers() : scene.read_level(0);
  const scene::Layers& base = in_memory != nullptr ? *in_memory : read;
  const std::vector<Picture> pictures = make_pictures(base, description, report, pool);
  const double pixel_m = nodes_per_pixel(base.grid.lattice) * base.grid.lattice.spacing_m;
  std::vector<std::string> encoded(pictures.size());
  pool.for_ranges(pictures.size(), 1, [&](std::size_t begin, std::size_t) {
    encoded[begin] = encode(pictures[begin],
                            pictures[begin].width_m > 0 ? pictures[begin].width_m / pictures[begin].width : pixel_m);
  });
  for (std::size_t k = 0; k < pictures.size(); ++k) write_file(folder / (pictures[k].name + ".png"), encoded[k]);
  write_file(folder / "report.html", report_html(scene, report, pictures, encoded));
}

}  // namespace sparsha::pipeline
