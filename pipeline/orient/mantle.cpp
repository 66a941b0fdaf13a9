// Distances from the axis are compared within bands of height, since columns swell and vases have profiles. From many
// directions the axis slides, by reweighted least squares, to where the distances within each band agree best.
#include "pipeline/orient/mantle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "base/error.h"
#include "base/numbers/statistics.h"
#include "base/text/text.h"
#include "scene/frame/unrolling.h"

namespace sparsha::pipeline {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr int kBands = 32;
constexpr int kSectors = 72;           // of the way around, to tell how much of it has points
constexpr double kLeastAround = 0.25;  // of them
constexpr double kLeastTold = 1.5e-3;  // what the points say of the axis in its least certain direction; a sphere: 0
constexpr double kMostUneven = 0.25;   // distances at one height, robust deviation over radius; a square: 0.11
constexpr double kOtherAxis = 0.985;   // cosine between axes that are not the same
constexpr double kAsGood = 1.5;        // deviation of another axis, over that of the best
constexpr double kNoise = 2e-3;        // deviation over radius below which one axis is as good as another
constexpr std::size_t kCoarse = 3000;  // points from which axes are tried
constexpr double kRobust = 1.4826;     // standard deviation of a normal distribution over its median deviation
constexpr double kTukey = 4.685;       // deviations beyond which a point does not count
constexpr double kConeSlope = 2.0;     // degrees from which a mantle may be taken for a cone unasked
constexpr double kConeNearer = 0.6;    // of the cylinder's deviation
constexpr double kDegree = std::numbers::pi / 180.0;

double median_of(std::vector<double> values) { return values.empty() ? 0.0 : median(values); }

struct Axis {
  Eigen::Vector3d through_m;
  Eigen::Vector3d direction;
};

/// The points as the axis sees them.
struct Profile {
  Profile(const Points& points, const Axis& axis) {
    const std::size_t count = points.size();
    height.resize(count);
    distance.resize(count);
    out.resize(count);
    band.resize(count);
    for (std::size_t n = 0; n < count; ++n) {
      const Eigen::Vector3d from = points[n] - axis.through_m;
      height[n] = from.dot(axis.direction);
      out[n] = from - height[n] * axis.direction;
      distance[n] = out[n].norm();
      if (distance[n] > 0.0) out[n] /= distance[n];
    }
    std::vector<double> sorted = height;
    std::sort(sorted.begin(), sorted.end());
    low = sorted[count / 100];
    high = sorted[count - 1 - count / 100];
    std::array<std::vector<double>, kBands> of_band;
    const double per_m = high > low ? kBands / (high - low) : 0.0;
    for (std::size_t n = 0; n < count; ++n) {
      band[n] = std::clamp(static_cast<int>((height[n] - low) * per_m), 0, kBands - 1);
      of_band[static_cast<std::size_t>(band[n])].push_back(distance[n]);
    }
    for (int b = 0; b < kBands; ++b) {
      const auto& distances = of_band[static_cast<std::size_t>(b)];
      if (distances.size() < 5) continue;
      used.push_back(b);
      radius[static_cast<std::size_t>(b)] = median_of(distances);
      known[static_cast<std::size_t>(b)] = true;
    }
    std::vector<double> off;
    off.reserve(count);
    for (std::size_t n = 0; n < count; ++n) {
      if (counts(n)) off.push_back(std::abs(residual(n)));
    }
    deviation = kRobust * median_of(std::move(off));
  }

  [[nodiscard]] bool counts(std::size_t n) const { return known[static_cast<std::size_t>(band[n])]; }
  [[nodiscard]] double residual(std::size_t n) const { return distance[n] - radius[static_cast<std::size_t>(band[n])]; }
  [[nodiscard]] double middle_of(int b) const { return low + (b + 0.5) * (high - low) / kBands; }
  /// By how much the radius grows with height, at a band.
  [[nodiscard]] double slope(int b) const {
    const int below = b > 0 && known[static_cast<std::size_t>(b - 1)] ? b - 1 : b;
    const int above = b + 1 < kBands && known[static_cast<std::size_t>(b + 1)] ? b + 1 : b;
    if (above == below || !(high > low)) return 0.0;
    const double rise = radius[static_cast<std::size_t>(above)] - radius[static_cast<std::size_t>(below)];
    return std::clamp(rise / (middle_of(above) - middle_of(below)), -3.0, 3.0);
  }
  [[nodiscard]] double typical_radius() const {
    std::vector<double> all;
    for (const int b : used) all.push_back(radius[static_cast<std::size_t>(b)]);
    return median_of(std::move(all));
  }

