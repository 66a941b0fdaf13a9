// Views by their mirror symmetry: a person's front is one of the two sides of a plane of symmetry.
#include "pipeline/orient/front.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "base/numbers/statistics.h"
#include "pipeline/orient/room.h"
#include "pipeline/orient/side_picture.h"
#include "scene/config/orientation.h"

namespace sparsha::pipeline {
namespace {

constexpr double kFootHeight = 0.03;    // of the object's height
constexpr double kRagged = 0.002;       // of the points, beyond its lowest and highest place
constexpr double kCustom = 0.35;        // what custom is worth beside a foot's share
constexpr double kOtherCustom = 0.25;   // of the other of y and z
constexpr double kSideways = 0.15;      // less for x, which no custom calls up: flat ends are walls more often
constexpr double kUpsideDown = 0.25;    // less for what custom calls down
constexpr double kTilted = 0.25;        // less for a base that lies along no axis of the scan
constexpr double kEvidentFoot = 0.2;    // more than that of the opposite side
constexpr std::size_t kOutline = 4000;  // points that an outline is taken from
constexpr std::size_t kTurns = 24;
constexpr double kTurn = 2.0 * std::numbers::pi / static_cast<double>(kTurns);
constexpr double kClearlyBetter = 1.02;  // of the best view's worth
constexpr double kElsewhere = 0.71;      // cosine
constexpr double kSnap = 0.978;          // cosine of 12 degrees
constexpr int kMiddle = 5;               // pixels either side of the mirror axis
constexpr double kAxisRange = 0.24;      // of the width, that the mirror axis may lie off the middle

using Place = Eigen::Vector2d;

// Twice the area of the convex hull.
double hull_area(std::vector<Place> places) {
  if (places.size() < 3) return 0.0;
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  std::vector<Place> hull;
  const auto turns_right = [&](const Place& p) {
    const Place a = hull[hull.size() - 1] - hull[hull.size() - 2];
    const Place b = p - hull[hull.size() - 2];
    return a.x() * b.y() - a.y() * b.x() <= 0.0;
  };
  for (const bool back : {false, true}) {
    const std::size_t begin = hull.size();
    for (const Place& p : places) {
      while (hull.size() >= begin + 2 && turns_right(p)) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    if (!back) std::reverse(places.begin(), places.end());
  }
  double area = 0.0;
  for (std::size_t k = 0; k < hull.size(); ++k) {
    const Place& a = hull[k];
    const Place& b = hull[(k + 1) % hull.size()];
    area += a.x() * b.y() - a.y() * b.x();
  }
  return area;
}

std::vector<double> heights_of(const EvenPoints& object, const Eigen::Vector3d& up) {
  std::vector<double> heights(object.points.size());
  std::transform(object.points.begin(), object.points.end(), heights.begin(),
                 [&](const Eigen::Vector3d& p) { return up.dot(p); });
  return heights;
}

// What is within `share` of the height over the lowest place.
std::vector<std::size_t> lowest_of(const EvenPoints& object, const Eigen::Vector3d& up, double share) {
  const std::vector<double> heights = heights_of(object, up);
  std::vector<double> ranked = heights;
  const double low = quantile(ranked, kRagged);
  const double limit = low + share * (quantile(ranked, 1.0 - kRagged) - low);
  std::vector<std::size_t> lowest;
  for (std::size_t i = 0; i < heights.size(); ++i)
    if (heights[i] <= limit) lowest.push_back(i);
  return lowest;
}

// Share of the outline from above that the object would stand on.
double foot_of(const EvenPoints& object, const Eigen::Vector3d& up) {
  const Eigen::Vector3d u = up.unitOrthogonal();
  const Eigen::Vector3d v = up.cross(u);
  const auto place = [&](const Eigen::Vector3d& p) { return Place(u.dot(p), v.dot(p)); };
  std::vector<Place> all;
  const std::size_t step = std::max<std::size_t>(1, object.points.size() / kOutline);
  for (std::size_t i = 0; i < object.points.size(); i += step) all.push_back(place(object.points[i]));
  std::vector<Place> foot;
  for (const std::size_t i : lowest_of(object, up, kFootHeight)) foot.push_back(place(object.points[i]));
  const double outline = hull_area(std::move(all));
  return outline > 0.0 ? hull_area(std::move(foot)) / outline : 0.0;
}

// The normal of the plane through what is lowest, a few times: a base that is a little tilted becomes level.
Eigen::Vector3d levelled(const EvenPoints& object, Eigen::Vector3d up) {
  for (const double share : {0.08, 0.05, 0.03}) {
    const std::vector<std::size_t> lowest = lowest_of(object, up, share);
    if (lowest.size() < 3) break;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const std::size_t i : lowest) centre += object.points[i];
    centre /= static_cast<double>(lowest.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const std::size_t i : lowest)
      covariance += (object.points[i] - centre) * (object.points[i] - centre).transpose();
    const Eigen::Vector3d normal =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(0).normalized();
    const double along = normal.dot(up);
    if (std::abs(along) < 0.7) break;  // what is lowest is no base
    up = along < 0.0 ? Eigen::Vector3d(-normal) : normal;
  }
  return up;
}

// Directions up from bases that lie along no axis of the scan.
std::vector<Eigen::Vector3d> tilted_bases(const EvenPoints& object) {
  EvenPoints fewer = object;
  const std::size_t step = std::max<std::size_t>(1, object.points.size() / kOutline);
  for (std::size_t i = 0; i * step < object.points.size(); ++i) fewer.points[i] = object.points[i * step];
  fewer.points.resize((object.points.size() + step - 1) / step);
  std::vector<Eigen::Vector3d> bases;
  for (int n = 0; n < 27; ++n) {
    const Eigen::Vector3d start(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    if (start.isZero()) continue;
    const Eigen::Vector3d up = levelled(fewer, start.normalized());
    // Nearly along an axis it is that axis: feet and chins of statues that stand upright are level by chance only.
    if (up.cwiseAbs().maxCoeff() < std::cos(5.0 * std::numbers::pi / 180.0)) bases.push_back(up);
  }
  return bases;
}

Standing standing_of_room(const Room& room) {
  Eigen::Index axis = 0;
  const double most = room.up.cwiseAbs().maxCoeff(&axis);
  const std::string name = most < 1.0 - 1e-9 ? std::string("up is")
                                             : fmt::format("{}{} is up:", room.up[axis] < 0.0 ? "-" : "", "xyz"[axis]);
  return {room.up,
          fmt::format("{} from floor to ceiling ({:.0f} and {:.0f} % of the plan), {}", name, 100.0 * room.floor,
                      100.0 * room.ceiling,
                      room.by_things ? "of which what stands in the room is nearer to the floor"
                                     : "of which custom tells the floor"),
          true};
}

// How much a picture is like a face, row by row from the bottom.
struct Likeness {
  std::vector<double> mirrored;  // carving times its mirror image
  std::vector<double> profile;   // squared changes of the carving from row to row, along the mirror axis
  double area = 0.0;             // pixels that the object covers
};

// The sum over a picture's rows of relief times its mirror image. `twice` the axis's place is a whole number: it lies
// on a pixel or between two.
double mirrored_row(const SidePicture& picture, const std::vector<float>& relief, int y, int twice, int left,
                    int right) {
  double product = 0.0;
  for (int x = std::max(left, twice - right); 2 * x < twice; ++x) {
    product +=
        static_cast<double>(relief[picture.index(x, y)]) * static_cast<double>(relief[picture.index(twice - x, y)]);
  }
  return product;
}

Likeness likeness_of(const EvenPoints& object, const Eigen::Vector3d& look_from, const Eigen::Vector3d& up) {
  const SidePicture picture = picture_from(object, look_from, up);
  const std::vector<float> relief = relief_of(picture);
  const auto rows = static_cast<std::size_t>(picture.side);
  Likeness likeness{std::vector<double>(rows), std::vector<double>(rows), 0.0};
  double sum = 0.0;
  int left = picture.side;
  int right = 0;
  for (int y = 0; y < picture.side; ++y) {
    for (int x = 0; x < picture.side; ++x) {
      if (std::isnan(picture.height[picture.index(x, y)])) continue;
      likeness.area += 1.0;
      sum += x;
      left = std::min(left, x);
      right = std::max(right, x);
    }
  }
  if (likeness.area == 0.0) return likeness;
  const int middle = static_cast<int>(std::lround(2.0 * sum / likeness.area));
  const int range = static_cast<int>(kAxisRange * (right - left));
  double most = 0.0;
  int axis = middle;
  std::vector<double> tried(rows);
  for (int twice = middle - range; twice <= middle + range; ++twice) {
    double product = 0.0;
    for (int y = 0; y < picture.side; ++y)
      product += tried[static_cast<std::size_t>(y)] = mirrored_row(picture, relief, y, twice, left, right);
    if (product <= most) continue;
    most = product;
    axis = twice;
    likeness.mirrored = tried;
  }
  for (int y = 1; y + 1 < picture.side; ++y) {
    for (int x = std::max(left, axis / 2 - kMiddle); x <= std::min(right, axis / 2 + kMiddle); ++x) {
      const double change = static_cast<double>(relief[picture.index(x, y + 1)] - relief[picture.index(x, y - 1)]);
      likeness.profile[static_cast<std::size_t>(y)] += change * change;
    }
  }
  return likeness;
}

// What is alike from all sides, as a round plinth, tells no front: the least of each row is taken off.
struct Common {
  std::vector<double> mirrored, profile;

  void include(const Likeness& likeness) {
    const auto take = [](std::vector<double>& least, const std::vector<double>& values) {
      if (least.empty()) least = values;
      for (std::size_t y = 0; y < values.size(); ++y) least[y] = std::max(0.0, std::min(least[y], values[y]));
    };
    take(mirrored, likeness.mirrored);
    take(profile, likeness.profile);
  }
  /// A view's worth as a front. Rows of the mirrored carving count by their square roots: a face has many rows, the
  /// edge of a plinth few.
  [[nodiscard]] double worth_of(const Likeness& likeness) const {
    double roots = 0.0;
    double changes = 0.0;
    for (std::size_t y = 0; y < mirrored.size(); ++y) {
      roots += std::sqrt(std::max(0.0, likeness.mirrored[y] - mirrored[y]));
      changes += likeness.profile[y] - profile[y];
    }
    return roots * roots * std::sqrt(std::max(0.0, changes)) * std::pow(likeness.area, 1.5);
  }
};

// The best of views that are better than those beside them, three at most.
std::vector<std::size_t> peaks_of(const std::array<double, kTurns>& worth) {
  const auto value = [&](std::size_t k) { return worth[k % kTurns]; };
  std::vector<std::size_t> peaks;
  for (std::size_t k = 0; k < worth.size(); ++k)
    if (value(k) >= value(k + 1) && value(k) >= value(k + kTurns - 1)) peaks.push_back(k);
  std::stable_sort(peaks.begin(), peaks.end(), [&](std::size_t a, std::size_t b) { return value(a) > value(b); });
  constexpr std::size_t kRefined = 3;
  peaks.resize(std::min(peaks.size(), kRefined));
  return peaks;
}

Eigen::Vector3d turned(const Eigen::Vector3d& ahead, const Eigen::Vector3d& up, double angle) {
  return std::cos(angle) * ahead + std::sin(angle) * up.cross(ahead);
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
  return std::atan2(thin.y(), thin.x()) / kTurn;
}

}  // namespace

Standing customary_standing(bool z_up) {
  if (z_up) return {Eigen::Vector3d::UnitZ(), "z is up by custom"};
  return {Eigen::Vector3d::UnitY(), "y is up by custom"};
}

std::optional<Standing> standing_of(const EvenPoints& object, bool z_up) {
  if (object.points.size() < 4) return std::nullopt;
  const std::vector<Eigen::Vector3d> tilted = tilted_bases(object);
  if (const std::optional<Room> room = room_of(object, tilted)) return standing_of_room(*room);
  const Standing custom = customary_standing(z_up);
  const Eigen::Vector3d other = customary_standing(!z_up).up;
  Standing best;
  double most = -1.0;
  double foot = 0.0;
  const auto offer = [&](const Eigen::Vector3d& up, double worth) {
    const double over = std::max(0.0, foot_of(object, up) - foot_of(object, -up));
    if (over + worth <= most + 1e-9) return;
    most = over + worth;
    foot = over;
    best.up = up;
  };
  offer(custom.up, kCustom);
  offer(other, kOtherCustom);
  for (const double side : {1.0, -1.0}) offer(side * Eigen::Vector3d::UnitX(), -kSideways);
  for (const Eigen::Vector3d& up : {custom.up, other}) offer(-up, -kUpsideDown);
  for (const Eigen::Vector3d& up : tilted) offer(up, -kTilted);
  best.reason = best.up != custom.up  ? fmt::format("it stands on a flat base ({:.0f} % of its outline)", 100.0 * foot)
                : foot > kEvidentFoot ? fmt::format("{} is up: it stands on a flat base", z_up ? "z" : "y")
                                      : custom.reason;
  return best;
}

std::optional<FrontView> find_front(const EvenPoints& object, const Standing& standing) {
  if (object.points.size() < 4) return std::nullopt;
  const Eigen::Vector3d& up = standing.up;
  // Turns start at the axis of the scan that is nearest to the horizon, of equal ones the last.
  Eigen::Index flattest = 2;
  for (const Eigen::Index axis : {1, 0})
    if (std::abs(up[axis]) < std::abs(up[flattest]) - 1e-9) flattest = axis;
  const Eigen::Vector3d axis = (flattest == 1 ? -1.0 : 1.0) * Eigen::Vector3d::Unit(flattest);  // as custom has it
  const Eigen::Vector3d ahead = (axis - axis.dot(up) * up).normalized();
  const auto likeness_at = [&](double turns) { return likeness_of(object, turned(ahead, up, kTurn * turns), up); };
  std::vector<Likeness> likenesses;
  Common common;
  for (std::size_t k = 0; k < kTurns; ++k) {
    likenesses.push_back(likeness_at(static_cast<double>(k)));
    common.include(likenesses.back());
  }
  std::array<double, kTurns> worth{};
  for (std::size_t k = 0; k < kTurns; ++k) worth[k] = common.worth_of(likenesses[k]);
  // Views between the best ones: symmetry is lost within a few degrees.
  double turns = 0.0;
  double most = 0.0;
  const auto offer = [&](double tried, double value) {
    if (value <= most) return;
    most = value;
    turns = tried;
  };
  const auto try_beside = [&](double middle, double step) {
    for (const double side : {-1.0, 1.0})
      offer(middle + side * step, common.worth_of(likeness_at(middle + side * step)));
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
      if (std::cos(kTurn * (static_cast<double>(k) - chosen)) < kElsewhere) rival = std::max(rival, worth[k]);
    return rival / most;
  };
  FrontView front;
  front.up = up;
  front.rival = standing.room ? 1.0 : rival_of(turns);  // walls have no face
  if (front.open()) {
    // No side is like a face: of the broad sides, or of those along the scan's axes where none is broad.
    const std::optional<double> broad = broad_side(object, ahead, up);
    double best = -1.0;
    for (const double side : {0.0, 0.5, 0.25, 0.75}) {
      if (side == 0.25 && broad) break;
      const double tried = static_cast<double>(kTurns) * side + broad.value_or(0.0);
      const double value = common.worth_of(likeness_at(tried));
      if (value < kClearlyBetter * best) continue;
      best = value;
      turns = tried;
    }
  }
  front.look_from = turned(ahead, up, kTurn * turns);
  Eigen::Index nearest = 0;
  front.look_from.cwiseAbs().maxCoeff(&nearest);
  if (std::abs(front.look_from[nearest]) > kSnap && std::abs(up[nearest]) < 1e-9)
    front.look_from = (front.look_from[nearest] > 0.0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(nearest);
  front.reason = fmt::format(
      "{}: {}, and {}", standing.room ? "a room" : "a solid object", standing.reason,
      standing.room ? "all of its walls hide what is in it: this side is a guess, look at it, turn it, and crop the "
                      "walls or the ceiling before what is meant"
      : front.open()
          ? "no side is clearly more like a face than the others: this one is a guess, look at it and turn it"
          : "from this side its carving is most like its mirror image and shows most of a face");
  return front;
}

}  // namespace sparsha::pipeline
