// The outlier filter beside PCL's own, in all the ways that PCL's filters are used.
#include "sparsha/pcl/statistical_outlier_filter.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/point_types.h>

#include "base/error.h"

namespace sparsha {
namespace {

using Points = ::pcl::PointCloud<::pcl::PointXYZ>;

Points::Ptr sheet_with_dust(std::size_t points = 5000) {
  Points::Ptr cloud(new Points);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(0.0F, 1.0F);
  std::normal_distribution<float> noise;
  for (std::size_t i = 0; i < points; ++i) {
    cloud->push_back(
        {place(random), place(random), 0.001F * noise(random) + (i % 100 == 0 ? 0.2F * place(random) : 0.0F)});
  }
  return cloud;
}

::pcl::Indices expected_of(const Points::Ptr& cloud, bool negative) {
  ::pcl::StatisticalOutlierRemoval<::pcl::PointXYZ> filter;
  filter.setInputCloud(cloud);
  filter.setMeanK(12);
  filter.setStddevMulThresh(1.5);
  filter.setNegative(negative);
  ::pcl::Indices indices;
  filter.filter(indices);
  return indices;
}

StatisticalOutlierFilter<::pcl::PointXYZ> filter_of(const Points::Ptr& cloud, bool extract = false) {
  StatisticalOutlierFilter<::pcl::PointXYZ> filter(extract);
  filter.setInputCloud(cloud);
  filter.setMeanK(12);
  filter.setStddevMulThresh(1.5);
  return filter;
}

TEST(StatisticalOutlierFilter, KeepsWhatPclsKeepsAndItsNegativeTheRest) {
  const auto cloud = sheet_with_dust();
  for (const bool negative : {false, true}) {
    auto filter = filter_of(cloud);
    filter.setNegative(negative);
    ::pcl::Indices indices;
    filter.filter(indices);
    EXPECT_EQ(indices, expected_of(cloud, negative));
    EXPECT_FALSE(indices.empty());
  }
}

TEST(StatisticalOutlierFilter, TellsWhatItTookAway) {
  const auto cloud = sheet_with_dust();
  auto filter = filter_of(cloud, true);
  Points clean;
  filter.filter(clean);
  EXPECT_EQ(*filter.getRemovedIndices(), expected_of(cloud, true));
  EXPECT_EQ(clean.size() + filter.getRemovedIndices()->size(), cloud->size());
}

TEST(StatisticalOutlierFilter, KeepsAnOrganizedCloudOrganized) {
  const auto cloud = sheet_with_dust();
  const ::pcl::Indices outliers = expected_of(cloud, true);  // PCL searches organized clouds as if they were pictures
  cloud->width = 100;
  cloud->height = 50;
  auto filter = filter_of(cloud, true);
  filter.setKeepOrganized(true);
  Points clean;
  filter.filter(clean);
  EXPECT_EQ(clean.width, 100U);
  EXPECT_EQ(clean.height, 50U);
  ASSERT_FALSE(outliers.empty());
  for (const ::pcl::index_t i : outliers) EXPECT_TRUE(std::isnan(clean[static_cast<std::size_t>(i)].x));
}

TEST(StatisticalOutlierFilter, LooksAtTheIndicesOnly) {
  const auto cloud = sheet_with_dust();
  const ::pcl::IndicesPtr half(new ::pcl::Indices);
  Points::Ptr copy(new Points);
  for (std::size_t i = 0; i < cloud->size() / 2; ++i) {
    half->push_back(static_cast<::pcl::index_t>(2 * i));
    copy->push_back((*cloud)[2 * i]);
  }
  auto filter = filter_of(cloud);
  filter.setIndices(half);
  ::pcl::Indices indices;
  filter.filter(indices);
  ::pcl::Indices expected = expected_of(copy, false);
  for (::pcl::index_t& i : expected) i *= 2;
  EXPECT_EQ(indices, expected);
}

TEST(StatisticalOutlierFilter, TakesAwayWhatIsNotFiniteAndTheRestStaysAsItIs) {
  const auto cloud = sheet_with_dust();
  const Points::Ptr holes(new Points(*cloud));
  holes->insert(holes->begin(), ::pcl::PointXYZ(0.5F, std::numeric_limits<float>::quiet_NaN(), 0.0F));
  holes->is_dense = false;
  auto filter = filter_of(holes, true);
  ::pcl::Indices indices;
  filter.filter(indices);
  ::pcl::Indices expected = expected_of(cloud, false);
  for (::pcl::index_t& i : expected) ++i;
  EXPECT_EQ(indices, expected);
  EXPECT_EQ(filter.getRemovedIndices()->front(), 0);
}

TEST(StatisticalOutlierFilter, TheNumberOfThreadsDoesNotMatter) {
  const auto cloud = sheet_with_dust(50000);
  ::pcl::Indices one;
  for (const unsigned threads : {1U, 3U}) {
    auto filter = filter_of(cloud);
    filter.setNumberOfThreads(threads);
    ::pcl::Indices indices;
    filter.filter(indices);
    if (threads == 1) one = indices;
    EXPECT_EQ(indices, one);
  }
}

TEST(StatisticalOutlierFilter, SmallCloudsAndImpossibleSettings) {
  const auto cloud = sheet_with_dust(3);
  auto filter = filter_of(cloud);
  ::pcl::Indices indices;
  filter.filter(indices);
  EXPECT_LE(indices.size(), 3U);
  filter.setMeanK(0);
  EXPECT_THROW(filter.filter(indices), Error);
}

}  // namespace
}  // namespace sparsha
