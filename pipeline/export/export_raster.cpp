// Heights as TIFF and as 16-bit PNG.
#include <png.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pipeline/base/error.h"
#include "pipeline/export/formats.h"
#include "pipeline/export/height_tiff.h"
#include "pipeline/export/node_rows.h"
#include "pipeline/scene/layer_file.h"

namespace sparsha::pipeline {
namespace {

constexpr double kFloatReach = 1000.0;  // metres; beyond, float32 is coarser than 0.05 mm
constexpr double kPngSteps = 65534.0;   // of grey, 0 is unknown

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

Range height_range(const Scene& scene, Progress& progress) {
  NodeRows rows(scene, false);
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

/// libpng reports by long jump; only plain data lives across the calls here.
struct PngFile {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::FILE* stream = nullptr;
  ~PngFile() {
    png_destroy_write_struct(&png, &info);
    if (stream != nullptr) std::fclose(stream);
  }
};
void on_error(png_structp png, png_const_charp) { png_longjmp(png, 1); }
void on_warning(png_structp, png_const_charp) {}

/// What the grey values mean. Made before libpng may jump, so that the jump passes over no destructor.
struct Legend {
  std::string description, first, slope;
  std::uint32_t pixels_per_metre = 0;
};

Legend legend(const Lattice& lattice, double low, double step) {
  Legend legend;
  legend.description = fmt::format(
      "Heights in metres: z = {} + {} * (grey - 1); grey 0 is unknown. Pixels are nodes {} m apart, the top left one "
      "at "
      "x = {}, y = {} of the grid frame.",
      low, step, lattice.spacing_m, lattice.x_m(0), lattice.y_m(lattice.ny - 1));
  legend.first = fmt::format("{}", low - step);
  legend.slope = fmt::format("{}", step * 65535.0);
  const double per_metre = 1.0 / lattice.spacing_m;
  if (per_metre >= 1.0 && per_metre < 4e9) legend.pixels_per_metre = static_cast<std::uint32_t>(std::lround(per_metre));
  return legend;
}

/// pCAL says to programs what the Description says to people.
void describe(PngFile& file, Legend& legend) {
  char* parameters[] = {legend.first.data(), legend.slope.data()};
  png_set_pCAL(file.png, file.info, "height", 0, 65535, PNG_EQUATION_LINEAR, 2, "m", parameters);
  if (legend.pixels_per_metre > 0) {
    png_set_pHYs(file.png, file.info, legend.pixels_per_metre, legend.pixels_per_metre, PNG_RESOLUTION_METER);
  }
  char key[] = "Description";
  png_text text{};
  text.compression = PNG_TEXT_COMPRESSION_NONE;
  text.key = key;
  text.text = legend.description.data();
  png_set_text(file.png, file.info, &text, 1);
}

}  // namespace

double raster_height(const Scene& scene, const Eigen::Vector3d& grid_m) {
  const Eigen::Matrix4d& m = scene.description().scan_from_grid;
  if (!keeps_scan_axes(m)) return grid_m.z();
  return m(2, 0) * grid_m.x() + m(2, 1) * grid_m.y() + m(2, 2) * grid_m.z() + m(2, 3);
}

void export_tif(const Scene& scene, const std::filesystem::path& file, const std::string& shown, Progress& progress) {
  const Range range = height_range(scene, progress);
  const bool wide = std::max(std::fabs(range.low), std::fabs(range.high)) > kFloatReach && range.low <= range.high;
  NodeRows rows(scene, false);
  const Lattice& lattice = rows.lattice();
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

void export_png(const Scene& scene, const std::filesystem::path& file, const std::string& shown, Progress& progress) {
  const Range range = height_range(scene, progress);
  const double low = range.low <= range.high ? range.low : 0.0;
  const double step = range.low < range.high ? (range.high - range.low) / kPngSteps : 1.0;
  NodeRows rows(scene, false);
  const Lattice& lattice = rows.lattice();
  Legend grey_legend = legend(lattice, low, step);
  std::vector<std::uint8_t> line(2 * static_cast<std::size_t>(lattice.nx));

  PngFile out;
  out.stream = std::fopen(file.c_str(), "wb");
  if (out.stream == nullptr) fail(shown, "the folder may be read-only");
  out.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, on_error, on_warning);
  out.info = out.png != nullptr ? png_create_info_struct(out.png) : nullptr;
  if (out.info == nullptr) fail(shown, "there is no memory for it");
  if (setjmp(png_jmpbuf(out.png)) != 0) fail(shown, "the disk may be full");
  png_init_io(out.png, out.stream);
  png_set_IHDR(out.png, out.info, static_cast<png_uint_32>(lattice.nx), static_cast<png_uint_32>(lattice.ny), 16,
               PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  describe(out, grey_legend);
  png_write_info(out.png, out.info);
  for (int j = lattice.ny - 1; j >= 0; --j) {
    progress.at(1.0 - 0.7 * j / lattice.ny);
    for (int i = 0; i < lattice.nx; ++i) {
      long grey = 0;
      if (rows.known(i, j)) grey = 1 + std::lround((raster_height(scene, rows.grid_m(i, j)) - low) / step);
      line[2 * static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(grey >> 8);
      line[2 * static_cast<std::size_t>(i) + 1] = static_cast<std::uint8_t>(grey & 0xFF);
    }
    png_write_row(out.png, line.data());
  }
  png_write_end(out.png, out.info);
  const bool closed = std::fclose(out.stream) == 0;
  out.stream = nullptr;
  if (!closed) fail(shown, "the disk may be full");
}

}  // namespace sparsha::pipeline
