// pcl::registration::LUM in the place of our relaxation of all poses, for tests and the bench: the same matches, found
// anew in each round, within the same distances.
#pragma once

#include <memory>
#include <vector>

#include <pcl/point_types.h>
#include <pcl/registration/lum.h>

#include "pipeline/register/match.h"
#include "pipeline/register/relaxation.h"

namespace sparsha::pipeline::testing {

/// The places that each edge's surfaces take for the same, one cloud a scan, as LUM wants them.
class LumRound {
 public:
  LumRound(const std::vector<PosedSurface>& scans, const std::vector<Edge>& edges, double distance_m) {
    for (const PosedSurface& scan : scans) {
      auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
      for (const StationSurface::Element& element : scan.surface->elements()) {
        const Eigen::Vector3f p = (scan.pose * element.point).cast<float>();
        cloud->emplace_back(p.x(), p.y(), p.z());
      }
      lum_.addPointCloud(cloud);
    }
    MatchLimits limits;
    limits.distance_m = distance_m;
    limits.most = 8000;  // as in the last stage of ours
    for (const Edge& edge : edges) {
      const auto pairs = std::make_shared<pcl::Correspondences>();
      limits.any_sign = edge.any_sign;
      add(match(*scans[edge.a].surface, scans[edge.a].pose, *scans[edge.b].surface, scans[edge.b].pose, limits), false,
          *pairs);
      add(match(*scans[edge.b].surface, scans[edge.b].pose, *scans[edge.a].surface, scans[edge.a].pose, limits), true,
          *pairs);
      lum_.setCorrespondences(edge.a, edge.b, pairs);
    }
    lum_.setMaxIterations(5);
    lum_.setConvergenceThreshold(0.0F);
    lum_.compute();
  }

  [[nodiscard]] Eigen::Isometry3d motion(std::size_t scan) const {
    const Eigen::Affine3d affine = lum_.getTransformation(scan).cast<double>();
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.linear() = Eigen::Quaterniond(Eigen::Matrix3d(affine.linear())).normalized().toRotationMatrix();
    motion.translation() = affine.translation();
    return motion;
  }

 private:
  static void add(const Matches& matches, bool turned, pcl::Correspondences& pairs) {
    for (const Match& match : matches.pairs) {
      const auto from = static_cast<pcl::index_t>(match.from);
      const auto to = static_cast<pcl::index_t>(match.to);
      pairs.emplace_back(turned ? to : from, turned ? from : to, 0.0F);
    }
  }

  pcl::registration::LUM<pcl::PointXYZ> lum_;
};

/// `rounds` within distances that shrink from `from_m` to `to_m`, and as many within the latter.
inline void relax_by_lum(std::vector<PosedSurface>& scans, const std::vector<Edge>& edges, double from_m, double to_m,
                         int rounds) {
  const auto stage = [&](double distance_m) {
    for (int round = 0; round < rounds; ++round) {
      const LumRound lum(scans, edges, distance_m);
      for (std::size_t s = 1; s < scans.size(); ++s) scans[s].pose = lum.motion(s) * scans[s].pose;
    }
  };
  for (double distance_m = from_m; distance_m > to_m; distance_m *= 0.6) stage(distance_m);
  stage(to_m);
}

}  // namespace sparsha::pipeline::testing
