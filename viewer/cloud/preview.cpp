// Bins an even sample of the points and keeps the nearest of each cell.
#include "viewer/cloud/preview.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "viewer/cloud/bounds.h"
#include "viewer/cloud/orientation.h"

namespace sparsha::viewer {
namespace {

constexpr double kMostCells = 320.0;  // along the longer side

}  // namespace

SplatCrop crop_of(const ScanSetup& setup, const PointView& points) {
  SplatCrop crop;
  if (!setup.crop) return crop;
  crop.low = (setup.crop->min_m - points.origin_m).cast<float>();
  crop.high = (setup.crop->max_m - points.origin_m).cast<float>();
  return crop;
}

bool same_crop(const std::optional<scene::CropConfig>& a, const std::optional<scene::CropConfig>& b) {
  return a.has_value() == b.has_value() && (!a || (a->min_m == b->min_m && a->max_m == b->max_m));
}

DepthPreview preview_of(const PointView& points, const ScanSetup& setup, std::size_t at_most) {
  DepthPreview preview;
  if (points.points.empty()) return preview;
  const double share = std::min(1.0, static_cast<double>(at_most) / static_cast<double>(points.points.size()));
  const SplatCrop crop = crop_of(setup, points);
  const Eigen::Matrix3f linear = setup.scan_to_grid.topLeftCorner<3, 3>().cast<float>();
  std::vector<Eigen::Vector3f> places;
  places.reserve(static_cast<std::size_t>(share * static_cast<double>(points.points.size())) + points.blocks.size());
  for (const PointBlock& block : points.blocks) {
    const auto count = static_cast<std::uint32_t>(std::ceil(share * block.count));
    for (std::uint32_t n = block.begin; n < block.begin + std::min(count, block.count); ++n) {
      const Eigen::Vector3f& p = points.points[n];
      if ((p.array() >= crop.low.array()).all() && (p.array() <= crop.high.array()).all())
        places.emplace_back(linear * p);
    }
  }
  if (places.empty()) return preview;
  preview.any = true;
  const Bounds bounds = bounds_of(places);
  const Eigen::Vector3f &low = bounds.low, &high = bounds.high;
  const Eigen::Vector3d origin = (setup.scan_to_grid * points.origin_m.homogeneous()).head<3>();
  preview.low_m = origin + low.cast<double>();
  preview.high_m = origin + high.cast<double>();

  const Eigen::Vector3d size = preview.size_m();
  const double longer = std::max({size.x(), size.y(), 1e-9});
  const double spacing = points.spacing_m * scale_of(setup.scan_to_grid) / std::sqrt(share);
  preview.cell_m = std::max(longer / kMostCells, 1.5 * spacing);
  preview.nx = std::max(1, static_cast<int>(std::ceil(size.x() / preview.cell_m)));
  preview.ny = std::max(1, static_cast<int>(std::ceil(size.y() / preview.cell_m)));
  preview.height_m.assign(static_cast<std::size_t>(preview.nx) * static_cast<std::size_t>(preview.ny),
                          std::numeric_limits<float>::quiet_NaN());
  const auto per_m = static_cast<float>(1.0 / preview.cell_m);
  for (const Eigen::Vector3f& p : places) {
    if (!bounds.contains(p)) continue;
    const int i = std::min(static_cast<int>((p.x() - low.x()) * per_m), preview.nx - 1);
    const int j = std::min(static_cast<int>((p.y() - low.y()) * per_m), preview.ny - 1);
    float& cell =
        preview
            .height_m[static_cast<std::size_t>(j) * static_cast<std::size_t>(preview.nx) + static_cast<std::size_t>(i)];
    const float height = p.z() - low.z();
    if (!(cell >= height)) cell = height;
  }
  const auto seen = std::ranges::count_if(preview.height_m, [](float h) { return !std::isnan(h); });
  preview.coverage = static_cast<double>(seen) / static_cast<double>(preview.height_m.size());
  return preview;
}

std::vector<std::uint32_t> shade(const DepthPreview& preview) {
  const auto nx = static_cast<std::size_t>(preview.nx), ny = static_cast<std::size_t>(preview.ny);
  std::vector<std::uint32_t> picture(nx * ny);
  constexpr std::uint32_t kNothing = 0xFF5A2A50U;  // violet: no stone and no scan has this colour
  const float depth = std::max(static_cast<float>(preview.size_m().z()), 1e-9F);
  const auto at = [&](std::size_t i, std::size_t j) { return preview.height_m[j * nx + i]; };
  for (std::size_t j = 0; j < ny; ++j)
    for (std::size_t i = 0; i < nx; ++i) {
      const float h = at(i, j);
      std::uint32_t& pixel = picture[(ny - 1 - j) * nx + i];
      pixel = kNothing;
      if (std::isnan(h)) continue;
      // Light from the upper left on slopes; a little of the height.
      const auto slope = [&](float next) { return std::isnan(next) ? 0.0F : (h - next) / (2.0F * depth); };
      const float right = i + 1 < nx ? slope(at(i + 1, j)) : 0.0F, below = j > 0 ? slope(at(i, j - 1)) : 0.0F;
      const float light = std::clamp(0.35F + 0.35F * h / depth + 6.0F * (0.6F * below - 0.6F * right), 0.05F, 1.0F);
      const auto grey = static_cast<std::uint32_t>(245.0F * light);
      pixel = 0xFF000000U | (grey * 9 / 10) << 16U | (grey * 19 / 20) << 8U | grey;
    }
  return picture;
}

}  // namespace sparsha::viewer
