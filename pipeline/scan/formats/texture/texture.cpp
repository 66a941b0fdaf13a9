#include "pipeline/scan/formats/texture/texture.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "pipeline/scan/scalar.h"
#include "pipeline/scan/text.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {
namespace {

const std::array<double, 256>& light_of_bytes() {
  static const std::array<double, 256> kTable = [] {
    std::array<double, 256> table{};
    for (std::size_t k = 0; k < table.size(); ++k) table[k] = linear_of_srgb(static_cast<double>(k) / 255.0);
    return table;
  }();
  return kTable;
}

/// A whole pixel from 0 to size - 1.
std::size_t wrapped(double pixel, std::size_t size, Wrap wrap) {
  const auto most = static_cast<double>(size);
  double at = pixel;
  if (wrap == Wrap::repeat) {
    at = pixel - most * std::floor(pixel / most);
  } else if (wrap == Wrap::mirror) {
    at = pixel - 2.0 * most * std::floor(pixel / (2.0 * most));
    if (at >= most) at = 2.0 * most - 1.0 - at;
  }
  return static_cast<std::size_t>(std::clamp(at, 0.0, most - 1.0));
}

}  // namespace

double linear_of_srgb(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

double srgb_of_linear(double value) {
  return value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
}

Light sample(const ColourPicture& picture, double u, double v, Wrap along_u, Wrap along_v) {
  const double x = (std::isfinite(u) ? u : 0.0) * static_cast<double>(picture.width) - 0.5;
  const double y = (std::isfinite(v) ? v : 0.0) * static_cast<double>(picture.height) - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const std::array<std::size_t, 2> columns{wrapped(left, picture.width, along_u),
                                           wrapped(left + 1.0, picture.width, along_u)};
  const std::array<std::size_t, 2> rows{wrapped(top, picture.height, along_v),
                                        wrapped(top + 1.0, picture.height, along_v)};
  const std::array<double, 2> across{1.0 - (x - left), x - left}, down{1.0 - (y - top), y - top};
  const std::array<double, 256>& light = light_of_bytes();
  Light sum{};
  for (std::size_t j = 0; j < 2; ++j) {
    for (std::size_t i = 0; i < 2; ++i) {
      const std::uint32_t pixel = picture.rgba[rows[j] * picture.width + columns[i]];
      const double weight = across[i] * down[j];
      for (unsigned k = 0; k < 3; ++k) sum[k] += weight * light[pixel >> 8U * k & 255U];
      sum[3] += weight * (pixel >> 24U) / 255.0;
    }
  }
  return sum;
}

std::uint32_t colour_of(const Light& light) {
  const auto byte = [](double value) { return colour_byte(std::clamp(value, 0.0, 1.0), ColourScale::unit); };
  return pack_rgba(byte(srgb_of_linear(light[0])), byte(srgb_of_linear(light[1])), byte(srgb_of_linear(light[2])),
                   byte(light[3]));
}

std::unique_ptr<MappedFile> open_beside(const ScanFile& scan, std::string_view name) {
  std::string slashes(name);
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  std::filesystem::path path(slashes);
  const bool outside = path.is_absolute() || slashes.find(':') != std::string::npos ||
                       std::any_of(path.begin(), path.end(), [](const auto& part) { return part == ".."; });
  if (outside) path = path.filename();
  const std::filesystem::path folder = std::filesystem::path(scan.name).parent_path();
  try {
    return std::make_unique<MappedFile>(folder / path);
  } catch (const Error& error) {
    throw scan.error("its file " + in_quotes(name) + " cannot be read: " + error.wrong(), "the file beside the scan");
  }
}

}  // namespace sparsha::pipeline
