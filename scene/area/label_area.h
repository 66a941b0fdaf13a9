// A picture of whole numbers that lies over a scene, and the place that one of its numbers takes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace sparsha::scene {

/// A picture of labels that lies over `bounds_m`. Immutable once made; any thread.
struct LabelMap {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> values;  ///< row 0 is the top, which has the largest y
  std::array<double, 4> bounds_m{};   ///< xmin ymin xmax ymax, borders included
  /// 0 outside. No allocation.
  [[nodiscard]] int at(double x_m, double y_m) const noexcept;
};

/// The pixels of one label, also in several pieces, and how far a place is from their border. Immutable; any thread;
/// questions allocate nothing and take the same time for every picture.
class LabelArea {
 public:
  enum class Border { none, measured };  ///< none: for questions to holds() alone

  /// With its border it keeps the distances of at most 2^22 samples around the label's pixels, 4 bytes each, and takes
  /// some 0.1 us a sample; of more pixels every second one is a sample, or every fourth and so on.
  LabelArea(std::shared_ptr<const LabelMap> map, int label, Border border = Border::measured);

  /// No pixel has the label.
  [[nodiscard]] bool empty() const noexcept { return pixels_ == 0; }
  [[nodiscard]] bool holds(double x_m, double y_m) const noexcept { return map_->at(x_m, y_m) == label_; }
  /// From a place inside to the border, negative outside. Along straight borders of square pixels it is exact; round
  /// their corners it differs by up to half a pixel and goes on without a jump. Farther outside than 2 % of the picture
  /// it is at most the distance. Needs Border::measured; a finite place.
  [[nodiscard]] double inside_m(double x_m, double y_m) const noexcept;
  /// The middle of the pixel that lies deepest; empty when there is none.
  [[nodiscard]] const std::optional<std::array<double, 2>>& deepest_m() const noexcept { return deepest_m_; }
  /// xmin ymin xmax ymax of the label's pixels; zeros when there are none.
  [[nodiscard]] const std::array<double, 4>& bounds_m() const noexcept { return bounds_m_; }
  [[nodiscard]] double area_m2() const noexcept { return area_m2_; }
  /// Closed lines round the pieces and their holes, longest first, within a pixel of the pixels' own borders: the last
  /// point is the first once more. Needs Border::measured; some 0.1 s for the largest.
  [[nodiscard]] std::vector<std::vector<Eigen::Vector2d>> borders_m() const;

  [[nodiscard]] const std::shared_ptr<const LabelMap>& map() const noexcept { return map_; }
  [[nodiscard]] int label() const noexcept { return label_; }

 private:
  void measure(int first_column, int last_column, int first_row, int last_row);
  [[nodiscard]] double sample(int i, int j) const noexcept {
    return static_cast<double>(
        inside_m_[static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i)]);
  }

  std::shared_ptr<const LabelMap> map_;
  int label_;
  std::size_t pixels_ = 0;
  std::array<double, 4> bounds_m_{};
  double area_m2_ = 0.0;
  std::optional<std::array<double, 2>> deepest_m_;
  // Samples, row 0 at the bottom; sample (i, j) lies at first_m_ + (i, j) * step_m_.
  int nx_ = 0, ny_ = 0;
  std::array<double, 2> first_m_{};
  std::array<double, 2> step_m_{};
  std::vector<float> inside_m_;
};

}  // namespace sparsha::scene
