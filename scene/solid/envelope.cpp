#include "scene/solid/envelope.h"

#include <cmath>

namespace sparsha::scene {

Envelope::Envelope(double sigma_space_m, double sigma_range_m)
    : reach_2_(kReach * kReach * sigma_space_m * sigma_space_m),
      space_(-0.5 / (sigma_space_m * sigma_space_m)),
      range_(-0.5 / (sigma_range_m * sigma_range_m)) {}

double Envelope::operator()(const Eigen::Vector3d& place_m, const Eigen::Vector3d& normal,
                            const std::vector<SurfaceNode>& about) const {
  double sum = 0.0, weights = 0.0;
  for (const SurfaceNode& node : about) {
    const Eigen::Vector3d way_m = node.place_m - place_m;
    const double way_2 = way_m.squaredNorm();
    if (way_2 > reach_2_ || node.normal.dot(normal) < SurfaceNode::kSameSide) continue;
    const double before_m = normal.dot(way_m);
    const double before_2 = before_m * before_m;
    const double weight = node.area * std::exp(space_ * (way_2 - before_2) + range_ * before_2);
    sum += weight * before_m;
    weights += weight;
  }
  return weights > 0.0 ? -sum / weights : 0.0;
}

}  // namespace sparsha::scene
