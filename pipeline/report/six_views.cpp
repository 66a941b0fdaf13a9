// Nodes as squares into a depth buffer: first the nearest depth of each pixel, then the mean light of the nodes that
// are about there.
#include "pipeline/report/six_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

constexpr int kSide = 330;  // pixels of a view
constexpr int kGap = 11;    // pixels between views
constexpr int kColumns = 3;
constexpr int kRows = 2;
constexpr double kFacing = 0.05;  // least cosine towards the viewer
constexpr double kAmbient = 0.2;

/// Axes of a view in the grid frame.
struct View {
  Eigen::Vector3d right, up;
  [[nodiscard]] Eigen::Vector3d towards() const { return right.cross(up); }
};

std::array<View, kColumns * kRows> views() {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  return {View{z, y}, View{x, y}, View{-z, y}, View{x, -z}, View{-x, y}, View{x, z}};
}

struct Node {
  Eigen::Vector3d place, normal;
};

/// Every `step`-th node of each sheet both ways, about the middle of their box.
std::vector<Node> nodes_of(const scene::Charts& charts, int step) {
  std::vector<Node> nodes;
  for (const scene::Sheet& sheet : charts.sheets) {
    for (int j = 0; j < sheet.ny; j += step) {
      for (int i = 0; i < sheet.nx; i += step) {
        if (!sheet.measured(sheet.index(i, j))) continue;
        nodes.push_back({charts.place_m(sheet, i, j), scene::Charts::normal(sheet, i, j)});
      }
    }
  }
  return nodes;
}

class Canvas {
 public:
  /// `spacing_m` of the nodes that are drawn.
  Canvas(double pixel_m, double spacing_m)
      : pixel_m_(pixel_m),
        spacing_m_(spacing_m),
        square_(static_cast<int>(std::ceil(1.5 * spacing_m / pixel_m))),
        depth_(kPixels, -std::numeric_limits<double>::infinity()),
        light_(kPixels),
        count_(kPixels) {}

  void draw(const View& view, const std::vector<Node>& nodes) {
    const Eigen::Vector3d towards = view.towards();
    const Eigen::Vector3d lamp = (-0.5 * view.right + 0.6 * view.up + 0.65 * towards).normalized();
    for (const Node& node : nodes) {
      if (node.normal.dot(towards) < kFacing) continue;
      const double depth = node.place.dot(towards);
      each_pixel(view, node, [&](std::size_t k) { depth_[k] = std::max(depth_[k], depth); });
    }
    for (const Node& node : nodes) {
      if (node.normal.dot(towards) < kFacing) continue;
      const double depth = node.place.dot(towards);
      const double light = kAmbient + (1.0 - kAmbient) * std::max(0.0, node.normal.dot(lamp));
      each_pixel(view, node, [&](std::size_t k) {
        if (depth < depth_[k] - 2.0 * spacing_m_) return;
        light_[k] += light;
        ++count_[k];
      });
    }
  }

  void copy(Field& field, int left, int top) const {
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        const std::size_t k = index(column, row);
        if (count_[k] > 0) field.at(left + column, top + row) = static_cast<float>(light_[k] / count_[k]);
      }
    }
  }

 private:
  static constexpr std::size_t kPixels = static_cast<std::size_t>(kSide) * kSide;
  double pixel_m_, spacing_m_;
  int square_;
  std::vector<double> depth_, light_;
  std::vector<int> count_;

  static std::size_t index(int column, int row) {
    return static_cast<std::size_t>(row) * kSide + static_cast<std::size_t>(column);
  }
  template <typename Use>
  void each_pixel(const View& view, const Node& node, const Use& use) const {
    const double u = node.place.dot(view.right) / pixel_m_ + 0.5 * kSide;
    const double v = 0.5 * kSide - node.place.dot(view.up) / pixel_m_;
    const int first_column = static_cast<int>(std::floor(u - 0.5 * (square_ - 1)));
    const int first_row = static_cast<int>(std::floor(v - 0.5 * (square_ - 1)));
    for (int row = std::max(0, first_row); row < std::min(kSide, first_row + square_); ++row) {
      for (int column = std::max(0, first_column); column < std::min(kSide, first_column + square_); ++column) {
        use(index(column, row));
      }
    }
  }
};

}  // namespace

SixViews six_views(const scene::Charts& charts) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  for (const scene::Sheet& sheet : charts.sheets) {
    for (int j = 0; j < sheet.ny; ++j) {
      for (int i = 0; i < sheet.nx; ++i) {
        if (!sheet.measured(sheet.index(i, j))) continue;
        const Eigen::Vector3d place = charts.place_m(sheet, i, j);
        low = low.cwiseMin(place);
        high = high.cwiseMax(place);
      }
    }
  }
  const double pixel_m = std::max((high - low).maxCoeff(), charts.spacing_m) / (0.94 * kSide);
  const int step = std::max(1, static_cast<int>(pixel_m / charts.spacing_m));
  std::vector<Node> nodes = nodes_of(charts, step);
  for (Node& node : nodes) node.place -= 0.5 * (low + high);
  SixViews result{Field(kColumns * kSide + (kColumns - 1) * kGap, kRows * kSide + (kRows - 1) * kGap), 0.0};
  result.width_m = result.light.width * pixel_m;
  const auto all = views();
  for (std::size_t k = 0; k < all.size(); ++k) {
    Canvas canvas(pixel_m, step * charts.spacing_m);
    canvas.draw(all[k], nodes);
    const int column = static_cast<int>(k) % kColumns;
    const int row = static_cast<int>(k) / kColumns;
    canvas.copy(result.light, column * (kSide + kGap), row * (kSide + kGap));
  }
  return result;
}

}  // namespace sparsha::pipeline
