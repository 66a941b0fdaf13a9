#include "bench/peers/sphere.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "bench/peers/point_tree.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

class Sphere : public Peer {
 public:
  Sphere(const haptics::MongeSurface& surface, const SphereOptions& options)
      : tree_(surface),
        options_(options),
        radius_m_(options.radius_spacings * surface.lattice.spacing_m),
        step_m_(0.25 * radius_m_) {}

  void place(const Vector3d& hand) override { centre_ = hand + Vector3d(0.0, 0.0, radius_m_); }
  Touched update(const Vector3d& hand) override {
    double step = step_m_;
    Vector3d push = Vector3d::Zero();
    for (int k = 0; k < options_.iterations; ++k) {
      const Vector3d before = centre_;
      const Vector3d pull = hand - centre_;
      Vector3d way = pull;
      // In contact the step is along the tangent plane; a pull outwards leaves it.
      if (push.squaredNorm() > 0.0 && push.dot(pull) < 0.0) way -= push * (push.dot(pull) / push.squaredNorm());
      if (way.norm() > step) way *= step / way.norm();
      centre_ += way;
      push = push_out();
      const double moved = (centre_ - before).norm();
      if (push.squaredNorm() == 0.0 && (hand - centre_).norm() < 1e-9 * radius_m_) break;
      if (moved < kStill * radius_m_) break;
      // Back and forth between points: smaller steps.
      if ((centre_ - before).dot(hand - before) < 0.5 * moved * step_m_ && moved < 0.5 * way.norm()) step *= 0.5;
    }
    Touched touched;
    const Vector3d pull = hand - centre_;
    const double distance = pull.norm();
    touched.proxy = centre_;
    touched.contact = distance > radius_m_;
    if (touched.contact) {
      touched.proxy = centre_ + pull * (radius_m_ / distance);
      touched.force_m = touched.proxy - hand;
    }
    return touched;
  }
  [[nodiscard]] std::size_t bytes() const override { return tree_.bytes(); }

 private:
  static constexpr double kStill = 1e-4;   // of the radius
  static constexpr double kMargin = 0.15;  // of the radius

  /// The points in reach are fetched again only when the ball has moved by what was fetched beyond its radius.
  void look_around() {
    const double margin = kMargin * radius_m_;
    if ((centre_ - looked_).squaredNorm() <= margin * margin) return;
    looked_ = centre_;
    near_.clear();
    const double reach = radius_m_ + margin;
    tree_.visit_cube(centre_, reach, [&](std::size_t index) {
      const Vector3d point = tree_.point(index);
      if ((point - centre_).squaredNorm() < reach * reach) near_.push_back(point);
    });
  }
  /// Pushes the ball off the points in it, deepest first; the sum of the directions, weighted by depth.
  Vector3d push_out() {
    Vector3d mean = Vector3d::Zero();
    for (int k = 0; k < 4; ++k) {
      Vector3d sum = Vector3d::Zero();
      Vector3d deepest = Vector3d::Zero();
      look_around();
      for (const Vector3d& point : near_) {
        const Vector3d out = centre_ - point;
        const double squared = out.squaredNorm();
        if (squared >= radius_m_ * radius_m_ || squared == 0.0) continue;
        const double distance = std::sqrt(squared);
        const Vector3d overlap = out * ((radius_m_ - distance) / distance);
        sum += overlap;
        if (overlap.squaredNorm() > deepest.squaredNorm()) deepest = overlap;
      }
      if (deepest.squaredNorm() == 0.0) break;
      centre_ += deepest;
      mean += sum;
    }
    return mean;
  }

  PointTree tree_;
  SphereOptions options_;
  double radius_m_;
  double step_m_;
  Vector3d centre_ = Vector3d::Zero();
  Vector3d looked_ = Vector3d::Constant(std::numeric_limits<double>::max());
  std::vector<Vector3d> near_;
};

}  // namespace

PeerPointer make_sphere(const haptics::MongeSurface& surface, const SphereOptions& options) {
  return std::make_unique<Sphere>(surface, options);
}

}  // namespace sparsha::bench
