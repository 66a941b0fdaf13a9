#include "ball.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "triangle_tree.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

/// normal . step >= least keeps the ball off a triangle: a plane through the triangle's point nearest to the centre,
/// the triangle on its far side.
struct Plane {
  Vector3d normal;
  double least;
};

/// The step nearest to `pull` that all planes allow, by Dykstra's alternating projections.
Vector3d allowed_step(const std::vector<Plane>& planes, std::vector<double>& multipliers, const Vector3d& pull,
                      double still) {
  constexpr int kRounds = 200;
  multipliers.assign(planes.size(), 0.0);
  Vector3d step = pull;
  for (int round = 0; round < kRounds; ++round) {
    double most = 0.0;
    for (std::size_t k = 0; k < planes.size(); ++k) {
      const double wanted = std::max(0.0, multipliers[k] + planes[k].least - planes[k].normal.dot(step));
      const double change = wanted - multipliers[k];
      if (change == 0.0) continue;
      step += change * planes[k].normal;
      multipliers[k] = wanted;
      most = std::max(most, std::abs(change));
    }
    if (most < still) break;
  }
  return step;
}

class Ball : public Peer {
 public:
  Ball(const haptics::MongeSurface& surface, const BallOptions& options)
      : tree_(surface),
        options_(options),
        radius_m_(options.radius_spacings * surface.lattice.spacing_m),
        still_m_(1e-4 * surface.lattice.spacing_m) {}

  void place(const Vector3d& hand) override { centre_ = hand; }
  Touched update(const Vector3d& hand) override {
    for (int move = 0; move < options_.moves; ++move) {
      Vector3d pull = hand - centre_;
      const double length = pull.norm();
      if (!(length > 0.0)) break;
      if (length > radius_m_) pull *= radius_m_ / length;
      find_planes(pull.norm());
      const Vector3d before = centre_;
      centre_ += allowed_step(planes_, multipliers_, pull, 0.01 * still_m_);
      push_out();
      if ((centre_ - before).norm() < still_m_) break;
    }
    Touched touched;
    const Vector3d out = centre_ - hand;
    const double away = out.norm();
    touched.proxy = centre_;
    touched.contact = away > radius_m_;
    if (touched.contact) {
      touched.force_m = out * ((away - radius_m_) / away);
      touched.proxy = hand + touched.force_m;
    }
    return touched;
  }
  [[nodiscard]] std::size_t bytes() const override { return tree_.bytes(); }

 private:
  void find_planes(double move_m) {
    planes_.clear();
    // The plane of a triangle ahead leans towards the ball, which could come only half as near to its edge with every
    // step if it had to stay above: it may sink in a little, and is pushed out.
    constexpr double kSlack = 1.0;  // of what counts as standing still
    // What a step may bring into reach: steps are at most as long as the pull and what pushes the ball out.
    tree_.near(centre_, radius_m_ + 1.5 * move_m, near_);
    for (const TriangleTree::Near& triangle : near_) {
      const Vector3d out = centre_ - triangle.point;
      const double distance = out.norm();
      // A centre on the mesh itself has been pushed through by rounding alone.
      const Vector3d normal = distance > 1e-9 * radius_m_ ? Vector3d(out / distance) : triangle.normal;
      planes_.push_back({normal, radius_m_ - distance - kSlack * still_m_});
    }
    // What it touches first: multipliers of planes ahead, once raised, fall only slowly.
    std::sort(planes_.begin(), planes_.end(), [](const Plane& a, const Plane& b) { return a.least > b.least; });
  }

  void push_out() {
    for (int k = 0; k < 4; ++k) {
      tree_.near(centre_, radius_m_, near_);
      const auto nearest = std::min_element(near_.begin(), near_.end(), [this](const auto& a, const auto& b) {
        return (a.point - centre_).squaredNorm() < (b.point - centre_).squaredNorm();
      });
      if (nearest == near_.end()) return;
      const Vector3d out = centre_ - nearest->point;
      const double distance = out.norm();
      const double deep = radius_m_ - distance;
      if (!(deep > 0.01 * still_m_ && distance > 1e-9 * radius_m_)) return;
      centre_ += out * (deep / distance);
    }
  }

  TriangleTree tree_;
  BallOptions options_;
  double radius_m_;
  double still_m_;
  Vector3d centre_ = Vector3d::Zero();
  std::vector<TriangleTree::Near> near_;
  std::vector<Plane> planes_;
  std::vector<double> multipliers_;
};

}  // namespace

PeerPointer make_ball(const haptics::MongeSurface& surface, const BallOptions& options) {
  return std::make_unique<Ball>(surface, options);
}

}  // namespace sparsha::bench
