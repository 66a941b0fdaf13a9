// Clouds to Sparsha and back: nothing is lost but what is not finite.
#include "sparsha/pcl/conversions.h"

#include <limits>

#include <gtest/gtest.h>
#include <pcl/point_types.h>

#include "base/error.h"
#include "sparsha/pcl/impl/conversions.hpp"

namespace sparsha {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

template <typename PointT>
::pcl::PointCloud<PointT> three_points() {
  ::pcl::PointCloud<PointT> cloud;
  cloud.resize(4);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto v = static_cast<float>(i);
    cloud[i].x = 0.1F + v;
    cloud[i].y = -0.7F * v;
    cloud[i].z = 3.0F - v;
  }
  cloud[1].y = kNan;
  return cloud;
}

template <typename PointT>
::pcl::PointCloud<PointT> there_and_back(const ::pcl::PointCloud<PointT>& cloud) {
  ::pcl::PointCloud<PointT> back;
  from_cloud(to_cloud(cloud), back);
  return back;
}

template <typename PointT>
void expect_points_without_the_second(const ::pcl::PointCloud<PointT>& back) {
  const auto cloud = three_points<PointT>();
  ASSERT_EQ(back.size(), 3U);
  EXPECT_EQ(back.width, 3U);
  EXPECT_EQ(back.height, 1U);
  EXPECT_TRUE(back.is_dense);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(back[i].getVector3fMap(), cloud[i == 0 ? 0 : i + 1].getVector3fMap());
  }
}

TEST(PclConversions, PositionsComeBackAndPointsThatAreNotFiniteAreCounted) {
  const auto cloud = three_points<::pcl::PointXYZ>();
  EXPECT_EQ(to_cloud(cloud).invalid, 1U);
  expect_points_without_the_second(there_and_back(cloud));
}

TEST(PclConversions, ColoursComeBackAndAreInTheOrderOfOurReaders) {
  auto cloud = three_points<::pcl::PointXYZRGBA>();
  cloud[2].r = 1;
  cloud[2].g = 2;
  cloud[2].b = 3;
  cloud[2].a = 4;
  EXPECT_EQ(to_cloud(cloud).rgba.at(1), 0x04030201U);
  const auto back = there_and_back(cloud);
  expect_points_without_the_second(back);
  EXPECT_EQ(back[1].rgba, cloud[2].rgba);
  auto opaque = three_points<::pcl::PointXYZRGB>();
  opaque[3].r = 200;
  EXPECT_EQ(there_and_back(opaque)[2].rgba, opaque[3].rgba);
}

TEST(PclConversions, IntensityAndNormalsComeBack) {
  auto intensity = three_points<::pcl::PointXYZI>();
  intensity[3].intensity = 0.75F;
  EXPECT_EQ(there_and_back(intensity)[2].intensity, 0.75F);
  auto normals = three_points<::pcl::PointNormal>();
  normals[2].getNormalVector3fMap() = Eigen::Vector3f(0.6F, 0.0F, 0.8F);
  const auto back = there_and_back(normals);
  expect_points_without_the_second(back);
  EXPECT_EQ(back[1].getNormalVector3fMap(), Eigen::Vector3f(0.6F, 0.0F, 0.8F));
}

TEST(PclConversions, TypesThatAreNotInstantiatedConvertThroughTheImplementationHeader) {
  auto cloud = three_points<::pcl::PointXYZINormal>();
  cloud[0].intensity = 2.0F;
  EXPECT_EQ(there_and_back(cloud)[0].intensity, 2.0F);
}

TEST(PclConversions, IndicesChooseAndTheirPlacesAreTold) {
  const auto cloud = three_points<::pcl::PointXYZ>();
  ::pcl::Indices kept;
  const pipeline::Cloud chosen = to_cloud(cloud, {3, 1, 0}, Eigen::Vector3d::Zero(), &kept);
  EXPECT_EQ(chosen.size(), 2U);
  EXPECT_EQ(kept, (::pcl::Indices{3, 0}));
  EXPECT_EQ(chosen.invalid, 1U);
  EXPECT_EQ(chosen.xyz1()[0], cloud[3].x);
}

TEST(PclConversions, AnIndexThatTheCloudDoesNotHaveIsAnError) {
  const auto cloud = three_points<::pcl::PointXYZ>();
  EXPECT_THROW((void)to_cloud(cloud, ::pcl::Indices{0, 4}), Error);
  EXPECT_THROW((void)to_cloud(cloud, ::pcl::Indices{-1}), Error);
}

TEST(PclConversions, ASensorAwayFromZeroBecomesAStationAndComesBack) {
  auto cloud = three_points<::pcl::PointXYZ>();
  EXPECT_TRUE(to_cloud(cloud).stations.empty());
  cloud.sensor_origin_ = Eigen::Vector4f(1.0F, 2.0F, 3.0F, 0.0F);
  const Eigen::Vector3d origin_m(500000.0, 4000000.0, 100.0);
  const pipeline::Cloud georeferenced = to_cloud(cloud, origin_m);
  ASSERT_EQ(georeferenced.stations.size(), 1U);
  EXPECT_EQ(georeferenced.stations[0].place_m, origin_m + Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(georeferenced.stations[0].seen_m.size(), 3U);
  ::pcl::PointCloud<::pcl::PointXYZ> back;
  from_cloud(georeferenced, back);
  EXPECT_EQ(back.sensor_origin_, cloud.sensor_origin_);
}

TEST(PclConversions, NormalsTellTheOuterSideAndAreNoStation) {
  auto cloud = three_points<::pcl::PointNormal>();
  for (auto& point : cloud) point.getNormalVector3fMap() = Eigen::Vector3f(0.0F, 0.0F, 2.0F);
  cloud[3].normal_x = kNan;
  const pipeline::Cloud told = to_cloud(cloud);
  ASSERT_EQ(told.stations.size(), 1U);
  EXPECT_EQ(told.stations[0].seen_m.size(), 2U) << "of four points one is no point and one has no normal";
  for (const Eigen::Vector3f& normal : told.stations[0].normals) EXPECT_EQ(normal, Eigen::Vector3f::UnitZ());
  ::pcl::PointCloud<::pcl::PointNormal> back;
  from_cloud(told, back);
  EXPECT_TRUE(back.sensor_origin_.isZero(0.0F));
}

TEST(PclConversions, AnEmptyCloudStaysEmpty) {
  const ::pcl::PointCloud<::pcl::PointXYZRGB> cloud;
  EXPECT_TRUE(there_and_back(cloud).empty());
}

}  // namespace
}  // namespace sparsha
