// Plain readers for tests; they believe what they read.
#include "readers.h"

#include <png.h>
#include <tiffio.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <sstream>
#include <stdexcept>

namespace sparsha::test {
namespace {

void read_world(const std::filesystem::path& file, Raster& raster) {
  std::ifstream stream(file);
  double d = 0, b = 0;
  stream >> raster.a >> d >> b >> raster.e >> raster.c >> raster.f;
  if (!stream || d != 0.0 || b != 0.0) throw std::runtime_error("bad world file");
}

}  // namespace

Mesh read_ply(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string line, element;
  std::size_t vertices = 0, faces = 0;
  std::vector<std::string> order;
  bool colour = false;
  while (std::getline(stream, line) && line != "end_header") {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "format" && line != "format binary_little_endian 1.0") throw std::runtime_error(line);
    if (word == "element") {
      std::size_t count = 0;
      words >> element >> count;
      (element == "vertex" ? vertices : faces) = count;
      order.push_back(element);
    }
    if (word == "property" && element == "vertex") {
      std::string type, name;
      words >> type >> name;
      if (name.size() == 1 && type != "double") throw std::runtime_error("coordinates are not double");
      colour = colour || name == "red";
    }
  }
  if (order.empty() || order[0] != "vertex") throw std::runtime_error("the vertex element is not first");
  Mesh mesh;
  for (std::size_t k = 0; k < vertices; ++k) {
    std::array<double, 3> p{};
    stream.read(reinterpret_cast<char*>(p.data()), 24);
    mesh.vertices.push_back(p);
    if (colour) {
      std::array<std::uint8_t, 3> rgb{};
      stream.read(reinterpret_cast<char*>(rgb.data()), 3);
      mesh.colours.push_back(rgb);
    }
  }
  for (std::size_t k = 0; k < faces; ++k) {
    if (stream.get() != 3) throw std::runtime_error("a face that is no triangle");
    std::array<std::uint32_t, 3> corners{};
    stream.read(reinterpret_cast<char*>(corners.data()), 12);
    mesh.faces.push_back(corners);
  }
  if (!stream || stream.peek() != std::char_traits<char>::eof())
    throw std::runtime_error("the body has another length");
  return mesh;
}

Mesh read_obj(const std::filesystem::path& file) {
  Mesh mesh;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      std::array<std::string, 3> text;
      words >> text[0] >> text[1] >> text[2];
      mesh.vertices.push_back({std::strtod(text[0].c_str(), nullptr), std::strtod(text[1].c_str(), nullptr),
                               std::strtod(text[2].c_str(), nullptr)});
      std::array<double, 3> colour{};  // 0 to 1
      if (words >> colour[0] >> colour[1] >> colour[2]) {
        std::array<std::uint8_t, 3> rgb{};
        for (std::size_t c = 0; c < 3; ++c) rgb[c] = static_cast<std::uint8_t>(255.0 * colour[c] + 0.5);
        mesh.colours.push_back(rgb);
      }
    } else if (word == "f") {
      std::array<std::uint32_t, 3> corners{};
      words >> corners[0] >> corners[1] >> corners[2];
      for (std::uint32_t& corner : corners) --corner;
      mesh.faces.push_back(corners);
    }
  }
  return mesh;
}

Mesh read_xyz(const std::filesystem::path& file) {
  Mesh mesh;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    std::array<double, 3> p{};
    if (std::sscanf(line.c_str(), "%lf %lf %lf", &p[0], &p[1], &p[2]) != 3) throw std::runtime_error(line);
    mesh.vertices.push_back(p);
  }
  return mesh;
}

