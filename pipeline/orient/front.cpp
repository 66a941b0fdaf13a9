// Views by their mirror symmetry: a person's front is one of the two sides of a plane of symmetry.
#include "pipeline/orient/front.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "pipeline/orient/likeness.h"

namespace sparsha::pipeline {
namespace {

constexpr double kClearlyBetter = 1.02;  // of the best view's worth
constexpr double kElsewhere = 0.71;      // cosine
constexpr double kSnap = 0.978;          // cosine of 12 degrees

// The best of views that are better than those beside them, three at most.
std::vector<std::size_t> peaks_of(const std::array<double, FaceRing::kTurns>& worth) {
  const auto value = [&](std::size_t k) { return worth[k % FaceRing::kTurns]; };
  std::vector<std::size_t> peaks;
  for (std::size_t k = 0; k < worth.size(); ++k)
    if (value(k) >= value(k + 1) && value(k) >= value(k + FaceRing::kTurns - 1)) peaks.push_back(k);
  std::stable_sort(peaks.begin(), peaks.end(), [&](std::size_t a, std::size_t b) { return value(a) > value(b); });
  constexpr std::size_t kRefined = 3;
  peaks.resize(std::min(peaks.size(), kRefined));
  return peaks;
}

// Where the object is clearly broader than deep: the turns from `ahead` to the direction in which it is thinnest.
std::optional<double> broad_side(const EvenPoints& object, const Eigen::Vector3d& ahead, const Eigen::Vector3d& up) {
  constexpr double kClearlyThinner = 0.8;
  const Eigen::Vector3d aside = up.cross(ahead);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector3d& p : object.points) mean += Eigen::Vector2d(ahead.dot(p), aside.dot(p));
  mean /= static_cast<double>(object.points.size());
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector3d& p : object.points) {
    const Eigen::Vector2d d = Eigen::Vector2d(ahead.dot(p), aside.dot(p)) - mean;
    covariance += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
  if (!(std::sqrt(axes.eigenvalues()[0]) < kClearlyThinner * std::sqrt(axes.eigenvalues()[1]))) return std::nullopt;
  const Eigen::Vector2d thin = axes.eigenvectors().col(0);
  return std::atan2(thin.y(), thin.x()) / FaceRing::kTurn;
}

// Of the directions that lie multiples of `part` of a whole turn from `turns`, the one nearest to `wanted`; nothing
// when that is more than 30 degrees away.
std::optional<double> near(double turns, double wanted, double part) {
  constexpr double kNear = 30.0 * std::numbers::pi / 180.0 / FaceRing::kTurn;
  const double apart = std::remainder(turns - wanted, static_cast<double>(FaceRing::kTurns) * part);
  if (std::abs(apart) > kNear) return std::nullopt;
  return wanted + apart;
}

}  // namespace

std::optional<FrontView> find_front(const EvenPoints& object, const Standing& standing) {
  if (object.points.size() < 4) return std::nullopt;
  const Eigen::Vector3d& up = standing.up;
  const FaceRing ring(object, up);
  const std::array<double, FaceRing::kTurns>& worth = ring.worth();
  // Views between the best ones: symmetry is lost within a few degrees.
  double turns = 0.0;
  double most = 0.0;
  const auto offer = [&](double tried, double value) {
    if (value <= most) return;
    most = value;
    turns = tried;
  };
  const auto try_beside = [&](double middle, double step) {
    for (const double side : {-1.0, 1.0}) offer(middle + side * step, ring.worth_at(middle + side * step));
  };
  for (const std::size_t k : peaks_of(worth)) {
    offer(static_cast<double>(k), worth[k]);
    try_beside(static_cast<double>(k), 1.0 / 3.0);
  }
  try_beside(turns, 1.0 / 6.0);
  if (!(most > 0.0)) return std::nullopt;
  const auto rival_of = [&](double chosen) {
    double rival = 0.0;
    for (std::size_t k = 0; k < worth.size(); ++k)
      if (std::cos(FaceRing::kTurn * (static_cast<double>(k) - chosen)) < kElsewhere) rival = std::max(rival, worth[k]);
    return rival / most;
  };
  FrontView front;
  front.up = up;
  front.standing_open = standing.open;
  front.rival = standing.room ? 1.0 : rival_of(turns);  // walls have no face
  const auto turns_to = [&](const Eigen::Vector3d& side) {
    return std::atan2(side.dot(up.cross(ring.ahead())), side.dot(ring.ahead())) / FaceRing::kTurn;
  };
  if (standing.face) {
    front.rival = 0.0;
    turns = turns_to(*standing.face);
  } else if (standing.open_side) {
    front.rival = 0.0;
    const double open = turns_to(*standing.open_side);
    // The open side is known roughly. The walls' own direction is better where it is near.
    const std::optional<double> broad = broad_side(object, ring.ahead(), up);
    turns = near(broad.value_or(turns), open, broad ? 0.25 : 1.0).value_or(open);
  } else if (front.no_face()) {
    // No side is like a face: of the broad sides, or of those along the scan's axes where none is broad.
    const std::optional<double> broad = broad_side(object, ring.ahead(), up);
    double best = -1.0;
    for (const double side : {0.0, 0.5, 0.25, 0.75}) {
      if (side == 0.25 && broad) break;
      const double tried = static_cast<double>(FaceRing::kTurns) * side + broad.value_or(0.0);
      const double value = ring.worth_at(tried);
      if (value < kClearlyBetter * best) continue;
      best = value;
      turns = tried;
    }
  }
  front.look_from = ring.direction(turns);
  Eigen::Index nearest = 0;
  front.look_from.cwiseAbs().maxCoeff(&nearest);
  if (std::abs(front.look_from[nearest]) > kSnap && std::abs(up[nearest]) < 1e-9)
    front.look_from = (front.look_from[nearest] > 0.0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(nearest);
  front.reason = fmt::format(
      "{}: {}, and {}", standing.room ? "a room" : "a solid object", standing.reason,
      standing.open_side ? "it is open on this side"
      : standing.from_within
          ? "its scanners stood within: its walls are seen from there, through the nearer ones; this side is a guess, "
            "look at it and turn it"
      : standing.room ? "all of its walls hide what is in it: this side is a guess, look at it, turn it, and crop the "
                        "walls or the ceiling before what is meant"
      : front.no_face()
          ? "no side is clearly more like a face than the others: this one is a guess, look at it and turn it"
      : front.standing_open ? "it may as well stand in another way: this side is a guess, look at it and turn it"
      : standing.face       ? "its face looks this way"
                            : "from this side its carving is most like its mirror image and shows most of a face");
  return front;
}

}  // namespace sparsha::pipeline
