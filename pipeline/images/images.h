// Image functions of OpenCV, loaded when the first of them is called: linked to the program, OpenCV and what it needs
// itself (BLAS, LAPACK, TBB) would take a third of the time that every command needs to start.
#pragma once

#include <vector>

namespace sparsha::pipeline {

/// Values in rows, row by row; no value is NaN.
struct Image {
  int rows = 0;
  int columns = 0;
  std::vector<float> values;

  [[nodiscard]] float& at(int row, int column) { return values[index(row, column)]; }
  [[nodiscard]] float at(int row, int column) const { return values[index(row, column)]; }

 private:
  [[nodiscard]] std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
};

/// Pure functions, from any thread.
class Images {
 public:
  virtual ~Images() = default;

  /// cv::bilateralFilter: sigmas in pixels and in the values' unit, mirrored at the border without its last pixel.
  [[nodiscard]] virtual Image bilateral(Image image, int diameter, double sigma_range, double sigma_space) const = 0;
  /// Fewer pixels, each the mean of the area that it stands for; `share` in (0, 1] of each side.
  [[nodiscard]] virtual Image shrink(Image image, double share) const = 0;
  /// The greatest and the least value within a disc of `diameter` pixels (an odd number).
  [[nodiscard]] virtual Image dilate(Image image, int diameter) const = 0;
  [[nodiscard]] virtual Image erode(Image image, int diameter) const = 0;
};

/// Throws Error (failure) when the library that holds them is not beside the program.
[[nodiscard]] const Images& images();

}  // namespace sparsha::pipeline
