#include "pipeline/export/height_tiff.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "base/error.h"
#include "scene/folder/tiff_file.h"

namespace sparsha::pipeline {
namespace {

scene::TiffLayout layout_of(int nx, int ny, bool double_precision) {
  scene::TiffLayout layout;
  layout.width = static_cast<std::uint32_t>(nx);
  layout.height = static_cast<std::uint32_t>(ny);
  layout.tile = HeightTiff::kBand;
  layout.bits = double_precision ? 64 : 32;
  return layout;
}

}  // namespace

struct HeightTiff::Implementation {
  std::string shown;
  int nx = 0;
  bool double_precision = false;
  std::optional<scene::TiffFile> tiff;

  void require(bool done) const {
    if (done) return;
    throw Error(ErrorKind::failure, {shown, 0, 0}, "cannot be written: " + tiff->message(),
                "expected a folder with room for it");
  }
  void write_tile(const std::vector<double>& tile, int column, int row) {
    const auto left = static_cast<std::uint32_t>(column);
    const auto top = static_cast<std::uint32_t>(row);
    if (double_precision) return require(tiff->write_tile(left, top, tile.data()));
    std::vector<float> narrow(tile.size());
    std::transform(tile.begin(), tile.end(), narrow.begin(), [](double z) { return static_cast<float>(z); });
    require(tiff->write_tile(left, top, narrow.data()));
  }
};

HeightTiff::HeightTiff(const std::filesystem::path& file, std::string shown, int nx, int ny, bool double_precision)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  self.shown = std::move(shown);
  self.nx = nx;
  self.double_precision = double_precision;
  self.tiff = scene::TiffFile::create(file, layout_of(nx, ny, double_precision));
  self.require(self.tiff->is_open());
}

HeightTiff::~HeightTiff() = default;

void HeightTiff::write_band(int first_row, std::span<const double> heights) {
  Implementation& self = *implementation_;
  const int rows = static_cast<int>(heights.size() / static_cast<std::size_t>(self.nx));
  std::vector<double> tile(static_cast<std::size_t>(kBand) * kBand);
  for (int left = 0; left < self.nx; left += kBand) {
    std::fill(tile.begin(), tile.end(), std::numeric_limits<double>::quiet_NaN());
    const int columns = std::min(kBand, self.nx - left);
    for (int row = 0; row < rows; ++row) {
      const auto from = heights.begin() + static_cast<std::ptrdiff_t>(row) * self.nx + left;
      std::copy(from, from + columns, tile.begin() + static_cast<std::ptrdiff_t>(row) * kBand);
    }
    self.write_tile(tile, left, first_row);
  }
}

void HeightTiff::close() {
  Implementation& self = *implementation_;
  self.require(self.tiff->flush());
  self.tiff.reset();
}

}  // namespace sparsha::pipeline
