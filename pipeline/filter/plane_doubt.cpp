// A plan of square cells along the plane; a place is inside the outline where most of eight directions meet what stays.
#include "pipeline/filter/plane_doubt.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/numbers/statistics.h"
#include "base/text/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kPointsPerCell = 6;  // about; so that a surface leaves no cell empty
constexpr int kFewestCells = 8;            // along the longer side
constexpr int kMostCells = 96;
constexpr int kEnclosed = 5;         // of eight directions: a place outside a convex outline sees it in four
constexpr double kOtherLevel = 0.1;  // of the plan's width, below the plane: another floor, with nothing between
// Of a floor over what stands on it, along some direction; where that begins with a flat foot, and where it does not.
constexpr double kReach = 1.2;
constexpr double kReachOfFoot = 1.5;
constexpr double kFoot = 0.1;  // of what stays, within three of the plane's thicknesses: it rises out of its own ground
constexpr double kGap = 0.4;   // of the height of what stays, between it and the plane: it lies on it
constexpr double kMostOfObject =
    0.15;  // that goes without a word; about floors 0.08 is the most, in reliefs 0.26 the least
constexpr double kStandsOut = 0.2;  // of its own width, above the plane: no relief

// Height above the plane on the side that stays, and place along it.
struct Placed {
  double u = 0.0;
  double v = 0.0;
  double height = 0.0;
};

enum class What : std::uint8_t { plane, below, kept };

struct Range {
  double low = 0.0;
  double high = 0.0;
  [[nodiscard]] double width() const { return high - low; }
};

// Between the 1st and the 99th percentile.
template <typename Value>
Range range_of(const std::vector<Placed>& points, const Value& value) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Placed& p : points) values.push_back(value(p));
  const double low = sparsha::quantile(values, 0.01);
  return {low, sparsha::quantile(values, 0.99)};
}

// Turned in the plane so that the box around all of it is smallest: a rectangle lies along the axes.
std::vector<Placed> placed(const std::vector<Eigen::Vector3f>& points, const PlaneCut& cut) {
  const Eigen::Vector3d u = cut.normal.unitOrthogonal();
  const Eigen::Vector3d v = cut.normal.cross(u);
  const double sign = cut.side == scene::RemovePlaneConfig::Side::above ? -1.0 : 1.0;
  std::vector<Placed> plan;
  plan.reserve(points.size());
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3d d = p.cast<double>();
    plan.push_back({u.dot(d), v.dot(d), sign * height_m(cut, p)});
  }
  constexpr std::size_t kEnough = 4096;
  const std::size_t step = std::max<std::size_t>(1, plan.size() / kEnough);
  std::vector<Placed> some;
  for (std::size_t i = 0; i < plan.size(); i += step) some.push_back(plan[i]);
  constexpr int kTurns = 18;
  double least = std::numeric_limits<double>::infinity();
  double best = 0.0;
  for (int k = 0; k < kTurns; ++k) {
    const double turn = 0.5 * std::numbers::pi * k / kTurns;
    const double c = std::cos(turn);
    const double s = std::sin(turn);
    const double area = range_of(some, [&](const Placed& p) { return c * p.u + s * p.v; }).width() *
                        range_of(some, [&](const Placed& p) { return c * p.v - s * p.u; }).width();
    if (area < least) {
      least = area;
      best = turn;
    }
  }
  const double c = std::cos(best);
  const double s = std::sin(best);
  for (Placed& p : plan) p = {c * p.u + s * p.v, c * p.v - s * p.u, p.height};
  return plan;
}