  std::vector<double> height, distance;
  Points out;  // unit vectors from the axis to the points
  std::vector<int> band;
  std::array<double, kBands> radius{};
  std::array<bool, kBands> known{};
  std::vector<int> used;
  double low = 0.0, high = 0.0;
  double deviation = 0.0;
};

/// Two directions across the axis.
std::array<Eigen::Vector3d, 2> across(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d first = direction.unitOrthogonal();
  return {first, direction.cross(first)};
}

/// Least squares for a shift and a tilt of the axis, with what the points say of them.
struct Step {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();  // a point's share, tilts in units of `size`
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  double size = 1.0;
};

Step step_of(const Profile& profile, const std::array<Eigen::Vector3d, 2>& sides, bool tilts) {
  Step step;
  step.size = std::max(0.5 * (profile.high - profile.low), profile.typical_radius());
  const double middle = 0.5 * (profile.low + profile.high);
  const double limit = kTukey * std::max(profile.deviation, 1e-9 * step.size);
  struct Sums {
    double weight = 0.0, residual = 0.0;
    Eigen::Vector4d row = Eigen::Vector4d::Zero();
  };
  std::array<Sums, kBands> sums;
  std::array<double, kBands> slopes{};
  for (const int b : profile.used) slopes[static_cast<std::size_t>(b)] = profile.slope(b);
  const auto each = [&](const auto& use) {
    for (std::size_t n = 0; n < profile.distance.size(); ++n) {
      if (!profile.counts(n)) continue;
      const double residual = profile.residual(n);
      if (std::abs(residual) >= limit) continue;
      const double share = residual / limit;
      const double weight = (1.0 - share * share) * (1.0 - share * share);
      const auto band = static_cast<std::size_t>(profile.band[n]);
      const double lever = (profile.height[n] - middle + slopes[band] * profile.distance[n]) / step.size;
      const double q0 = profile.out[n].dot(sides[0]), q1 = profile.out[n].dot(sides[1]);
      Eigen::Vector4d row(-q0, -q1, -lever * q0, -lever * q1);
      if (!tilts) row.tail<2>().setZero();
      use(sums[band], weight, residual, row);
    }
  };
  double all = 0.0;
  each([&](Sums& sum, double weight, double residual, const Eigen::Vector4d& row) {
    sum.weight += weight;
    sum.residual += weight * residual;
    sum.row += weight * row;
    all += weight;
  });
  if (!(all > 0.0)) return step;
  each([&](Sums& sum, double weight, double residual, const Eigen::Vector4d& row) {
    const Eigen::Vector4d centred = row - sum.row / sum.weight;
    step.normal += weight / all * centred * centred.transpose();
    step.right -= weight / all * (residual - sum.residual / sum.weight) * centred;
  });
  return step;
}

/// Slides an axis to where it is best; null where it runs away from the points.
std::optional<Axis> refine(const Points& points, Axis axis, bool tilts, bool coarse) {
  const int rounds = coarse ? 25 : 40;
  const double enough = coarse ? 1e-5 : 1e-12;  // of the size: then the axis has arrived
  for (int round = 0; round < rounds; ++round) {
    const Profile profile(points, axis);
    if (profile.used.empty() || !(profile.typical_radius() > 0.0)) return std::nullopt;
    const std::array<Eigen::Vector3d, 2> sides = across(axis.direction);
    const Step step = step_of(profile, sides, tilts);
    Eigen::Matrix4d damped = step.normal;
    damped.diagonal().array() += 1e-9;
    Eigen::Vector4d move = damped.ldlt().solve(step.right);
    if (!move.allFinite()) return std::nullopt;
    const double most = 0.5 * step.size;  // one step goes no farther
    const double length = move.norm();
    if (length > most) move *= most / length;
    const Eigen::Vector3d shift = move[0] * sides[0] + move[1] * sides[1];
    const Eigen::Vector3d tilt = (move[2] * sides[0] + move[3] * sides[1]) / step.size;
    const Eigen::Vector3d middle = axis.through_m + 0.5 * (profile.low + profile.high) * axis.direction;
    axis.through_m = middle + shift;
    axis.direction = (axis.direction + tilt).normalized();
    if (length < enough * step.size) break;
  }
  return axis;
}

/// The centre of circles about the direction, one a band of height, that share it: the algebraic fit.
Axis start_of(const Points& points, const Eigen::Vector3d& direction, const Eigen::Vector3d& near_m) {
  const Profile profile(points, {near_m, direction});
  const std::array<Eigen::Vector3d, 2> sides = across(direction);
  struct Sums {
    double count = 0.0, square = 0.0;
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
  };
  std::array<Sums, kBands> sums;
  const auto place_of = [&](std::size_t n) {
    return Eigen::Vector2d(profile.distance[n] * profile.out[n].dot(sides[0]),
                           profile.distance[n] * profile.out[n].dot(sides[1]));
  };
  for (std::size_t n = 0; n < points.size(); ++n) {
    Sums& sum = sums[static_cast<std::size_t>(profile.band[n])];
    const Eigen::Vector2d place = place_of(n);
    sum.count += 1.0;
    sum.square += place.squaredNorm();
    sum.place += place;
  }
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t n = 0; n < points.size(); ++n) {
    const Sums& sum = sums[static_cast<std::size_t>(profile.band[n])];
    const Eigen::Vector2d place = place_of(n);
    const Eigen::Vector2d centred = place - sum.place / sum.count;
    normal += 2.0 * centred * centred.transpose();
    right += (place.squaredNorm() - sum.square / sum.count) * centred;
  }
  normal.diagonal().array() += 1e-9 * normal.trace();
  const Eigen::Vector2d centre = normal.ldlt().solve(right);
  return {near_m + centre.x() * sides[0] + centre.y() * sides[1], direction};
}

