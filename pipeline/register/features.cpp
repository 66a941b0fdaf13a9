// The one file that instantiates PCL's FPFH, without its library, which would slow down every start.
#include "pipeline/register/features.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <queue>
#include <tuple>

#include <pcl/features/fpfh.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/features/impl/fpfh.hpp>

#include "pipeline/scan/pcl_trees.hpp"

namespace {
using Point = pcl::PointNormal;
}  // namespace

namespace pcl {

// What the library's pcl::computePairFeatures does: Darboux's frame between two points (Rusu 2009, "Fast Point Feature
// Histograms (FPFH) for 3D Registration").
template <>
// NOLINTNEXTLINE(readability-identifier-naming): the name is PCL's
inline bool FPFHEstimation<Point, Point, FPFHSignature33>::computePairFeatures(const pcl::PointCloud<Point>& cloud,
                                                                               const pcl::PointCloud<Point>& normals,
                                                                               int p, int q, float& f1, float& f2,
                                                                               float& f3, float& f4) {
  const auto at = [](int index) { return static_cast<std::size_t>(index); };
  Eigen::Vector3f line = cloud[at(q)].getVector3fMap() - cloud[at(p)].getVector3fMap();
  f1 = f2 = f3 = 0.0F;
  f4 = line.norm();
  if (!(f4 > 0.0F)) return false;
  line /= f4;
  Eigen::Vector3f from = normals[at(p)].getNormalVector3fMap();
  Eigen::Vector3f to = normals[at(q)].getNormalVector3fMap();
  f3 = from.dot(line);
  const float other = to.dot(line);
  if (std::fabs(f3) < std::fabs(other)) {  // the frame stands where the normal is nearer to the line
    std::swap(from, to);
    line = -line;
    f3 = -other;
  }
  Eigen::Vector3f v = line.cross(from);
  const float length = v.norm();
  if (!(length > 0.0F)) return false;
  v /= length;
  f2 = v.dot(to);
  f1 = std::atan2(from.cross(v).dot(to), from.dot(to));
  return true;
}

}  // namespace pcl

namespace sparsha::pipeline {
namespace {

using PclCloud = pcl::PointCloud<Point>;
using Fpfh = pcl::FPFHEstimation<Point, Point, pcl::FPFHSignature33>;

constexpr int kBins = 11;
constexpr int kNeighbours = 12;  // of the graph along which sides are passed on

// Turns normals so that neighbours agree, from the flattest place on (Hoppe 1992): one side for each connected part.
void agree_on_sides(PclCloud& cloud) {
  const auto shared = std::make_shared<PclCloud>(cloud);
  pcl::KdTreeFLANN<Point> tree;
  tree.setInputCloud(shared);
  std::vector<bool> done(cloud.size(), false);
  using Step = std::tuple<float, std::size_t, std::size_t>;  // |cosine|, from, to
  std::priority_queue<Step> queue;
  pcl::Indices indices;
  std::vector<float> distances2;
  const auto reach = [&](std::size_t index) {
    done[index] = true;
    tree.nearestKSearch(cloud[index], kNeighbours, indices, distances2);
    for (const pcl::index_t near : indices) {
      const auto to = static_cast<std::size_t>(near);
      if (done[to]) continue;
      const float cosine = cloud[index].getNormalVector3fMap().dot(cloud[to].getNormalVector3fMap());
      queue.emplace(std::fabs(cosine), index, to);
    }
  };
  for (std::size_t start = 0; start < cloud.size(); ++start) {
    if (done[start]) continue;
    reach(start);
    while (!queue.empty()) {
      const auto [weight, from, to] = queue.top();
      queue.pop();
      if (done[to]) continue;
      if (cloud[from].getNormalVector3fMap().dot(cloud[to].getNormalVector3fMap()) < 0.0F) {
        cloud[to].getNormalVector3fMap() = -cloud[to].getNormalVector3fMap().eval();
      }
      reach(to);
    }
  }
}

}  // namespace

ScanFeatures features_of(const StationSurface& surface, std::size_t most, double radius_m) {
  ScanFeatures result;
  result.any_side = !surface.signed_normals();
  auto cloud = std::make_shared<PclCloud>();
  std::vector<Eigen::Vector3d> candidates;
  std::vector<std::size_t> element_of;
  for (std::size_t i = 0; i < surface.elements().size(); ++i) {
    const StationSurface::Element& element = surface.elements()[i];
    if (element.normal.isZero(0.0)) continue;
    Point p;
    p.getVector3fMap() = (element.point / radius_m).cast<float>();
    p.getNormalVector3fMap() = element.normal.cast<float>();
    cloud->push_back(p);
    element_of.push_back(i);
    if (!element.border) candidates.push_back(element.point);
  }
  if (candidates.size() < 3) return result;
  if (result.any_side) agree_on_sides(*cloud);
  pcl::search::KdTree<Point>::Ptr tree = std::make_shared<pcl::search::KdTree<Point>>();
  tree->setInputCloud(cloud);
  auto chosen = std::make_shared<pcl::Indices>();
  pcl::Indices indices;
  std::vector<float> distances2;
  for (const Eigen::Vector3d& place : thinned_to(candidates, most, surface.spacing_m())) {
    Point p;
    p.getVector3fMap() = (place / radius_m).cast<float>();
    if (tree->nearestKSearch(p, 1, indices, distances2) < 1) continue;
    if (!surface.elements()[element_of[static_cast<std::size_t>(indices[0])]].border) chosen->push_back(indices[0]);
  }
  std::sort(chosen->begin(), chosen->end());
  chosen->erase(std::unique(chosen->begin(), chosen->end()), chosen->end());
  Fpfh fpfh;
  fpfh.setInputCloud(cloud);
  fpfh.setInputNormals(cloud);
  fpfh.setIndices(chosen);
  fpfh.setSearchMethod(tree);
  fpfh.setRadiusSearch(1.0);
  pcl::PointCloud<pcl::FPFHSignature33> signatures;
  fpfh.compute(signatures);
  for (std::size_t k = 0; k < chosen->size() && k < signatures.size(); ++k) {
    const auto index = static_cast<std::size_t>((*chosen)[k]);
    Descriptor descriptor{};
    std::copy_n(signatures[k].histogram, descriptor.size(), descriptor.begin());
    if (!std::all_of(descriptor.begin(), descriptor.end(), [](float v) { return std::isfinite(v); })) continue;
    result.points.push_back(surface.elements()[element_of[index]].point);
    result.normals.emplace_back((*cloud)[index].getNormalVector3fMap().cast<double>().normalized());
    result.descriptors.push_back(descriptor);
  }
  return result;
}

ScanFeatures turned(ScanFeatures features) {
  for (Eigen::Vector3d& normal : features.normals) normal = -normal;
  // Two of the three angles change their sign, which the third has not.
  for (Descriptor& descriptor : features.descriptors) {
    std::reverse(descriptor.begin(), descriptor.begin() + kBins);
    std::reverse(descriptor.begin() + 2 * kBins, descriptor.end());
  }
  return features;
}

}  // namespace sparsha::pipeline
