// Words are (height, colour): the largest of a pixel is the point nearest to the viewer.
#include "viewer/cloud/splat.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

namespace sparsha::viewer {
namespace {

constexpr std::size_t kMostLayers = 4;

/// Floats in the order of their bits.
std::uint32_t ordered(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}
float disordered(std::uint32_t word) {
  return std::bit_cast<float>((word & 0x80000000U) != 0 ? word & 0x7FFFFFFFU : ~word);
}

/// A row of the matrix from a point to pixels.
struct Row {
  float x, y, z, offset;
  [[nodiscard]] float of(const Eigen::Vector3f& p) const { return x * p.x() + y * p.y() + z * p.z() + offset; }
};

struct Mapping {
  Row x, y, height;
};

Mapping mapping_of(const SplatView& view) {
  const Eigen::Matrix3d scaled = view.pixels_per_m * view.scan_to_view;
  const auto row = [&](int k, double sign, double middle) {
    const Eigen::RowVector3d r = sign * scaled.row(k);
    return Row{static_cast<float>(r.x()), static_cast<float>(r.y()), static_cast<float>(r.z()),
               static_cast<float>(middle - r.dot(view.target_m))};
  };
  return {row(0, 1.0, 0.5 * view.width), row(1, -1.0, 0.5 * view.height), row(2, 1.0, 0.0)};
}

bool sees(const SplatView& view, const PointBlock& block) {
  return view.sees(block.low.cast<double>(), block.high.cast<double>());
}

}  // namespace

Eigen::Vector3d SplatView::to_pixel(const Eigen::Vector3d& point_m) const {
  const Eigen::Vector3d v = pixels_per_m * (scan_to_view * (point_m - target_m));
  return {0.5 * width + v.x(), 0.5 * height - v.y(), v.z()};
}

bool SplatView::sees(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m) const {
  const Eigen::Vector3d middle = to_pixel(0.5 * (low_m + high_m));
  const Eigen::Vector3d reach = pixels_per_m * (scan_to_view.cwiseAbs() * (0.5 * (high_m - low_m)));
  constexpr double kSplat = 8.0;
  return middle.x() + reach.x() >= -kSplat && middle.x() - reach.x() <= width + kSplat &&
         middle.y() + reach.y() >= -kSplat && middle.y() - reach.y() <= height + kSplat;
}

void Splatter::clear(const SplatView& view) {
  view_ = view;
  const std::size_t pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  layers_.resize(std::clamp<std::size_t>(pool_.threads(), 1, kMostLayers));
  pool_.for_ranges(layers_.size(), 1, [&](std::size_t layer, std::size_t) { layers_[layer].assign(pixels, 0); });
}

std::uint64_t Splatter::visible(const PointView& points) const {
  std::uint64_t count = 0;
  for (const PointBlock& block : points.blocks) count += sees(view_, block) ? block.count : 0;
  return count;
}

std::uint64_t Splatter::add(const PointView& points, const SplatColours& colours, const SplatCrop& crop, double from,
                            double to, int size) {
  std::vector<const PointBlock*> blocks;
  for (const PointBlock& block : points.blocks)
    if (sees(view_, block)) blocks.push_back(&block);
  if (blocks.empty()) return 0;  // a detail has thousands of parts, most of them beside the picture
  const Mapping map = mapping_of(view_);
  const int width = view_.width, height = view_.height, before = (size - 1) / 2;
  const auto steps = static_cast<float>(colours.heights.size());
  const double range = std::max(colours.high_m - colours.low_m, 1e-12) * view_.pixels_per_m;
  const float low = static_cast<float>(colours.low_m * view_.pixels_per_m);
  const auto per_pixel = static_cast<float>(steps / range);
  std::atomic<std::uint64_t> seen{0};
  const auto draw = [&](const PointBlock& block, std::vector<std::uint64_t>& layer) {
    // Every block gives at least its first point to a picture that begins anew.
    const auto part = [&](double share) {
      return block.begin + static_cast<std::uint32_t>(std::ceil(share * block.count));
    };
    const std::uint32_t end = std::min(part(to), block.begin + block.count);
    for (std::uint32_t n = part(from); n < end; ++n) {
      const Eigen::Vector3f& p = points.points[n];
      const float fx = map.x.of(p), fy = map.y.of(p), fz = map.height.of(p);
      // Also false for what is not a number.
      if (!(fx >= -8.0F && fx < static_cast<float>(width + 8) && fy >= -8.0F && fy < static_cast<float>(height + 8)))
        continue;
      if ((p.array() < crop.low.array()).any() || (p.array() > crop.high.array()).any()) continue;
      std::uint32_t colour = 0;
      if (!colours.point.empty()) {
        colour = colours.point[n];
      } else {
        const float at = std::clamp((fz - low) * per_pixel, 0.0F, steps - 1.0F);
        colour = colours.heights[static_cast<std::size_t>(at)];
      }
      const std::uint64_t word = static_cast<std::uint64_t>(ordered(fz)) << 32U | colour;
      const int left = static_cast<int>(std::floor(fx)) - before, top = static_cast<int>(std::floor(fy)) - before;
      const int x1 = std::min(left + size, width), y1 = std::min(top + size, height);
      for (int y = std::max(top, 0); y < y1; ++y) {
        std::uint64_t* row = layer.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
        for (int x = std::max(left, 0); x < x1; ++x) row[x] = std::max(row[x], word);
      }
    }
    return end - std::min(part(from), end);
  };
  // A layer takes every so-many-th block: its thread has it alone. One block needs no other thread.
  pool_.for_ranges(std::min(layers_.size(), blocks.size()), 1, [&](std::size_t layer, std::size_t) {
    std::uint64_t mine = 0;
    for (std::size_t k = layer; k < blocks.size(); k += layers_.size()) mine += draw(*blocks[k], layers_[layer]);
    seen += mine;
  });
  return seen;
}

void Splatter::read(std::vector<std::uint32_t>& rgba, std::vector<float>& heights) const {
  const auto width = static_cast<std::size_t>(view_.width), height = static_cast<std::size_t>(view_.height);
  rgba.resize(width * height);
  heights.resize(width * height);
  pool_.for_ranges(height, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      const std::size_t from = y * width, to = (height - 1 - y) * width;
      for (std::size_t x = 0; x < width; ++x) {
        std::uint64_t word = 0;
        for (const std::vector<std::uint64_t>& layer : layers_) word = std::max(word, layer[from + x]);
        rgba[to + x] = static_cast<std::uint32_t>(word);
        heights[to + x] = word == 0 ? kEmpty : disordered(static_cast<std::uint32_t>(word >> 32U));
      }
    }
  });
}

}  // namespace sparsha::viewer
