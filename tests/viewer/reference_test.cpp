// Every view and mode against its picture in tests/viewer/reference, made by viewer_pictures --reference FILE.
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cstdlib>

#include "tests/viewer/views.h"

namespace sparsha::viewer::test {
namespace {

Image read_picture(const char* file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&png, file) == 0) return {};
  png.format = PNG_FORMAT_RGBA;
  Image image{static_cast<int>(png.width), static_cast<int>(png.height),
              std::vector<unsigned char>(PNG_IMAGE_SIZE(png))};
  if (png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr) == 0) return {};
  return image;
}

struct Difference {
  double mean = 0.0;   ///< of a channel, of 255
  double share = 0.0;  ///< of pixels that differ by more than kSeen in a channel
};
constexpr int kSeen = 20;

Difference between(const Image& a, const Image& b) {
  Difference difference;
  const std::size_t pixels = a.rgba.size() / 4;
  for (std::size_t p = 0; p < pixels; ++p) {
    int most = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const int by = std::abs(a.rgba[4 * p + c] - b.rgba[4 * p + c]);
      difference.mean += by / (3.0 * static_cast<double>(pixels));
      most = std::max(most, by);
    }
    difference.share += (most > kSeen ? 1.0 : 0.0) / static_cast<double>(pixels);
  }
  return difference;
}

// Drivers round differently and place edges up to half a pixel apart: a pixel here is the mean of 16.
constexpr double kMean = 1.5, kShare = 0.01;
const char* const kMissing =
    "viewer_pictures --reference tests/viewer/reference/views.png makes the pictures; look at them";

TEST(Reference, EveryViewAndModeLooksAsItsPictureWithinTheTolerance) {
  const Image sheet = read_picture(SPARSHA_SOURCE_DIR "/tests/viewer/reference/views.png");
  const std::vector<NamedView> views = all_views();
  if (sheet.width == 0) GTEST_SKIP() << kMissing;
  ASSERT_EQ(sheet.width, kSheetColumns * kSmallWidth) << kMissing;
  ASSERT_EQ(sheet.height, (static_cast<int>(views.size()) + kSheetColumns - 1) / kSheetColumns * kSmallHeight);
  const auto scene = exhibit();
  for (std::size_t k = 0; k < views.size(); ++k) {
    const Difference d = between(draw_small(scene, views[k]), of_sheet(sheet, k));
    EXPECT_LT(d.mean, kMean) << views[k].name;
    EXPECT_LT(d.share, kShare) << views[k].name;
  }
}

TEST(Reference, NoTwoPicturesAreAlikeWithinTheTolerance) {
  const Image sheet = read_picture(SPARSHA_SOURCE_DIR "/tests/viewer/reference/views.png");
  const std::vector<NamedView> views = all_views();
  if (sheet.width == 0) GTEST_SKIP() << kMissing;
  // The outline's line and the dots of filled areas are lost in the sheet's small pictures.
  const auto is_thin = [](const NamedView& view) { return view.name == "outline" || view.name == "filled"; };
  for (std::size_t a = 0; a < views.size(); ++a)
    for (std::size_t b = a + 1; b < views.size(); ++b) {
      if (is_thin(views[a]) || is_thin(views[b])) continue;
      const Difference d = between(of_sheet(sheet, a), of_sheet(sheet, b));
      EXPECT_TRUE(d.mean >= kMean || d.share >= kShare) << views[a].name << " is taken for " << views[b].name;
    }
}

}  // namespace
}  // namespace sparsha::viewer::test
