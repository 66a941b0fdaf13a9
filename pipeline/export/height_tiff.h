// A tiled TIFF of heights, written band by band from the top row down, so that no raster need fit in memory.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sparsha::pipeline {

class HeightTiff {
 public:
  static constexpr int kBand = 256;  ///< rows of a band, nodes per side of a tile

  /// `shown` is the name in messages. NaN is the GDAL_NODATA value. Throws Error{failure}.
  HeightTiff(const std::filesystem::path& file, std::string shown, int nx, int ny, bool double_precision);
  ~HeightTiff();
  HeightTiff(const HeightTiff&) = delete;
  HeightTiff& operator=(const HeightTiff&) = delete;

  /// Rows [first_row, first_row + rows) of the file, row 0 on top, `nx` values each; bands of kBand rows, in order.
  void write_band(int first_row, std::span<const double> heights);
  /// Flushes; what is not closed is not whole.
  void close();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::pipeline
