// The six pictures by which a front is chosen that the points leave open.
#include "pipeline/orient/thumbnails.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <vector>

namespace sparsha::pipeline {
namespace {

// A box of 1 x 2 x 0.5 with a bump on its front, +z.
std::vector<Eigen::Vector3d> box() {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  std::vector<Eigen::Vector3d> points;
  while (points.size() < 60'000) {
    Eigen::Vector3d p(unit(random), unit(random), unit(random));
    const auto axis = static_cast<Eigen::Index>(points.size() % 3);
    p[axis] = p[axis] < 0.0 ? -0.5 : 0.5;
    p = p.cwiseProduct(Eigen::Vector3d(1.0, 2.0, 0.5));
    const double bump = 0.2 - p.head<2>().norm();
    if (axis == 2 && p.z() > 0.0 && bump > 0.0) p.z() += bump;
    points.push_back(p);
  }
  return points;
}

std::size_t covered(const Thumbnail& thumbnail) {
  return thumbnail.grey.size() -
         static_cast<std::size_t>(std::count(thumbnail.grey.begin(), thumbnail.grey.end(), Thumbnail::kNothing));
}

// Greys about the middle of the picture that differ from the median there.
std::size_t uneven(const Thumbnail& thumbnail) {
  std::vector<std::uint8_t> middle;
  const int half = thumbnail.side / 2;
  const int reach = thumbnail.side / 10;
  for (int y = half - reach; y <= half + reach; ++y)
    for (int x = half - reach; x <= half + reach; ++x)
      middle.push_back(thumbnail.grey[static_cast<std::size_t>(y * thumbnail.side + x)]);
  std::vector<std::uint8_t> sorted = middle;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  const int median = sorted[sorted.size() / 2];
  return static_cast<std::size_t>(
      std::count_if(middle.begin(), middle.end(), [&](int grey) { return std::abs(grey - median) > 20; }));
}

TEST(Thumbnails, ShowTheSixSidesAtOneScaleAndWhatIsCarvedOnThem) {
  const std::vector<Thumbnail> sides =
      six_thumbnails(even_points(box()), Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY());
  ASSERT_EQ(sides.size(), 6U);
  const std::vector<std::string> names = {"front", "back", "left", "right", "top", "bottom"};
  for (std::size_t k = 0; k < sides.size(); ++k) {
    EXPECT_EQ(sides[k].name, names[k]);
    EXPECT_EQ(sides[k].grey.size(), static_cast<std::size_t>(sides[k].side) * static_cast<std::size_t>(sides[k].side));
  }
  // The front has 1 x 2, the sides 2 x (0.5 and the bump), the top 1 x 0.5.
  const auto area = [&](std::size_t k) { return static_cast<double>(covered(sides[k])); };
  EXPECT_NEAR(area(0) / area(1), 1.0, 0.02);
  EXPECT_NEAR(area(2) / area(0), 0.5, 0.08);
  EXPECT_NEAR(area(4) / area(0), 0.25, 0.08);
  EXPECT_GT(uneven(sides[0]), 5 * std::max<std::size_t>(1, uneven(sides[1]))) << "the bump is on the front alone";
}

TEST(Thumbnails, OfNothingThereAreNone) {
  EXPECT_TRUE(six_thumbnails(EvenPoints{}, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY()).empty());
}

}  // namespace
}  // namespace sparsha::pipeline
