// The one file that instantiates PCL's ICP and GICP, in double.
#include "pipeline/register/pairwise.h"

#include <cmath>
#include <memory>
#include <vector>

#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/correspondence_rejection.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/transformation_estimation_point_to_plane_lls.h>

#include "pipeline/register/match.h"
#include "pipeline/scan/pcl_trees.hpp"
#include "pipeline/scan/quiet_pcl.h"

namespace sparsha::pipeline {
namespace {

using Point = pcl::PointNormal;
using PclCloud = pcl::PointCloud<Point>;
using Icp = pcl::IterativeClosestPoint<Point, Point, double>;
using Gicp = pcl::GeneralizedIterativeClosestPoint<Point, Point, double>;
using Covariances = Gicp::MatricesVector;

constexpr std::size_t kLeastPoints = 20;
constexpr double kAcrossOverAlong = 1e-2;  // variance across the surface over along it, in GICP's covariances

/// Elements as PCL wants them. Lengths are in spacings of the target: PCL's tolerances are absolute.
struct PclSurface {
  PclCloud::Ptr cloud = std::make_shared<PclCloud>();
  std::shared_ptr<Covariances> covariances = std::make_shared<Covariances>();

  void add(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
    Point p;
    p.getVector3fMap() = point.cast<float>();
    p.getNormalVector3fMap() = normal.cast<float>();
    cloud->push_back(p);
    covariances->push_back(Eigen::Matrix3d::Identity() - (1.0 - kAcrossOverAlong) * normal * normal.transpose());
  }
};

/// What pcl::registration::CorrespondenceRejectorSurfaceNormal does: keeps pairs whose normals point the same way. That
/// class is no template, so that it alone would ask for libpcl_registration at every start.
class RejectOtherNormals : public pcl::registration::CorrespondenceRejector {
 public:
  explicit RejectOtherNormals(double least_cosine) : least_cosine_(least_cosine) {
    rejection_name_ = "RejectOtherNormals";
  }

  void getRemainingCorrespondences(const pcl::Correspondences& pairs, pcl::Correspondences& kept) override {
    kept.clear();
    for (const pcl::Correspondence& pair : pairs) {
      const auto from = source_[static_cast<std::size_t>(pair.index_query)].getNormalVector3fMap();
      const auto to = target_[static_cast<std::size_t>(pair.index_match)].getNormalVector3fMap();
      if (from.cast<double>().dot(to.cast<double>()) > least_cosine_) kept.push_back(pair);
    }
  }
  [[nodiscard]] bool requiresSourceNormals() const override { return true; }
  void setSourceNormals(pcl::PCLPointCloud2::ConstPtr cloud) override { pcl::fromPCLPointCloud2(*cloud, source_); }
  [[nodiscard]] bool requiresTargetNormals() const override { return true; }
  void setTargetNormals(pcl::PCLPointCloud2::ConstPtr cloud) override { pcl::fromPCLPointCloud2(*cloud, target_); }

 private:
  void applyRejection(pcl::Correspondences& kept) override {
    getRemainingCorrespondences(*input_correspondences_, kept);
  }

  double least_cosine_;
  PclCloud source_, target_;
};

template <typename Registration>
Eigen::Isometry3d run(Registration& registration, double distance, int iterations) {
  registration.setMaxCorrespondenceDistance(distance);
  registration.setMaximumIterations(iterations);
  registration.setTransformationEpsilon(1e-4);
  PclCloud aligned;
  registration.align(aligned);
  Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
  const Eigen::Matrix4d found = registration.getFinalTransformation();
  if (!found.allFinite()) return moved;
  moved.linear() = Eigen::Quaterniond(Eigen::Matrix3d(found.topLeftCorner<3, 3>())).normalized().toRotationMatrix();
  moved.translation() = found.topRightCorner<3, 1>();
  return moved;
}

Eigen::Isometry3d run_gicp(const PclSurface& source, const PclSurface& target, double distance, int iterations) {
  Gicp gicp;
  gicp.setInputSource(source.cloud);
  gicp.setInputTarget(target.cloud);
  gicp.setSourceCovariances(source.covariances);
  gicp.setTargetCovariances(target.covariances);
  gicp.setRotationEpsilon(1e-6);
  gicp.setTranslationGradientTolerance(1e-4);
  gicp.setRotationGradientTolerance(1e-4);
  return run(gicp, distance, iterations);
}

Eigen::Isometry3d run_icp(const PclSurface& source, const PclSurface& target, double distance, int iterations,
                          bool to_plane, bool signed_normals) {
  Icp icp;
  if (to_plane) {
    icp.setTransformationEstimation(
        std::make_shared<pcl::registration::TransformationEstimationPointToPlaneLLS<Point, Point, double>>());
  }
  if (signed_normals) {
    icp.addCorrespondenceRejector(std::make_shared<RejectOtherNormals>(0.5));
  }
  icp.setInputSource(source.cloud);
  icp.setInputTarget(target.cloud);
  return run(icp, distance, iterations);
}

}  // namespace

Eigen::Isometry3d align_pair(const StationSurface& source, const StationSurface& target, const Eigen::Isometry3d& guess,
                             scene::RegisterConfig::Method method, double distance_m, int iterations, bool any_sign) {
  const double unit = target.spacing_m();
  if (!(unit > 0.0)) return guess;
  MatchLimits limits;
  limits.distance_m = distance_m;
  limits.least_cosine = 0.5;
  limits.any_sign = any_sign;
  const Matches meeting = match(source, guess, target, Eigen::Isometry3d::Identity(), limits);
  if (meeting.pairs.size() < kLeastPoints) return guess;
  PclSurface from;
  PclSurface to;
  for (const Match& pair : meeting.pairs) {
    const StationSurface::Element& element = source.elements()[pair.from];
    from.add(guess * element.point / unit, guess.linear() * element.normal);
  }
  for (const StationSurface::Element& element : target.elements()) {
    if (!element.normal.isZero(0.0)) to.add(element.point / unit, element.normal);
  }
  const QuietPcl quiet;
  Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
  try {
    moved =
        method == scene::RegisterConfig::Method::gicp
            ? run_gicp(from, to, distance_m / unit, iterations)
            : run_icp(from, to, distance_m / unit, iterations, method == scene::RegisterConfig::Method::point_to_plane,
                      !any_sign && source.signed_normals() && target.signed_normals());
  } catch (const pcl::PCLException&) {
    return guess;  // too few correspondences, or a search that did not converge
  }
  moved.translation() *= unit;
  return moved * guess;
}

}  // namespace sparsha::pipeline