double share_around(const Profile& profile, const std::array<Eigen::Vector3d, 2>& sides) {
  std::array<int, kSectors> hits{};
  const double limit = kTukey * std::max(profile.deviation, 1e-9 * profile.typical_radius());
  for (std::size_t n = 0; n < profile.distance.size(); ++n) {
    if (!profile.counts(n) || std::abs(profile.residual(n)) > limit) continue;
    const double turn =
        std::atan2(profile.out[n].dot(sides[1]), profile.out[n].dot(sides[0])) / (2.0 * std::numbers::pi);
    ++hits[static_cast<std::size_t>(std::clamp(static_cast<int>((turn + 0.5) * kSectors), 0, kSectors - 1))];
  }
  return static_cast<double>(std::count_if(hits.begin(), hits.end(), [](int hit) { return hit > 0; })) / kSectors;
}

struct Candidate {
  Axis axis;
  double deviation = 0.0, radius = 0.0, told = 0.0;
};

/// An axis with points around it; null for others.
std::optional<Candidate> judged(const Points& points, const Axis& axis, bool tilts) {
  const Profile profile(points, axis);
  const double radius = profile.typical_radius();
  const std::array<Eigen::Vector3d, 2> sides = across(axis.direction);
  if (!(radius > 0.0) || share_around(profile, sides) < kLeastAround || profile.deviation > kMostUneven * radius)
    return std::nullopt;
  const Step step = step_of(profile, sides, tilts);
  const double told =
      tilts ? Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(step.normal).eigenvalues()[0]
            : Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(step.normal.topLeftCorner<2, 2>()).eigenvalues()[0];
  return Candidate{axis, profile.deviation, radius, told};
}

Points some_of(const Points& points, std::size_t count) {
  if (points.size() <= count) return points;
  Points some;
  some.reserve(count);
  for (std::size_t n = 0; n < count; ++n) some.push_back(points[n * points.size() / count]);
  return some;
}

Error undecided(const std::string& why) {
  return input_error({}, "unroll: no axis can be told: " + why,
                     "a column, vase or tower with points on a quarter of the way around or more; or axis: [x, y, z]");
}

// A unit vector stays as it is, to the last bit.
Eigen::Vector3d direction_of(const Eigen::Vector3d& axis) {
  constexpr double kUnit = 1e-12;
  return std::abs(axis.norm() - 1.0) < kUnit ? axis : Eigen::Vector3d(axis.normalized());
}

