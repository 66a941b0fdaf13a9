// Distances of samples by the transform of Felzenszwalb & Huttenlocher (2012), and their zero line.
#include "scene/area/label_area.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "scene/ground/contours.h"

namespace sparsha::scene {
namespace {

constexpr std::size_t kMostSamples = std::size_t{1} << 22U;
constexpr std::size_t kMostTraced = std::size_t{1} << 18U;
/// Around the label's pixels, of the picture's longer side: the border over which a part fades is 2 % of a scene or
/// less, half of it outside.
constexpr double kRoom = 0.02;
constexpr int kLeastRoom = 2;  // samples
constexpr float kNone = 1e30F;

int sample_count(double length, double step) { return static_cast<int>(std::ceil(length / step)); }

/// Of each sample to the nearest that is `wanted`, squared, metres; kNone or more where there is none.
std::vector<float> squared_distances(const std::vector<std::uint8_t>& inside, std::uint8_t wanted, int nx, int ny,
                                     const std::array<double, 2>& step_m) {
  const auto at = [nx](int i, int j) {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  };
  std::vector<float> result(inside.size(), kNone);
  // Along columns the nearest is found by looking down and up.
  for (int i = 0; i < nx; ++i) {
    for (const bool up : {false, true}) {
      double distance_m = std::numeric_limits<double>::infinity();
      for (int k = 0; k < ny; ++k) {
        const std::size_t here = at(i, up ? ny - 1 - k : k);
        distance_m = inside[here] == wanted ? 0.0 : distance_m + step_m[1];
        if (distance_m < std::numeric_limits<double>::infinity())
          result[here] = std::min(result[here], static_cast<float>(distance_m * distance_m));
      }
    }
  }
  // Along rows it is the lower envelope of the columns' parabolas.
  std::vector<int> peaks(static_cast<std::size_t>(nx));
  std::vector<double> from_m(static_cast<std::size_t>(nx));
  std::vector<double> heights(static_cast<std::size_t>(nx));
  for (int j = 0; j < ny; ++j) {
    int count = 0;
    for (int i = 0; i < nx; ++i) {
      const auto height = static_cast<double>(result[at(i, j)]);
      if (height >= static_cast<double>(kNone)) continue;
      const double x_m = i * step_m[0];
      double begins_m = -std::numeric_limits<double>::infinity();
      while (count > 0) {
        const auto last = static_cast<std::size_t>(count - 1);
        const double p_m = peaks[last] * step_m[0];
        begins_m = ((height + x_m * x_m) - (heights[last] + p_m * p_m)) / (2.0 * (x_m - p_m));
        if (begins_m > from_m[last]) break;
        begins_m = -std::numeric_limits<double>::infinity();
        --count;
      }
      const auto next = static_cast<std::size_t>(count++);
      peaks[next] = i;
      from_m[next] = begins_m;
      heights[next] = height;
    }
    int peak = 0;
    for (int i = 0; i < nx && count > 0; ++i) {
      const double x_m = i * step_m[0];
      while (peak + 1 < count && from_m[static_cast<std::size_t>(peak) + 1] <= x_m) ++peak;
      const double way_m = x_m - peaks[static_cast<std::size_t>(peak)] * step_m[0];
      result[at(i, j)] = static_cast<float>(way_m * way_m + heights[static_cast<std::size_t>(peak)]);
    }
  }
  return result;
}

}  // namespace

int LabelMap::at(double x_m, double y_m) const noexcept {
  if (!(x_m >= bounds_m[0] && y_m >= bounds_m[1] && x_m <= bounds_m[2] && y_m <= bounds_m[3])) return 0;
  if (!(bounds_m[0] < bounds_m[2] && bounds_m[1] < bounds_m[3])) return 0;
  const auto pixel = [](double share, int count) {
    return std::min(count - 1, static_cast<int>(share * static_cast<double>(count)));
  };
  const int column = pixel((x_m - bounds_m[0]) / (bounds_m[2] - bounds_m[0]), width);
  const int row = pixel((bounds_m[3] - y_m) / (bounds_m[3] - bounds_m[1]), height);
  return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
}

LabelArea::LabelArea(std::shared_ptr<const LabelMap> map, int label, Border border)
    : map_(std::move(map)), label_(label) {
  int left = map_->width;
  int right = -1;
  int top = map_->height;
  int bottom = -1;
  const std::uint16_t* value = map_->values.data();
  for (int row = 0; row < map_->height; ++row)
    for (int column = 0; column < map_->width; ++column) {
      if (*value++ != label) continue;
      ++pixels_;
      left = std::min(left, column);
      right = std::max(right, column);
      top = std::min(top, row);
      bottom = row;
    }
  if (empty()) return;
  const auto& bounds = map_->bounds_m;
  const double width_m = (bounds[2] - bounds[0]) / map_->width;
  const double height_m = (bounds[3] - bounds[1]) / map_->height;
  if (!(width_m > 0.0 && height_m > 0.0)) {  // over a grid of a single row of nodes
    pixels_ = 0;
    return;
  }
  bounds_m_ = {bounds[0] + left * width_m, bounds[3] - (bottom + 1) * height_m, bounds[0] + (right + 1) * width_m,
               bounds[3] - top * height_m};
  area_m2_ = static_cast<double>(pixels_) * width_m * height_m;
  if (border == Border::measured) measure(left, right, map_->height - 1 - bottom, map_->height - 1 - top);
}

// Columns and rows are those of the label's pixels, rows counted from the bottom.
void LabelArea::measure(int first_column, int last_column, int first_row, int last_row) {
  const auto& bounds = map_->bounds_m;
  const std::array<double, 2> pixel_m{(bounds[2] - bounds[0]) / map_->width, (bounds[3] - bounds[1]) / map_->height};
  const double room_m = kRoom * std::max(bounds[2] - bounds[0], bounds[3] - bounds[1]);
  int stride = 1;
  std::array<int, 2> room{};
  const auto lay_out = [&] {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      step_m_[axis] = stride * pixel_m[axis];
      room[axis] = kLeastRoom + sample_count(room_m, step_m_[axis]);
    }
    nx_ = (last_column - first_column) / stride + 1 + 2 * room[0];
    ny_ = (last_row - first_row) / stride + 1 + 2 * room[1];
    return static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_) <= kMostSamples;
  };
  while (!lay_out()) stride *= 2;
  first_m_ = {bounds[0] + (first_column + 0.5) * pixel_m[0] - room[0] * step_m_[0],
              bounds[1] + (first_row + 0.5) * pixel_m[1] - room[1] * step_m_[1]};
  std::vector<std::uint8_t> inside(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_), 0);
  const auto& values = map_->values;
  for (int j = room[1]; j < ny_ - room[1]; ++j)
    for (int i = room[0]; i < nx_ - room[0]; ++i) {
      const int column = first_column + (i - room[0]) * stride;
      const int row = map_->height - 1 - (first_row + (j - room[1]) * stride);
      const auto pixel =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(map_->width) + static_cast<std::size_t>(column);
      inside[static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i)] =
          values[pixel] == label_ ? 1 : 0;
    }
  // Between the middles of two pixels lies their border.
  const double half_m = 0.5 * std::min(step_m_[0], step_m_[1]);
  const std::vector<float> to_inside = squared_distances(inside, 1, nx_, ny_, step_m_);
  inside_m_ = squared_distances(inside, 0, nx_, ny_, step_m_);
  std::size_t deepest = 0;
  for (std::size_t k = 0; k < inside.size(); ++k) {
    const double way_m = std::sqrt(static_cast<double>(inside[k] != 0 ? inside_m_[k] : to_inside[k])) - half_m;
    inside_m_[k] = static_cast<float>(inside[k] != 0 ? way_m : -way_m);
    if (inside_m_[k] > inside_m_[deepest]) deepest = k;
  }
  const auto columns = static_cast<std::size_t>(nx_);
  deepest_m_ = {first_m_[0] + static_cast<double>(deepest % columns) * step_m_[0],
                first_m_[1] + static_cast<double>(deepest / columns) * step_m_[1]};
  if (inside[deepest] != 0) return;
  // All samples missed it.
  const auto pixel = static_cast<std::size_t>(
      std::find(values.begin(), values.end(), static_cast<std::uint16_t>(label_)) - values.begin());
  const auto width = static_cast<std::size_t>(map_->width);
  deepest_m_ = {bounds[0] + (static_cast<double>(pixel % width) + 0.5) * pixel_m[0],
                bounds[3] - (static_cast<double>(pixel / width) + 0.5) * pixel_m[1]};
}

