#include "scene/folder/tiff_file.h"

#include <tiffio.h>

#include <array>
#include <cstdarg>
#include <cstdio>
#include <mutex>
#include <utility>

namespace sparsha::scene {
namespace {

constexpr std::uint32_t kGdalNodata = 42113;
constexpr std::uint64_t kClassicLimit = 3'900'000'000ULL;  // bytes; beyond, offsets need BigTIFF

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

std::uint64_t file_bytes(const TiffLayout& layout) {
  const std::uint64_t across = (layout.width + layout.tile - 1) / layout.tile;
  const std::uint64_t down = (layout.height + layout.tile - 1) / layout.tile;
  return across * down * layout.tile * layout.tile * layout.pixel_bytes();
}

}  // namespace

struct TiffFile::Implementation {
  std::string message;
  TIFF* tiff = nullptr;

  Implementation(const std::filesystem::path& file, const char* mode) {
    static std::once_flag once;
    std::call_once(once, [] { parent_extender = TIFFSetTagExtender(register_nodata); });
    TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
    TIFFOpenOptionsSetErrorHandlerExtR(options, keep_message, &message);
    TIFFOpenOptionsSetWarningHandlerExtR(options, drop_message, nullptr);
    tiff = TIFFOpenExt(file.c_str(), mode, options);
    TIFFOpenOptionsFree(options);
  }
  ~Implementation() {
    if (tiff != nullptr) TIFFClose(tiff);
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;
};

TiffFile::TiffFile(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
TiffFile::~TiffFile() = default;
TiffFile::TiffFile(TiffFile&&) noexcept = default;
TiffFile& TiffFile::operator=(TiffFile&&) noexcept = default;

TiffFile TiffFile::create(const std::filesystem::path& file, const TiffLayout& layout) {
  auto implementation = std::make_unique<Implementation>(file, file_bytes(layout) > kClassicLimit ? "w8" : "w");
  if (TIFF* const tiff = implementation->tiff) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, layout.width);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, layout.height);
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, layout.tile);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, layout.tile);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, layout.bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, layout.samples);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, layout.floating ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, layout.samples == 4 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    TIFFSetField(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
    if (layout.samples == 4) {
      const std::uint16_t extra = EXTRASAMPLE_UNASSALPHA;
      TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &extra);
    }
    if (layout.floating) TIFFSetField(tiff, kGdalNodata, "nan");
  }
  return TiffFile(std::move(implementation));
}

TiffFile TiffFile::open(const std::filesystem::path& file) {
  return TiffFile(std::make_unique<Implementation>(file, "rm"));
}

bool TiffFile::is_open() const { return implementation_->tiff != nullptr; }

TiffLayout TiffFile::layout() const {
  TIFF* const tiff = implementation_->tiff;
  TiffLayout layout;
  std::uint32_t tile_width = 0;
  std::uint32_t tile_height = 0;
  std::uint16_t format = SAMPLEFORMAT_UINT;
  std::uint16_t compression = COMPRESSION_NONE;
  layout.bits = 0;
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &layout.width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &layout.height);
  TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &tile_width);
  TIFFGetField(tiff, TIFFTAG_TILELENGTH, &tile_height);
  TIFFGetField(tiff, TIFFTAG_BITSPERSAMPLE, &layout.bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &layout.samples);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &format);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
  layout.tile = tile_width == tile_height ? tile_width : 0;
  layout.floating = format == SAMPLEFORMAT_IEEEFP;
  if (!layout.floating && format != SAMPLEFORMAT_UINT) layout.bits = 0;  // no format that a layer has
  layout.packed = compression != COMPRESSION_NONE;
  return layout;
}

bool TiffFile::write_tile(std::uint32_t left, std::uint32_t top, const void* pixels) {
  return TIFFWriteTile(implementation_->tiff, const_cast<void*>(pixels), left, top, 0, 0) >= 0;
}

bool TiffFile::read_tile(std::uint32_t left, std::uint32_t top, void* pixels) {
  return TIFFReadTile(implementation_->tiff, pixels, left, top, 0, 0) >= 0;
}

bool TiffFile::flush() { return TIFFFlush(implementation_->tiff) == 1; }

const std::string& TiffFile::message() const { return implementation_->message; }

}  // namespace sparsha::scene