Eigen::Vector3d mean_of(const Points& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

/// Directions to start from: the frame's axes, the diagonals between them, and the points' principal axes.
Points directions_of(const Points& points, const Eigen::Vector3d& mean) {
  Points directions;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = 0; z <= 1; ++z) {
        if (z == 0 && (y < 0 || (y == 0 && x <= 0))) continue;
        directions.push_back(Eigen::Vector3d(x, y, z).normalized());
      }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
  const Eigen::Matrix3d principal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  for (int k = 0; k < 3; ++k) directions.push_back(principal.col(k).normalized());
  return directions;
}

Axis find_axis(const Points& points) {
  const Points coarse = some_of(points, kCoarse);
  const Eigen::Vector3d mean = mean_of(points);
  std::vector<Candidate> candidates;
  for (const Eigen::Vector3d& direction : directions_of(coarse, mean)) {
    const std::optional<Axis> axis = refine(coarse, start_of(coarse, direction, mean), true, true);
    if (!axis) continue;
    if (const auto candidate = judged(coarse, *axis, true)) candidates.push_back(*candidate);
  }
  if (candidates.empty()) throw undecided("the points do not lie around one");
  const auto best = std::min_element(candidates.begin(), candidates.end(),
                                     [](const Candidate& a, const Candidate& b) { return a.deviation < b.deviation; });
  const std::optional<Axis> axis = refine(points, best->axis, true, false);
  const std::optional<Candidate> found = axis ? judged(points, *axis, true) : std::nullopt;
  if (!found) throw undecided("the points do not lie around one");
  const double as_good = kAsGood * std::max(found->deviation, kNoise * found->radius);
  for (const Candidate& other : candidates) {
    if (other.deviation <= as_good && std::abs(other.axis.direction.dot(found->axis.direction)) < kOtherAxis)
      throw undecided("several directions fit equally well, as on a sphere or a cube");
  }
  if (found->told < kLeastTold) throw undecided("the object is too much like a sphere, or too flat along the axis");
  return found->axis;
}

/// A straight line through the radii of the bands: the median of slopes, then of heights.
struct Line {
  double at_centre_m = 0.0, slope = 0.0;
  double deviation = 0.0, cylinder_deviation = 0.0;
};

Line line_of(const Profile& profile) {
  std::vector<double> slopes, heights, off, off_cylinder;
  for (const int a : profile.used)
    for (const int b : profile.used)
      if (b > a)
        slopes.push_back((profile.radius[static_cast<std::size_t>(b)] - profile.radius[static_cast<std::size_t>(a)]) /
                         (profile.middle_of(b) - profile.middle_of(a)));
  Line line;
  line.slope = median_of(slopes);
  for (const int b : profile.used)
    heights.push_back(profile.radius[static_cast<std::size_t>(b)] - line.slope * profile.middle_of(b));
  line.at_centre_m = median_of(heights);
  const double cylinder = profile.typical_radius();
  for (const int b : profile.used) {
    const double radius = profile.radius[static_cast<std::size_t>(b)];
    off.push_back(std::abs(radius - line.slope * profile.middle_of(b) - line.at_centre_m));
    off_cylinder.push_back(std::abs(radius - cylinder));
  }
  line.deviation = median_of(std::move(off));
  line.cylinder_deviation = median_of(std::move(off_cylinder));
  return line;
}

void choose_shape(const Profile& profile, scene::UnrollConfig& unroll) {
  using Shape = scene::UnrollConfig::Shape;
  const Line line = line_of(profile);
  const double slope = std::atan(line.slope);
  if (unroll.shape == Shape::automatic) {
    const bool cone = std::abs(slope) >= kConeSlope * kDegree && line.deviation < kConeNearer * line.cylinder_deviation;
    unroll.shape = cone ? Shape::cone : Shape::cylinder;
  }
  if (unroll.shape == Shape::cone && !unroll.slope_rad) {
    if (std::abs(slope) < scene::Unrolling::kLeastSlope_deg * kDegree)
      throw usage_error("unroll: the points form no cone, since their distance from the axis hardly changes along it",
                        "shape: cylinder");
    if (std::abs(slope) > scene::Unrolling::kMostSlope_deg * kDegree)
      throw usage_error(
          fmt::format("unroll: the cone is too flat, {:.0f} degrees from its axis", std::abs(slope) / kDegree),
          fmt::format("at most {:.0f}; or a view along the axis, without unroll", scene::Unrolling::kMostSlope_deg));
    unroll.slope_rad = slope;
  }
  if (!unroll.radius_m) {
    const double rise = unroll.shape == Shape::cone ? std::tan(*unroll.slope_rad) : 0.0;
    std::vector<double> at_centre;
    for (const int b : profile.used)
      at_centre.push_back(profile.radius[static_cast<std::size_t>(b)] - rise * profile.middle_of(b));
    unroll.radius_m = median_of(std::move(at_centre));
  }
  if (!(*unroll.radius_m > 0.0))
    throw usage_error("unroll: the cone has no radius at centre_m", "a centre_m where the object has one, or none");
}

}  // namespace