double LabelArea::inside_m(double x_m, double y_m) const noexcept {
  constexpr double kNowhere = -std::numeric_limits<double>::infinity();
  if (inside_m_.empty()) return kNowhere;
  const double u = (x_m - first_m_[0]) / step_m_[0];
  const double v = (y_m - first_m_[1]) / step_m_[1];
  const double near_u = std::clamp(u, 0.0, static_cast<double>(nx_ - 1));
  const double near_v = std::clamp(v, 0.0, static_cast<double>(ny_ - 1));
  const int i = std::min(static_cast<int>(near_u), nx_ - 2);
  const int j = std::min(static_cast<int>(near_v), ny_ - 2);
  const double s = near_u - i;
  const double t = near_v - j;
  const double inside = (1.0 - t) * ((1.0 - s) * sample(i, j) + s * sample(i + 1, j)) +
                        t * ((1.0 - s) * sample(i, j + 1) + s * sample(i + 1, j + 1));
  if (u == near_u && v == near_v) return inside;
  return inside - std::hypot((u - near_u) * step_m_[0], (v - near_v) * step_m_[1]);
}

std::vector<std::vector<Eigen::Vector2d>> LabelArea::borders_m() const {
  if (inside_m_.empty()) return {};
  int stride = 1;
  int nx = nx_;
  int ny = ny_;
  while (static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) > kMostTraced) {
    stride *= 2;
    nx = (nx_ - 1) / stride + 2;
    ny = (ny_ - 1) / stride + 2;
  }
  const auto value = [&](int i, int j) { return sample(std::min(i * stride, nx_ - 1), std::min(j * stride, ny_ - 1)); };
  std::vector<Contour> lines = trace_contours(nx, ny, [&](int i, int j, bool up) {
    const double here = value(i, j);
    const double there = up ? value(i, j + 1) : value(i + 1, j);
    if ((here > 0.0) == (there > 0.0)) return std::numeric_limits<double>::quiet_NaN();
    return here / (here - there);
  });
  constexpr int kSmoothings = 2;
  constexpr double kTolerance = 0.1;  // samples
  std::stable_sort(lines.begin(), lines.end(),
                   [](const Contour& a, const Contour& b) { return a.length() > b.length(); });
  std::vector<std::vector<Eigen::Vector2d>> borders;
  for (Contour& line : lines) {
    smooth(line, kSmoothings);
    simplify(line, kTolerance);
    std::vector<Eigen::Vector2d> border;
    for (const Eigen::Vector2d& point : line.points)
      border.emplace_back(first_m_[0] + point.x() * stride * step_m_[0], first_m_[1] + point.y() * stride * step_m_[1]);
    if (border.size() > 3) borders.push_back(std::move(border));
  }
  return borders;
}

}  // namespace sparsha::scene