Raster read_tif(const std::filesystem::path& file) {
  Raster raster;
  TIFFSetWarningHandler(nullptr);
  const std::unique_ptr<TIFF, decltype(&TIFFClose)> tiff(TIFFOpen(file.c_str(), "r"), &TIFFClose);
  if (!tiff) throw std::runtime_error("no TIFF");
  std::uint16_t bits = 0, format = 0;
  std::uint32_t tile_width = 0, tile_height = 0;
  TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &raster.width);
  TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &raster.height);
  TIFFGetField(tiff.get(), TIFFTAG_BITSPERSAMPLE, &bits);
  TIFFGetField(tiff.get(), TIFFTAG_SAMPLEFORMAT, &format);
  if (!TIFFIsTiled(tiff.get()) || format != SAMPLEFORMAT_IEEEFP) throw std::runtime_error("not tiled floats");
  TIFFGetField(tiff.get(), TIFFTAG_TILEWIDTH, &tile_width);
  TIFFGetField(tiff.get(), TIFFTAG_TILELENGTH, &tile_height);
  raster.bits = bits;
  raster.z.assign(static_cast<std::size_t>(raster.width) * raster.height, 0.0);
  std::vector<char> tile(static_cast<std::size_t>(TIFFTileSize(tiff.get())));
  for (std::uint32_t row = 0; row < raster.height; ++row) {
    for (std::uint32_t column = 0; column < raster.width; ++column) {
      if (row % tile_height == 0 && column % tile_width == 0) {
        // Each tile once, all of its pixels.
        TIFFReadTile(tiff.get(), tile.data(), column, row, 0, 0);
        for (std::uint32_t r = row; r < std::min(row + tile_height, raster.height); ++r) {
          for (std::uint32_t c = column; c < std::min(column + tile_width, raster.width); ++c) {
            const std::size_t k = (r - row) * tile_width + (c - column);
            float narrow = 0;
            double wide = 0;
            if (bits == 32) std::memcpy(&narrow, &tile[4 * k], 4);
            if (bits == 64) std::memcpy(&wide, &tile[8 * k], 8);
            raster.z[r * raster.width + c] = bits == 32 ? static_cast<double>(narrow) : wide;
          }
        }
      }
    }
  }
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  raster.description = bytes;  // for the GDAL_NODATA text
  read_world(std::filesystem::path(file).replace_extension(".tfw"), raster);
  return raster;
}

Raster read_png(const std::filesystem::path& file) {
  Raster raster;
  std::FILE* stream = std::fopen(file.c_str(), "rb");
  if (stream == nullptr) throw std::runtime_error("no PNG");
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, stream);
  png_read_info(png, info);
  raster.width = png_get_image_width(png, info);
  raster.height = png_get_image_height(png, info);
  raster.bits = png_get_bit_depth(png, info);
  png_charp purpose = nullptr, units = nullptr;
  png_charpp parameters = nullptr;
  png_int_32 x0 = 0, x1 = 0;
  int type = 0, count = 0;
  if (png_get_pCAL(png, info, &purpose, &x0, &x1, &type, &count, &units, &parameters) == 0) {
    throw std::runtime_error("no calibration");
  }
  const double p0 = std::strtod(parameters[0], nullptr);
  const double p1 = std::strtod(parameters[1], nullptr);
  png_textp text = nullptr;
  if (png_get_text(png, info, &text, nullptr) > 0) raster.description = text[0].text;
  std::vector<png_byte> line(2 * static_cast<std::size_t>(raster.width));
  for (std::uint32_t row = 0; row < raster.height; ++row) {
    png_read_row(png, line.data(), nullptr);
    for (std::uint32_t column = 0; column < raster.width; ++column) {
      const int grey = line[2 * column] << 8 | line[2 * column + 1];
      raster.z.push_back(grey == 0 ? std::numeric_limits<double>::quiet_NaN() : p0 + p1 * grey / (x1 - x0));
    }
  }
  png_destroy_read_struct(&png, &info, nullptr);
  std::fclose(stream);
  read_world(std::filesystem::path(file).replace_extension(".pgw"), raster);
  return raster;
}

}  // namespace sparsha::test
