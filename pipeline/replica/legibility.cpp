#include "pipeline/replica/legibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/png/png.h"
#include "pipeline/images/images.h"

namespace sparsha::pipeline {
namespace {

constexpr double kPixel_mm = 0.5;
/// Colours that the colour-blind tell apart (Okabe and Ito 2008), for grey, felt and crowded.
constexpr std::array<std::array<double, 3>, 3> kColours{{{170, 170, 170}, {86, 180, 233}, {230, 159, 0}}};

}  // namespace

void write_legibility(const ReplicaPlate& plate, const std::filesystem::path& file, ReplicaReport& report) {
  // The relief alone, from the top row down.
  const int rows = plate.ny - plate.first_row;
  Image fine{rows, plate.nx, std::vector<float>(static_cast<std::size_t>(rows) * static_cast<std::size_t>(plate.nx))};
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < plate.nx; ++i) fine.at(rows - 1 - j, i) = plate.at(i, plate.first_row + j);
  const double narrowest = 1.0 / std::min(rows, plate.nx);  // a narrow relief has a row of pixels
  const double share = std::min(1.0, std::max(plate.spacing_mm / kPixel_mm, narrowest));
  const Image height = images().shrink(std::move(fine), share);
  const double pixel_mm = plate.spacing_mm * plate.nx / height.columns;
  const int gap = 2 * static_cast<int>(std::lround(0.5 * kLeastGap_mm / pixel_mm)) + 1;
  const Image highest = images().dilate(height, gap);
  const Image lowest = images().erode(height, gap);
  const Image closed = images().erode(highest, gap);
  const Image opened = images().dilate(lowest, gap);
  PngFormat format;
  format.width = height.columns;
  format.height = height.rows;
  format.pixel_m = 1e-3 * pixel_mm;
  format.description =
      "Legibility by touch. Grey: nothing of 0.5 mm within 5 mm. Blue: features are felt. Orange: grooves or ridges of "
      "0.5 mm that are narrower than 5 mm run together.";
  std::vector<std::uint8_t> pixels;
  pixels.reserve(height.values.size() * 3);
  std::uint64_t felt = 0;
  std::uint64_t crowded = 0;
  const auto shade = [&](int y, int x) {
    const double slope =
        static_cast<double>(height.at(y, x)) - static_cast<double>(height.at(std::max(0, y - 1), std::max(0, x - 1)));
    return std::clamp(1.0 + 0.35 * slope / pixel_mm, 0.45, 1.25);
  };
  for (int y = 0; y < height.rows; ++y)
    for (int x = 0; x < height.columns; ++x) {
      const float here = height.at(y, x);
      const auto least = static_cast<float>(kLeastFeature_mm);
      const bool narrow = closed.at(y, x) - here >= least || here - opened.at(y, x) >= least;
      const bool feature = highest.at(y, x) - lowest.at(y, x) >= least;
      felt += feature ? 1 : 0;
      crowded += narrow ? 1 : 0;
      const auto& colour = kColours[narrow ? 2U : feature ? 1U : 0U];
      const double light = shade(y, x);
      for (const double channel : colour)
        pixels.push_back(static_cast<std::uint8_t>(std::clamp(channel * light, 0.0, 255.0)));
    }
  report.felt = static_cast<double>(felt) / static_cast<double>(height.values.size());
  report.crowded = static_cast<double>(crowded) / static_cast<double>(height.values.size());
  write_png(file, format, pixels);
}

}  // namespace sparsha::pipeline
