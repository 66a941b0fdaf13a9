// libtiff with its messages caught per file.
#include "pipeline/export/height_tiff.h"

#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <mutex>

#include "pipeline/base/error.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint32_t kGdalNodata = 42113;
constexpr std::uint64_t kClassicLimit = 4'000'000'000ULL;  // bytes; beyond, offsets need BigTIFF

TIFFExtendProc parent_extender = nullptr;

void register_nodata(TIFF* tiff) {
  static char name[] = "GDALNoDataValue";
  static const TIFFFieldInfo field{kGdalNodata, TIFF_VARIABLE, TIFF_VARIABLE, TIFF_ASCII, FIELD_CUSTOM, 1, 0, name};
  TIFFMergeFieldInfo(tiff, &field, 1);
  if (parent_extender != nullptr) parent_extender(tiff);
}

int keep_message(TIFF*, void* message, const char*, const char* format, va_list arguments) {
  std::array<char, 300> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  *static_cast<std::string*>(message) = text.data();
  return 1;  // nothing more to print
}

int drop_message(TIFF*, void*, const char*, const char*, va_list) { return 1; }

}  // namespace

struct HeightTiff::Implementation {
  std::string shown;
  std::string message;
  int nx = 0, ny = 0;
  bool double_precision = false;
  TIFF* tiff = nullptr;

  [[noreturn]] void fail() const {
    throw Error(ErrorKind::failure, {shown, 0, 0}, "cannot be written: " + message,
                "expected a folder with room for it");
  }
  void write_tile(const std::vector<double>& tile, int column, int row) {
    std::vector<float> narrow;
    void* data = const_cast<double*>(tile.data());  // libtiff's interface lacks the const
    if (!double_precision) {
      narrow.resize(tile.size());
      std::transform(tile.begin(), tile.end(), narrow.begin(), [](double z) { return static_cast<float>(z); });
      data = narrow.data();
    }
    if (TIFFWriteTile(tiff, data, static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row), 0, 0) < 0)
      fail();
  }
};

HeightTiff::HeightTiff(const std::filesystem::path& file, std::string shown, int nx, int ny, bool double_precision)
    : implementation_(std::make_unique<Implementation>()) {
  static std::once_flag once;
  std::call_once(once, [] { parent_extender = TIFFSetTagExtender(register_nodata); });
  Implementation& self = *implementation_;
  self.shown = std::move(shown);
  self.nx = nx;
  self.ny = ny;
  self.double_precision = double_precision;
  const std::uint64_t bytes =
      static_cast<std::uint64_t>(nx + kBand) * static_cast<std::uint64_t>(ny + kBand) * (double_precision ? 8U : 4U);
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options, keep_message, &self.message);
  TIFFOpenOptionsSetWarningHandlerExtR(options, drop_message, nullptr);
  self.tiff = TIFFOpenExt(file.c_str(), bytes > kClassicLimit ? "w8" : "w", options);
  TIFFOpenOptionsFree(options);
  if (self.tiff == nullptr) self.fail();
  TIFFSetField(self.tiff, TIFFTAG_IMAGEWIDTH, nx);
  TIFFSetField(self.tiff, TIFFTAG_IMAGELENGTH, ny);
  TIFFSetField(self.tiff, TIFFTAG_TILEWIDTH, kBand);
  TIFFSetField(self.tiff, TIFFTAG_TILELENGTH, kBand);
  TIFFSetField(self.tiff, TIFFTAG_BITSPERSAMPLE, double_precision ? 64 : 32);
  TIFFSetField(self.tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
  TIFFSetField(self.tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(self.tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(self.tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(self.tiff, kGdalNodata, "nan");
}

HeightTiff::~HeightTiff() {
  if (implementation_->tiff != nullptr) TIFFClose(implementation_->tiff);
}

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
  if (TIFFFlush(self.tiff) == 0) self.fail();
  TIFFClose(self.tiff);
  self.tiff = nullptr;
}

}  // namespace sparsha::pipeline
