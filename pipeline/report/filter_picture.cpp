// Points as small squares into a depth buffer, which is then shaded.
#include "pipeline/report/filter_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/numbers/statistics.h"
#include "base/text/text.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

constexpr int kLongSide = 960;    // pixels
constexpr int kShortSide = 240;   // at least
constexpr double kMargin = 0.03;  // of the view's extent, at each side
constexpr int kShades = 30;       // of each colour
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Rgb kBackground{0xF6, 0xF7, 0xF8};
constexpr Rgb kKeptColour{0xD9, 0xD6, 0xCF};
/// Of Okabe & Ito (2008): told apart with any colour vision.
constexpr std::array<Rgb, 7> kColours{{{0xE6, 0x9F, 0x00},
                                       {0x56, 0xB4, 0xE9},
                                       {0x00, 0x9E, 0x73},
                                       {0xD5, 0x5E, 0x00},
                                       {0xCC, 0x79, 0xA7},
                                       {0x00, 0x72, 0xB2},
                                       {0xF0, 0xE4, 0x42}}};

static_assert(1 + (1 + kColours.size()) * kShades <= 256, "one palette");

/// Points of one colour in the view's frame: x right, y up, z towards the viewer.
struct Layer {
  Rgb colour;
  std::size_t tone = 0;  ///< place of the colour in the palette; 0 is what is left, and colours repeat after seven
  bool outliers = false;
  std::vector<Eigen::Vector3d> points;
};

Eigen::Matrix4d view_from_scan(const scene::SceneDescription& scene) {
  constexpr double kYaw = -28 * kDegree;
  constexpr double kPitch = 24 * kDegree;
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(kPitch, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(kYaw, Eigen::Vector3d::UnitY()))
          .toRotationMatrix();
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.topLeftCorner<3, 3>() = turn;
  return view * scene.scan_from_grid.inverse();
}

std::vector<Layer> layers_of(const scene::SceneDescription& scene, const Report& report) {
  const Eigen::Matrix4d view = view_from_scan(scene);
  const auto seen = [&](const std::vector<Eigen::Vector3d>& points) {
    std::vector<Eigen::Vector3d> result;
    result.reserve(points.size());
    for (const Eigen::Vector3d& p : points) result.emplace_back((view * p.homogeneous()).head<3>());
    return result;
  };
  std::vector<Layer> layers{{kKeptColour, 0, false, seen(report.kept_m)}};
  for (std::size_t k = 0; k < report.filters.size(); ++k) {
    const Report::Filter& filter = report.filters[k];
    if (filter.sample_m.empty()) continue;
    const std::size_t colour = (layers.size() - 1) % kColours.size();
    layers.push_back({kColours[colour], 1 + colour, filter.outliers, seen(filter.sample_m)});
  }
  return layers;
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  [[nodiscard]] double width() const { return high - low; }
};

/// What is shown: nearly all of the points left and of those taken away but outliers, about what is left.
Range extent(const std::vector<Layer>& layers, Eigen::Index axis) {
  constexpr double kRank = 0.005;
  constexpr double kWidest = 12.0;  // extents of what is left
  Range all;
  Range kept;
  for (const Layer& layer : layers) {
    if (layer.outliers || layer.points.empty()) continue;
    std::vector<double> values;
    for (const Eigen::Vector3d& p : layer.points) values.push_back(p[axis]);
    const double low = quantile(values, kRank);
    const double high = quantile(values, 1.0 - kRank);
    all = {std::min(all.low, low), std::max(all.high, high)};
    if (&layer == &layers.front()) kept = all;
  }
  const double most = kWidest * kept.width();
  if (most > 0.0) all = {std::max(all.low, kept.low - most), std::min(all.high, kept.high + most)};
  const double margin = kMargin * all.width();
  return {all.low - margin, all.high + margin};
}

/// Nearest point of each pixel.
struct Buffer {
  int width, height;
  std::vector<double> depth;        ///< towards the viewer
  std::vector<std::uint8_t> layer;  ///< 0: nothing; else 1 + the layer's tone

  Buffer(int w, int h)
      : width(w),
        height(h),
        depth(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), -std::numeric_limits<double>::infinity()),
        layer(depth.size(), 0) {}
  [[nodiscard]] std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
  void put(int column, int row, double z, std::uint8_t l) {
    if (column < 0 || row < 0 || column >= width || row >= height) return;
    const std::size_t n = at(column, row);
    if (layer[n] != 0 && (z < depth[n] || (z == depth[n] && l >= layer[n]))) return;
    depth[n] = z;
    layer[n] = l;
  }
};

/// How dark a pixel is by nearer ones about it, 0 to 1.
double light(const Buffer& buffer, int column, int row, double depth_range) {
  constexpr double kStrength = 14.0;
  constexpr int kReach = 2;
  const double here = buffer.depth[buffer.at(column, row)];
  double nearer = 0.0;
  for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, 1}, {-1, 1}, {1, -1}}) {
    for (int reach = 1; reach <= kReach; ++reach) {
      const int x = column + reach * dx;
      const int y = row + reach * dy;
      if (x < 0 || y < 0 || x >= buffer.width || y >= buffer.height || buffer.layer[buffer.at(x, y)] == 0) continue;
      nearer += std::clamp((buffer.depth[buffer.at(x, y)] - here) / depth_range, 0.0, 0.05);
    }
  }
  return std::exp(-kStrength * nearer / kReach);
}