FoundMantle find_mantle(Points sample_m, const scene::UnrollConfig& wanted, const Eigen::Vector3d& up) {
  scene::UnrollConfig unroll = wanted;
  if (sample_m.size() < 100) throw undecided("there are fewer than 100 points");
  std::sort(sample_m.begin(), sample_m.end(), [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  });
  // A fixed shuffle, so that a part of the points is spread like all.
  std::uint64_t state = 0x9E3779B97F4A7C15U;
  for (std::size_t n = sample_m.size(); n > 1; --n) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    std::swap(sample_m[n - 1], sample_m[static_cast<std::size_t>((state >> 33U) % n)]);
  }
  Axis axis;
  if (!unroll.axis) {
    axis = find_axis(sample_m);
    const double upwards = axis.direction.dot(up.normalized());
    int longest = 0;
    axis.direction.cwiseAbs().maxCoeff(&longest);
    if (std::abs(upwards) > 0.2 ? upwards < 0.0 : axis.direction[longest] < 0.0) axis.direction = -axis.direction;
  } else {
    axis = {unroll.centre_m.value_or(mean_of(sample_m)), direction_of(*unroll.axis)};
    if (!unroll.centre_m) {
      const std::optional<Axis> found =
          refine(sample_m, start_of(sample_m, axis.direction, axis.through_m), false, false);
      if (!found || !judged(sample_m, *found, false)) throw undecided("no place of it has the points around it");
      axis = *found;
    }
  }
  Profile profile(sample_m, axis);
  if (!unroll.centre_m) {
    axis.through_m += 0.5 * (profile.low + profile.high) * axis.direction;
    profile = Profile(sample_m, axis);
  }
  unroll.axis = axis.direction;
  unroll.centre_m = axis.through_m;
  if (profile.used.empty()) throw undecided("the points have no extent along it");
  choose_shape(profile, unroll);
  const bool cone = unroll.shape == scene::UnrollConfig::Shape::cone;
  const auto tidy = [](double value) { return std::round(1000.0 * value) / 1000.0 + 0.0; };  // no minus before a zero
  return {unroll, fmt::format("unrolled from a {} of {} radius about the axis {:.3f} {:.3f} {:.3f}{}",
                              cone ? "cone" : "cylinder", length_text(*unroll.radius_m), tidy(axis.direction.x()),
                              tidy(axis.direction.y()), tidy(axis.direction.z()),
                              cone ? fmt::format(", {:.3g} degrees from it", *unroll.slope_rad / kDegree) : "")};
}

std::optional<FoundMantle> mantle_of_round(const Points& sample_m, const Eigen::Vector3d& up) {
  constexpr double kRound = 0.05;   // deviation at one height, of the radius: flutes have 0.02, eight sides 0.03
  constexpr double kAround = 0.95;  // share of the way around that has points
  constexpr double kLong = 1.0;     // along the axis, radii: less is a disc or a ring
  std::optional<FoundMantle> found;
  try {
    found = find_mantle(sample_m, {}, up);
  } catch (const Error&) {
    return std::nullopt;
  }
  const Profile profile(sample_m, {*found->unroll.centre_m, *found->unroll.axis});
  const double radius = profile.typical_radius();
  if (profile.deviation > kRound * radius || profile.high - profile.low < kLong * radius ||
      share_around(profile, across(*found->unroll.axis)) < kAround)
    return std::nullopt;
  return found;
}

}  // namespace sparsha::pipeline
