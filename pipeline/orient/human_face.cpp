// Pictures are made smaller until a face has the width of the made one; then their relief is correlated.
#include "pipeline/orient/human_face.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace sparsha::pipeline {
namespace {

constexpr int kWidth = 20;                    // pixels: of the made face
constexpr double kFine = 1.2, kCoarse = 2.8;  // pixels: of its relief; eyes and lips are 2 to 4 pixels high
constexpr float kMostRelief = 1.0F;           // pixels
constexpr int kBeside = 2;                    // pixels, that a face may lie off the axis
constexpr double kPresent = 0.9;              // of a face must be there
constexpr double kLeastVariance = 0.002;      // of the relief, squared pixels: flatter is no carving
constexpr double kSmooth = 0.01;              // added to it, so that shallow chance counts less
// Of the width of a face over 20 pixels; the widest is half of the diagonal of a head.
constexpr std::array kShrinks = {1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0};

// A bump of height 1 at a place, in widths of a face from the bridge of its nose, x aside and y up.
struct Bump {
  double height, x, y, wide, high;
  [[nodiscard]] double at(double px, double py) const {
    const double dx = (px - x) / wide;
    const double dy = (py - y) / high;
    return height * std::exp(-0.5 * (dx * dx + dy * dy));
  }
};

// Both sides: brow, socket, eyeball, wing of the nose, cheek.
constexpr std::array kPairs = {Bump{0.05, 0.2, 0.13, 0.13, 0.055}, Bump{-0.075, 0.2, 0.0, 0.1, 0.075},
                               Bump{0.03, 0.2, -0.01, 0.055, 0.035}, Bump{0.04, 0.09, -0.28, 0.04, 0.04},
                               Bump{0.035, 0.26, -0.2, 0.1, 0.09}};
// In the middle: back and tip of the nose, lips, the line between them, the hollow below, chin.
constexpr std::array kMiddle = {Bump{0.07, 0.0, -0.08, 0.05, 0.13}, Bump{0.14, 0.0, -0.25, 0.07, 0.08},
                                Bump{0.05, 0.0, -0.47, 0.13, 0.07}, Bump{-0.035, 0.0, -0.465, 0.12, 0.018},
                                Bump{-0.04, 0.0, -0.58, 0.1, 0.03}, Bump{0.06, 0.0, -0.7, 0.12, 0.07}};

double made_height(double x, double y) {
  constexpr double kHeadWide = 0.62;  // half axes of the ellipsoid under it
  constexpr double kHeadHigh = 0.95;
  constexpr double kHeadDeep = 0.55;
  constexpr double kHeadMiddle = -0.2;
  const double left = 1.0 - std::pow(x / kHeadWide, 2.0) - std::pow((y - kHeadMiddle) / kHeadHigh, 2.0);
  if (left <= 0.02) return std::numeric_limits<double>::quiet_NaN();
  double height = kHeadDeep * std::sqrt(left);
  for (const Bump& bump : kPairs) height += bump.at(std::abs(x), y);
  for (const Bump& bump : kMiddle) height += bump.at(x, y);
  return height;
}

// The relief of the made face, of mean 0 and length 1.
struct MadeFace {
  struct Pixel {
    int x, y;
    float relief;
  };
  std::vector<Pixel> pixels;
};

MadeFace make_face() {
  constexpr int kHalf = 32;
  SidePicture picture;
  picture.side = 2 * kHalf + 1;
  for (int y = -kHalf; y <= kHalf; ++y)
    for (int x = -kHalf; x <= kHalf; ++x)
      picture.height.push_back(
          static_cast<float>(kWidth * made_height(x / static_cast<double>(kWidth), y / static_cast<double>(kWidth))));
  const std::vector<float> relief = relief_of(picture, kFine, kCoarse, kMostRelief);
  // From brow to chin and from cheek to cheek.
  constexpr double kMiddleY = -0.23;
  constexpr double kHalfHigh = 0.58;
  MadeFace face;
  double sum = 0.0;
  for (int y = -kHalf; y <= kHalf; ++y) {
    for (int x = -kWidth / 2; x <= kWidth / 2; ++x) {
      const double u = 2.0 * x / kWidth;
      const double v = (y / static_cast<double>(kWidth) - kMiddleY) / kHalfHigh;
      if (u * u + v * v > 1.0) continue;
      face.pixels.push_back({x, y, relief[picture.index(x + kHalf, y + kHalf)]});
      sum += static_cast<double>(face.pixels.back().relief);
    }
  }
  const double mean = sum / static_cast<double>(face.pixels.size());
  double squares = 0.0;
  for (MadeFace::Pixel& pixel : face.pixels) {
    pixel.relief -= static_cast<float>(mean);
    squares += static_cast<double>(pixel.relief) * static_cast<double>(pixel.relief);
  }
  for (MadeFace::Pixel& pixel : face.pixels) pixel.relief /= static_cast<float>(std::sqrt(squares));
  return face;
}

// The same in fewer pixels: means of what lies in front.
SidePicture shrunk(const SidePicture& picture, double by) {
  constexpr double kBehind = 3.0;  // new pixels
  SidePicture small;
  small.side = static_cast<int>(picture.side / by);
  for (int y = 0; y < small.side; ++y) {
    for (int x = 0; x < small.side; ++x) {
      const int left = static_cast<int>(x * by);
      const int low = static_cast<int>(y * by);
      const int right = std::max(left + 1, static_cast<int>((x + 1) * by));
      const int high = std::max(low + 1, static_cast<int>((y + 1) * by));
      float first = -std::numeric_limits<float>::infinity();
      for (int v = low; v < high; ++v)
        for (int u = left; u < right; ++u) first = std::fmax(first, picture.height[picture.index(u, v)]);
      float sum = 0.0F;
      int count = 0;
      for (int v = low; v < high; ++v) {
        for (int u = left; u < right; ++u) {
          const float height = picture.height[picture.index(u, v)];
          if (!(height > first - static_cast<float>(kBehind * by))) continue;  // NaN, too
          sum += height;
          ++count;
        }
      }
      small.height.push_back(2 * count >= (right - left) * (high - low)
                                 ? sum / (static_cast<float>(count) * static_cast<float>(by))
                                 : std::numeric_limits<float>::quiet_NaN());
    }
  }
  return small;
}

// Of a face with the bridge of its nose there; `way` is 1 for an upright one, else -1.
double correlation(const MadeFace& face, const SidePicture& picture, const std::vector<float>& relief, int x, int y,
                   int way) {
  double product = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (const MadeFace::Pixel& pixel : face.pixels) {
    const int u = x + way * pixel.x;
    const int v = y + way * pixel.y;
    if (u < 0 || v < 0 || u >= picture.side || v >= picture.side) continue;
    const std::size_t n = picture.index(u, v);
    if (std::isnan(picture.height[n])) continue;
    const auto value = static_cast<double>(relief[n]);
    product += value * static_cast<double>(pixel.relief);
    sum += value;
    squares += value * value;
    count += 1.0;
  }
  if (count < kPresent * static_cast<double>(face.pixels.size())) return -1.0;
  const double variance = squares - sum * sum / count;
  return variance < kLeastVariance * count ? -1.0 : product / std::sqrt(variance + kSmooth * count);
}

}  // namespace

std::array<double, 2> face_likeness(const SidePicture& picture, double axis) {
  static const MadeFace face = make_face();
  std::array<double, 2> best = {-1.0, -1.0};
  for (const double by : kShrinks) {
    const SidePicture small = shrunk(picture, by);
    const std::vector<float> relief = relief_of(small, kFine, kCoarse, kMostRelief);
    const int middle = static_cast<int>(std::lround(axis / by));
    for (int y = 0; y < small.side; ++y) {
      for (int x = std::max(0, middle - kBeside); x <= std::min(small.side - 1, middle + kBeside); ++x) {
        if (std::isnan(small.height[small.index(x, y)])) continue;
        best[0] = std::max(best[0], correlation(face, small, relief, x, y, 1));
        best[1] = std::max(best[1], correlation(face, small, relief, x, y, -1));
      }
    }
  }
  return best;
}

}  // namespace sparsha::pipeline