Rgb shaded(const Rgb& colour, double share) {
  const auto part = [&](std::uint8_t c) { return static_cast<std::uint8_t>(std::lround(c * (0.22 + 0.78 * share))); };
  return {part(colour.r), part(colour.g), part(colour.b)};
}

/// Side of a point's square, pixels: wide enough to close a surface that fills a part of the layer's bounding box.
int square_side(const std::vector<Eigen::Vector3d>& points, double pixel) {
  constexpr double kFill = 1.5;
  constexpr int kLeast = 3;
  constexpr int kMost = 7;
  Range x;
  Range y;
  for (const Eigen::Vector3d& p : points) {
    x = {std::min(x.low, p.x()), std::max(x.high, p.x())};
    y = {std::min(y.low, p.y()), std::max(y.high, p.y())};
  }
  const double area =
      x.width() * y.width() / (pixel * pixel) / static_cast<double>(std::max<std::size_t>(1, points.size()));
  return std::clamp(static_cast<int>(std::min(kFill * std::sqrt(std::max(0.0, area)), 100.0)), kLeast, kMost);
}

void paint(Picture& picture, const Buffer& buffer, const std::vector<Layer>& layers) {
  picture.palette[0] = kBackground;
  for (const Layer& layer : layers) {
    for (int k = 0; k < kShades; ++k) {
      const std::size_t index = 1 + layer.tone * kShades + static_cast<std::size_t>(k);
      picture.palette[index] = shaded(layer.colour, k / (kShades - 1.0));
    }
  }
  Range depth;
  for (std::size_t n = 0; n < buffer.depth.size(); ++n) {
    if (buffer.layer[n] == 0) continue;
    depth = {std::min(depth.low, buffer.depth[n]), std::max(depth.high, buffer.depth[n])};
  }
  const double range = std::max(depth.width(), 1e-12);
  picture.width = buffer.width;
  picture.height = buffer.height;
  picture.pixels.assign(buffer.layer.size(), 0);
  for (int row = 0; row < buffer.height; ++row) {
    for (int column = 0; column < buffer.width; ++column) {
      const std::size_t n = buffer.at(column, row);
      if (buffer.layer[n] == 0) continue;
      const double near = 0.75 + 0.25 * (buffer.depth[n] - depth.low) / range;
      const double value = near * light(buffer, column, row, range);
      const int shade = std::clamp(static_cast<int>(value * kShades), 0, kShades - 1);
      picture.pixels[n] = static_cast<std::uint8_t>(1 + (buffer.layer[n] - 1) * kShades + shade);
    }
  }
}

void describe(Picture& picture, const std::vector<Layer>& layers, const Report& report) {
  picture.caption =
      "The scanned points, seen from above to the right of the viewer: grey is what the filters left, and each colour "
      "is what one of them took away. Points that only thin out the scan (voxel, thin) are not shown.";
  if (layers.size() > 1 + kColours.size()) picture.caption += " There are more filters than colours: colours repeat.";
  picture.alternative = "View of the scanned points.";
  std::size_t l = 0;
  for (const Report::Filter& filter : report.filters) {
    if (filter.sample_m.empty()) continue;
    ++l;
    const std::string count = count_text(filter.removed, TextStyle::typeset);
    picture.alternative += fmt::format(" {} took {} of {} points away.", filter.name, count,
                                       count_text(report.points.read, TextStyle::typeset));
    picture.entries.push_back({fmt::format("{}: {}", filter.name, count), layers[l].colour});
  }
  picture.entries.insert(picture.entries.begin(), {"left by the filters", kKeptColour});
}

}  // namespace

bool has_filter_picture(const Report& report) {
  return !report.kept_m.empty() && std::any_of(report.filters.begin(), report.filters.end(),
                                               [](const Report::Filter& f) { return !f.sample_m.empty(); });
}

Picture filter_picture(const scene::SceneDescription& scene, const Report& report) {
  Picture picture;
  picture.name = "filters";
  picture.title = "What the filters took away";
  picture.legend = Picture::Legend::entries;
  const std::vector<Layer> layers = layers_of(scene, report);
  const Range x = extent(layers, 0);
  const Range y = extent(layers, 1);
  const double longer = std::max({x.width(), y.width(), 1e-12});
  const double pixel = longer / kLongSide;
  const auto pixels = [&](const Range& range) {
    return std::clamp(static_cast<int>(std::ceil(range.width() / pixel)), kShortSide, kLongSide);
  };
  Buffer buffer(pixels(x), pixels(y));
  const double left = 0.5 * (x.low + x.high) - 0.5 * buffer.width * pixel;
  const double top = 0.5 * (y.low + y.high) + 0.5 * buffer.height * pixel;
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const int size = layers[l].outliers ? 5 : square_side(layers[l].points, pixel);
    for (const Eigen::Vector3d& p : layers[l].points) {
      const double u = (p.x() - left) / pixel;
      const double v = (top - p.y()) / pixel;
      if (!(u >= 0.0 && v >= 0.0 && u < buffer.width && v < buffer.height)) continue;
      for (int k = 0; k < size * size; ++k) {
        buffer.put(static_cast<int>(u) + k % size - size / 2, static_cast<int>(v) + k / size - size / 2, p.z(),
                   static_cast<std::uint8_t>(1 + layers[l].tone));
      }
    }
  }
  picture.width_m = buffer.width * pixel;
  paint(picture, buffer, layers);
  describe(picture, layers, report);
  return picture;
}

}  // namespace sparsha::pipeline
