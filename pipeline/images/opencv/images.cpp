#include "pipeline/images/images.h"

#include <cstddef>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace sparsha::pipeline {
namespace {

/// The same values, not a copy of them.
cv::Mat view(Image& image) { return {image.rows, image.columns, CV_32F, image.values.data()}; }

Image make_image(int rows, int columns) {
  return {rows, columns, std::vector<float>(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns))};
}

cv::Mat disc(int diameter) { return cv::getStructuringElement(cv::MORPH_ELLIPSE, {diameter, diameter}); }

class OpenCvImages final : public Images {
 public:
  [[nodiscard]] Image bilateral(Image image, int diameter, double sigma_range, double sigma_space) const override {
    Image result = make_image(image.rows, image.columns);
    cv::Mat filtered = view(result);
    cv::bilateralFilter(view(image), filtered, diameter, sigma_range, sigma_space, cv::BORDER_REFLECT_101);
    return result;
  }

  [[nodiscard]] Image shrink(Image image, double share) const override {
    cv::Mat smaller;
    cv::resize(view(image), smaller, {}, share, share, cv::INTER_AREA);
    return {smaller.rows, smaller.cols, {smaller.ptr<float>(), smaller.ptr<float>() + smaller.total()}};
  }

  [[nodiscard]] Image dilate(Image image, int diameter) const override {
    Image result = make_image(image.rows, image.columns);
    cv::Mat highest = view(result);
    cv::dilate(view(image), highest, disc(diameter));
    return result;
  }

  [[nodiscard]] Image erode(Image image, int diameter) const override {
    Image result = make_image(image.rows, image.columns);
    cv::Mat lowest = view(result);
    cv::erode(view(image), lowest, disc(diameter));
    return result;
  }
};

}  // namespace
}  // namespace sparsha::pipeline

extern "C" const sparsha::pipeline::Images* sparsha_opencv_images();

extern "C" const sparsha::pipeline::Images* sparsha_opencv_images() {
  static const sparsha::pipeline::OpenCvImages kImages;
  return &kImages;
}
