#include "bench/peers/ball.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/LU>

#include "bench/peers/triangle_tree.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

/// normal . step >= least keeps the ball off a triangle: a plane through the triangle's point nearest to the centre,
/// the triangle on its far side.
struct Plane {
  Vector3d normal;
  double least;
};

/// The same by Dykstra's alternating projections, however the planes lie.
Vector3d projected_step(const std::vector<Plane>& planes, std::vector<double>& multipliers, const Vector3d& pull,
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

/// Up to three planes that hold a step.
struct Held {
  std::array<const Plane*, 3> planes{};
  int count = 0;
};

/// The step nearest to `pull` on these planes; false when they are (nearly) parallel or one of them would pull.
bool step_on(const Held& held, const Vector3d& pull, Vector3d& step) {
  constexpr double kParallel = 1e-9;
  const auto normal = [&held](int k) -> const Vector3d& { return held.planes[static_cast<std::size_t>(k)]->normal; };
  const auto missing = [&](int k) { return held.planes[static_cast<std::size_t>(k)]->least - normal(k).dot(pull); };
  Vector3d share = Vector3d::Zero();
  if (held.count == 1) {
    share[0] = missing(0);
  } else if (held.count == 2) {
    const double both = normal(0).dot(normal(1));
    const double determinant = 1.0 - both * both;
    if (determinant < kParallel) return false;
    share[0] = (missing(0) - both * missing(1)) / determinant;
    share[1] = (missing(1) - both * missing(0)) / determinant;
  } else {
    Eigen::Matrix3d rows;
    for (int k = 0; k < 3; ++k) rows.row(k) = normal(k).transpose();
    const Eigen::Matrix3d gram = rows * rows.transpose();
    const double determinant = gram.determinant();
    if (determinant < kParallel) return false;
    share = gram.inverse() * Vector3d(missing(0), missing(1), missing(2));
  }
  step = pull;
  for (int k = 0; k < held.count; ++k) {
    if (share[k] < 0.0) return false;
    step += share[k] * normal(k);
  }
  return true;
}

/// The step nearest to `pull` that all planes allow: the most offended plane joins those that hold, of which the ones
/// that still push stay (a dual active-set method; three planes at most hold a point of space).
Vector3d allowed_step(const std::vector<Plane>& planes, std::vector<double>& multipliers, const Vector3d& pull,
                      double still) {
  constexpr int kMostChanges = 60;
  Held held;
  Vector3d step = pull;
  for (int change = 0; change < kMostChanges; ++change) {
    const Plane* worst = nullptr;
    double offence = still;
    for (const Plane& plane : planes)
      if (const double by = plane.least - plane.normal.dot(step); by > offence) {
        offence = by;
        worst = &plane;
      }
    if (worst == nullptr) return step;
    bool found = false;
    for (unsigned kept = 0; kept < (1U << static_cast<unsigned>(held.count)) && !found; ++kept) {
      Held next;
      next.planes[static_cast<std::size_t>(next.count++)] = worst;
      bool fits = true;
      for (int k = 0; k < held.count && fits; ++k) {
        if ((kept >> static_cast<unsigned>(k) & 1U) == 0U) continue;
        fits = next.count < 3;
        if (fits) next.planes[static_cast<std::size_t>(next.count++)] = held.planes[static_cast<std::size_t>(k)];
      }
      Vector3d tried;
      if (!fits || !step_on(next, pull, tried)) continue;
      for (int k = 0; k < held.count && fits; ++k) {
        const Plane& plane = *held.planes[static_cast<std::size_t>(k)];
        fits = plane.normal.dot(tried) >= plane.least - still;
      }
      if (!fits) continue;
      found = true;
      held = next;
      step = tried;
    }
    if (!found) break;
  }
  return projected_step(planes, multipliers, pull, still);
}

class Ball : public Peer {
 public:
  Ball(const haptics::MongeSurface& surface, const BallOptions& options)
      : tree_(surface),
        options_(options),
        radius_m_(options.radius_spacings * surface.lattice.spacing_m),
        still_m_(1e-4 * surface.lattice.spacing_m) {}

  void place(const Vector3d& hand) override { centre_ = hand_ = hand; }
  Touched update(const Vector3d& hand) override {
    // A ball in contact moves about as far as the hand: only triangles that it can reach so are looked at.
    double most_m = std::max(2.0 * (hand - hand_).norm(), still_m_);
    hand_ = hand;
    for (int move = 0; move < options_.moves; ++move) {
      const Vector3d pull = hand - centre_;
      most_m = std::min({most_m, pull.norm(), radius_m_});
      if (!(most_m > 0.0)) break;
      find_planes(most_m);
      const Vector3d before = centre_;
      Vector3d step = allowed_step(planes_, multipliers_, pull, 0.01 * still_m_);
      // What all planes allow, a part of it does not offend; the next step may be longer.
      const double length = step.norm();
      const bool cut = length > most_m;
      if (cut) step *= most_m / length;
      centre_ += step;
      most_m = cut ? 4.0 * most_m : std::max(2.0 * length, still_m_);
      push_out();
      if (!cut && (centre_ - before).norm() < 0.2 * still_m_) break;
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
    // What it touches first: multipliers of planes ahead, once raised, fall only slowly. Triangles that meet at the
    // nearest point share a plane.
    std::sort(planes_.begin(), planes_.end(), [](const Plane& a, const Plane& b) { return a.least > b.least; });
    const auto same = [this](const Plane& a, const Plane& b) {
      return std::abs(a.least - b.least) < 1e-9 * radius_m_ && (a.normal - b.normal).squaredNorm() < 1e-14;
    };
    planes_.erase(std::unique(planes_.begin(), planes_.end(), same), planes_.end());
  }

  void push_out() {
    for (int k = 0; k < 4; ++k) {
      const auto nearest = tree_.nearest(centre_, radius_m_);
      if (!nearest) return;
      const Vector3d out = centre_ - *nearest;
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
  Vector3d hand_ = Vector3d::Zero();  // of the tick before
  std::vector<TriangleTree::Near> near_;
  std::vector<Plane> planes_;
  std::vector<double> multipliers_;
};

}  // namespace

PeerPointer make_ball(const haptics::MongeSurface& surface, const BallOptions& options) {
  return std::make_unique<Ball>(surface, options);
}

}  // namespace sparsha::bench