class Plan {
 public:
  Plan(std::vector<Placed> points, const PlaneCut& cut) : points_(std::move(points)), distance_(cut.distance_m) {
    const bool both = cut.side == scene::RemovePlaneConfig::Side::both;
    u_ = range_of(points_, [](const Placed& p) { return p.u; });
    v_ = range_of(points_, [](const Placed& p) { return p.v; });
    width_ = std::max(u_.width(), v_.width());
    const double area = std::max(u_.width() * v_.width(), 1e-6 * width_ * width_);
    const double wanted = std::sqrt(static_cast<double>(points_.size() / kPointsPerCell) * width_ * width_ / area);
    cells_ = std::clamp(static_cast<int>(wanted), kFewestCells, kMostCells);
    what_.reserve(points_.size());
    for (const Placed& p : points_) {
      const bool below = p.height < -cut.distance_m;
      const bool in_plane = std::abs(p.height) <= cut.distance_m;
      what_.push_back(in_plane ? What::plane : below && !both ? What::below : What::kept);
    }
    kept_.assign(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_), 0);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (what_[i] == What::kept) kept_[cell(points_[i])] = 1;
    }
  }

  [[nodiscard]] double share_of_object() const {
    if (!(width_ > 0.0)) return 1.0;
    const bool panel = is_panel();
    const double level = other_level();
    const std::vector<std::uint8_t> inside = enclosed();
    double lost = 0.0;
    double stays = 0.0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (what_[i] == What::kept) {
        stays += 1.0;
      } else if (what_[i] == What::below) {
        // What lies under the object shines through the floor.
        lost += points_[i].height > -level && kept_[cell(points_[i])] == 0 ? 1.0 : 0.0;
      } else {
        lost += panel || inside[cell(points_[i])] != 0 ? 1.0 : 0.0;
      }
    }
    return lost + stays > 0.0 ? lost / (lost + stays) : 1.0;
  }

 private:
  [[nodiscard]] int index(double value, double low) const {
    return std::clamp(static_cast<int>((value - low) / width_ * cells_), 0, cells_ - 1);
  }
  [[nodiscard]] std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(cells_) + static_cast<std::size_t>(i);
  }
  [[nodiscard]] std::size_t cell(const Placed& p) const { return at(index(p.u, u_.low), index(p.v, v_.low)); }

  // Of each cell: whether most directions from it meet what stays; so do cells in which something stays.
  [[nodiscard]] std::vector<std::uint8_t> enclosed() const {
    constexpr std::array<std::array<int, 2>, 8> kDirections{
        {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
    std::vector<std::uint8_t> meets(kept_.size(), 0);
    for (const auto& [di, dj] : kDirections) {
      for (int j = 0; j < cells_; ++j) {
        for (int i = 0; i < cells_; ++i) {
          for (int k = i + di, l = j + dj; k >= 0 && l >= 0 && k < cells_ && l < cells_; k += di, l += dj) {
            if (kept_[at(k, l)] == 0) continue;
            ++meets[at(i, j)];
            break;
          }
        }
      }
    }
    for (std::uint8_t& m : meets) m = m >= kEnclosed ? 1 : 0;
    return meets;
  }

  // Depth below the plane at which what lies there is another floor: nothing lies between, and it is far away.
  [[nodiscard]] double other_level() const {
    std::vector<double> depths;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (what_[i] == What::below) depths.push_back(-points_[i].height);
    }
    if (depths.empty()) return 0.0;
    const double nearest = sparsha::quantile(depths, 0.05);
    return nearest > kOtherLevel * width_ ? 0.0 : 2.0 * kOtherLevel * width_ + nearest;
  }

  // What stays is flat, reaches about as far as the plane and grows out of it: figures on their own ground.
  [[nodiscard]] bool is_panel() const {
    std::vector<Placed> kept;
    std::vector<double> heights;
    std::size_t foot = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (what_[i] != What::kept) continue;
      kept.push_back(points_[i]);
      heights.push_back(std::abs(points_[i].height) - distance_);
      foot += heights.back() < 2.0 * distance_ ? 1 : 0;
    }
    if (kept.empty()) return true;
    const Range u = range_of(kept, [](const Placed& p) { return p.u; });
    const Range v = range_of(kept, [](const Placed& p) { return p.v; });
    const double high = sparsha::quantile(heights, 0.95);
    if (high > kStandsOut * std::max(u.width(), v.width())) return false;
    const auto within = [&](double reach) { return u_.width() < reach * u.width() && v_.width() < reach * v.width(); };
    const bool has_foot = static_cast<double>(foot) > kFoot * static_cast<double>(kept.size());
    return (has_foot && within(kReachOfFoot)) || (sparsha::quantile(heights, 0.05) < kGap * high && within(kReach));
  }

  std::vector<Placed> points_;
  std::vector<What> what_;
  std::vector<std::uint8_t> kept_;  // whether something stays in the cell
  Range u_;
  Range v_;
  double width_ = 0.0;
  double distance_ = 0.0;  // half the thickness of the plane
  int cells_ = 0;
};

}  // namespace

double share_of_object(const std::vector<Eigen::Vector3f>& points, const PlaneCut& cut) {
  if (points.empty()) return 0.0;
  return Plan(placed(points, cut), cut).share_of_object();
}

void warn_of_plane(const FilterStep& step, std::uint64_t before, Progress& progress) {
  if (step.removed == before) return;
  const bool most = 3 * std::max(step.in_plane, step.removed) > 2 * before;
  if (!most && step.of_object <= kMostOfObject) return;
  std::string what = fmt::format("'remove_plane' takes {} of the points away ({} lie in its plane): {}",
                                 share_text(step.removed, before), share_text(step.in_plane, before), step.found);
  if (step.of_object > kMostOfObject) {
    what += fmt::format(
        "; it runs through what stays and not beside it: about {:.0f} % of what may be the object goes with it",
        100.0 * step.of_object);
  }
  progress.warn(what +
                "; if that is the object itself, as the picture of the filters in the report shows, give another "
                "normal, a smaller max_angle_deg or no 'remove_plane'");
}

}  // namespace sparsha::pipeline
