// Heights as TIFF and as 16-bit PNG.
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/png/png.h"
#include "base/text/text.h"
#include "pipeline/export/formats.h"
#include "pipeline/export/height_tiff.h"
#include "pipeline/export/node_rows.h"
#include "scene/folder/layer_file.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

constexpr double kFloatReach_m = 1000.0;  // beyond, float32 is coarser than 0.05 mm
constexpr double kPngSteps = 65534.0;     // of grey, 0 is unknown

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

Range height_range(const scene::Scene& scene, Progress& progress) {
  NodeRows rows(scene, Nodes::known);
  Range range;
  for (int j = 0; j < rows.lattice().ny; ++j) {
    progress.at(0.3 * j / rows.lattice().ny);
    for (int i = 0; i < rows.lattice().nx; ++i) {
      if (!rows.known(i, j)) continue;
      const double z = raster_height(scene, rows.grid_m(i, j));
      range.low = std::min(range.low, z);
      range.high = std::max(range.high, z);
    }
  }
  return range;
}

[[noreturn]] void fail(const std::string& shown, const std::string& why) {
  throw Error(ErrorKind::failure, {shown, 0, 0}, "cannot be written: " + why, "expected a folder with room for it");
}

PngFormat format_of(const scene::Lattice& lattice, double low, double step) {
  PngFormat format;
  format.width = lattice.nx;
  format.height = lattice.ny;
  format.pixel = PngFormat::Pixel::grey16;
  format.pixel_m = lattice.spacing_m;
  format.description = fmt::format(
      "Heights in metres: z = {} + {} * (grey - 1); grey 0 is unknown. Pixels are nodes {} m apart, the top left one "
      "at x = {}, y = {} of the grid frame.",
      low, step, lattice.spacing_m, lattice.x_m(0), lattice.y_m(lattice.ny - 1));
  format.calibration = std::make_unique<PngFormat::Calibration>(
      PngFormat::Calibration{"height", "m", exact_text(low - step), exact_text(step * 65535.0)});
  return format;
}

}  // namespace

double raster_height(const scene::Scene& scene, const Eigen::Vector3d& grid_m) {
  const Eigen::Matrix4d& m = scene.description().scan_from_grid;
  if (!scene::keeps_scan_axes(scene.description())) return grid_m.z();
  return m(2, 0) * grid_m.x() + m(2, 1) * grid_m.y() + m(2, 2) * grid_m.z() + m(2, 3);
}

void export_tif(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown,
                Progress& progress) {
  const Range range = height_range(scene, progress);
  const bool wide = std::max(std::fabs(range.low), std::fabs(range.high)) > kFloatReach_m && range.low <= range.high;
  NodeRows rows(scene, Nodes::known);
  const scene::Lattice& lattice = rows.lattice();
  HeightTiff tiff(file, shown, lattice.nx, lattice.ny, wide);
  std::vector<double> band;
  for (int top = 0; top < lattice.ny; top += HeightTiff::kBand) {
    progress.at(0.3 + 0.7 * top / lattice.ny);
    band.clear();
    for (int row = top; row < std::min(lattice.ny, top + HeightTiff::kBand); ++row) {
      const int j = lattice.ny - 1 - row;
      for (int i = 0; i < lattice.nx; ++i) {
        band.push_back(rows.known(i, j) ? raster_height(scene, rows.grid_m(i, j))
                                        : std::numeric_limits<double>::quiet_NaN());
      }
    }
    tiff.write_band(top, band);
  }
  tiff.close();
}

void export_png(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown,
                Progress& progress) {
  const Range range = height_range(scene, progress);
  const double low = range.low <= range.high ? range.low : 0.0;
  const double step = range.low < range.high ? (range.high - range.low) / kPngSteps : 1.0;
  NodeRows rows(scene, Nodes::known);
  const scene::Lattice& lattice = rows.lattice();
  std::vector<std::uint8_t> line(2 * static_cast<std::size_t>(lattice.nx));

  std::ofstream stream(file, std::ios::binary);
  if (!stream) fail(shown, "the folder may be read-only");
  PngWriter out(format_of(lattice, low, step), [&](std::span<const std::byte> bytes) {
    stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!stream) fail(shown, "the disk may be full");
  });
  for (int j = lattice.ny - 1; j >= 0; --j) {
    progress.at(1.0 - 0.7 * j / lattice.ny);
    for (int i = 0; i < lattice.nx; ++i) {
      long grey = 0;
      if (rows.known(i, j)) grey = 1 + std::lround((raster_height(scene, rows.grid_m(i, j)) - low) / step);
      line[2 * static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(grey >> 8);
      line[2 * static_cast<std::size_t>(i) + 1] = static_cast<std::uint8_t>(grey & 0xFF);
    }
    out.write_row(line);
  }
  out.finish();
  stream.close();
  if (!stream) fail(shown, "the disk may be full");
}

}  // namespace sparsha::pipeline
