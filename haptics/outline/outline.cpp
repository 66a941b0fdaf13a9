#include "haptics/outline/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>

#include "scene/depth_grid.h"
#include "scene/ground/continuation.h"
#include "scene/ground/contours.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector2d;
using scene::Contour;
using scene::DepthGrid;
using scene::Lattice;
using scene::NodeState;
using scene::trace_contours;
using scene::zero_between;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kSigma = 1.5;                         // nodes, of the smoothing
constexpr double kBeside = 4.0;                        // nodes on either side of a step, where the slope is compared
constexpr double kStepNoises = 8.0;                    // least step, in standard deviations of the heights
constexpr double kStepNodes = 0.75;                    // and in node distances
constexpr double kWeak = 0.25;                         // of the least step, where it goes on
constexpr double kWeakSlope = 0.75;                    // and, whatever lies beside it, of that step's slope
constexpr double kStrongShare = 0.5;                   // of a step's points are not weak
constexpr double kTurn = 0.5;                          // least change of slope across a ridge
constexpr double kPeak = 0.3989422804014327 / kSigma;  // curvature of a turn of 1, smoothed: of a normal distribution
constexpr double kProminent = 2.0;                     // times as strong as beside it is a bend
constexpr double kLineLike = 0.5;                      // of the curvature across a ridge may be along it
constexpr double kNearOther = 4.0;                     // nodes: a ridge beside a step or a border belongs to it
constexpr double kShortest = 8.0;                      // nodes
constexpr double kShortestBorder = 6.0;
constexpr double kMostRim = 0.25;   // of a border's length
constexpr double kTolerance = 0.1;  // nodes
constexpr int kSmoothings = 3;

/// Values at the nodes of a lattice.
class Field {
 public:
  Field(int nx, int ny)
      : nx_(nx), ny_(ny), values_(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny), 0.0F) {}
  [[nodiscard]] float& at(int i, int j) { return values_[index(i, j)]; }
  /// Beyond the rim the rim's values go on.
  [[nodiscard]] double get(int i, int j) const {
    return static_cast<double>(values_[index(std::clamp(i, 0, nx_ - 1), std::clamp(j, 0, ny_ - 1))]);
  }
  [[nodiscard]] double between(const Vector2d& place) const {
    const int i = static_cast<int>(std::floor(place.x()));
    const int j = static_cast<int>(std::floor(place.y()));
    const double s = place.x() - i;
    const double t = place.y() - j;
    return (1 - t) * ((1 - s) * get(i, j) + s * get(i + 1, j)) + t * ((1 - s) * get(i, j + 1) + s * get(i + 1, j + 1));
  }
  [[nodiscard]] int nx() const { return nx_; }
  [[nodiscard]] int ny() const { return ny_; }
  [[nodiscard]] std::vector<float>& values() { return values_; }

 private:
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i);
  }
  int nx_;
  int ny_;
  std::vector<float> values_;
};

void blur(Field& field) {
  constexpr int kReach = 5;
  std::array<double, 2 * kReach + 1> weights{};
  double sum = 0.0;
  for (int k = -kReach; k <= kReach; ++k)
    sum += weights[static_cast<std::size_t>(k + kReach)] = std::exp(-0.5 * k * k / (kSigma * kSigma));
  for (double& weight : weights) weight /= sum;
  for (const bool up : {false, true}) {
    const Field before = field;
    for (int j = 0; j < field.ny(); ++j)
      for (int i = 0; i < field.nx(); ++i) {
        double value = 0.0;
        for (int k = -kReach; k <= kReach; ++k)
          value += weights[static_cast<std::size_t>(k + kReach)] * (up ? before.get(i, j + k) : before.get(i + k, j));
        field.at(i, j) = static_cast<float>(value);
      }
  }
}

/// Smoothed heights in node distances.
class Relief {
 public:
  explicit Relief(const DepthGrid& grid) : heights_(grid.lattice.nx, grid.lattice.ny) {
    std::vector<float> known = grid.height_m;
    for (std::size_t node = 0; node < known.size(); ++node)
      if (grid.state[node] == NodeState::unknown) known[node] = scene::kUnknownHeight;
    scene::continue_heights(known, grid.lattice.nx, grid.lattice.ny);
    const auto least = known.empty() ? 0.0F : *std::min_element(known.begin(), known.end());
    const double per_m = 1.0 / grid.lattice.spacing_m;
    for (std::size_t node = 0; node < known.size(); ++node)
      heights_.values()[node] = static_cast<float>(per_m * static_cast<double>(known[node] - least));
    blur(heights_);
  }
  [[nodiscard]] Vector2d slope(int i, int j) const {
    return 0.5 *
           Vector2d(heights_.get(i + 1, j) - heights_.get(i - 1, j), heights_.get(i, j + 1) - heights_.get(i, j - 1));
  }
  [[nodiscard]] Vector2d slope(const Vector2d& place) const {
    const auto x = [&](double d) { return heights_.between(place + Vector2d(d, 0.0)); };
    const auto y = [&](double d) { return heights_.between(place + Vector2d(0.0, d)); };
    return 0.5 * Vector2d(x(1.0) - x(-1.0), y(1.0) - y(-1.0));
  }
  [[nodiscard]] Eigen::Matrix2d curvature(int i, int j) const {
    const double here = heights_.get(i, j);
    const double xx = heights_.get(i + 1, j) - 2.0 * here + heights_.get(i - 1, j);
    const double yy = heights_.get(i, j + 1) - 2.0 * here + heights_.get(i, j - 1);
    const double xy = 0.25 * (heights_.get(i + 1, j + 1) - heights_.get(i - 1, j + 1) - heights_.get(i + 1, j - 1) +
                              heights_.get(i - 1, j - 1));
    return (Eigen::Matrix2d() << xx, xy, xy, yy).finished();
  }
  [[nodiscard]] double laplacian(int i, int j) const { return curvature(i, j).trace(); }

 private:
  Field heights_;
};

/// How much steeper it is at a place than on both sides of it, along the slope.
double excess_slope(const Relief& relief, const Vector2d& place) {
  const Vector2d slope = relief.slope(place);
  const double steepness = slope.norm();
  if (!(steepness > 0.0)) return 0.0;
  const Vector2d along = slope / steepness;
  const double before = relief.slope(place - kBeside * along).dot(along);
  const double behind = relief.slope(place + kBeside * along).dot(along);
  return steepness - std::max({before, behind, 0.0});
}

/// Known nodes, and those near a line.
class Nodes {
 public:
  explicit Nodes(const DepthGrid& grid) : grid_(grid) {}
  [[nodiscard]] bool known(int i, int j) const {
    const Lattice& l = grid_.lattice;
    return i >= 0 && j >= 0 && i < l.nx && j < l.ny && grid_.state[l.index(i, j)] != NodeState::unknown;
  }
  [[nodiscard]] bool known(int i, int j, bool up) const {
    return known(i, j) && known(i + (up ? 0 : 1), j + (up ? 1 : 0));
  }

 private:
  const DepthGrid& grid_;
};

// Sharp corners are less steep, smoothed, than the sides between which they lie: a line goes on through them (the
// hysteresis of Canny 1986).
std::vector<Contour> find_steps(const Relief& relief, const Nodes& nodes, const Lattice& lattice, double least_excess) {
  std::vector<Contour> lines = trace_contours(lattice.nx, lattice.ny, [&](int i, int j, bool up) {
    if (!nodes.known(i, j, up)) return kNan;
    const double share = zero_between(relief.laplacian(i, j), relief.laplacian(i + (up ? 0 : 1), j + (up ? 1 : 0)));
    if (std::isnan(share)) return kNan;
    const Vector2d place(i + (up ? 0.0 : share), j + (up ? share : 0.0));
    return excess_slope(relief, place) >= kWeak * least_excess ||
                   relief.slope(place).norm() >= kWeakSlope * least_excess
               ? share
               : kNan;
  });
  std::erase_if(lines, [&](const Contour& line) {
    const auto strong = std::count_if(line.points.begin(), line.points.end(), [&](const Vector2d& place) {
      return excess_slope(relief, place) >= least_excess;
    });
    return static_cast<double>(strong) < kStrongShare * static_cast<double>(line.points.size());
  });
  return lines;
}

/// The direction of the strongest curvature and that curvature, where it is strong and the other one is not.
struct Across {
  Vector2d direction = Vector2d::Zero();
  double curvature = 0.0;
};

Across across_ridge(const Relief& relief, int i, int j) {
  const Eigen::Matrix2d c = relief.curvature(i, j);
  const double mean = 0.5 * c.trace();
  const double half = std::hypot(0.5 * (c(0, 0) - c(1, 1)), c(0, 1));
  const double strong = mean >= 0.0 ? mean + half : mean - half;
  const double weak = 2.0 * mean - strong;
  if (std::abs(strong) < kTurn * kPeak || std::abs(weak) > kLineLike * std::abs(strong)) return {};
  const double turn = 0.5 * std::atan2(2.0 * c(0, 1), c(0, 0) - c(1, 1)) + (mean >= 0.0 ? 0.0 : 0.5 * std::numbers::pi);
  return {{std::cos(turn), std::sin(turn)}, strong};
}

/// Lines where `rise(i, j)` along the direction across changes its sign, between nodes that bend the same way, as far
/// as `counts(place, direction)`.
template <class Rise, class Counts>
std::vector<Contour> trace_across(const std::vector<Across>& across, const Nodes& nodes, const Lattice& lattice,
                                  const Rise& rise, const Counts& counts) {
  return trace_contours(lattice.nx, lattice.ny, [&](int i, int j, bool up) {
    if (!nodes.known(i, j, up)) return kNan;
    const int oi = i + (up ? 0 : 1);
    const int oj = j + (up ? 1 : 0);
    const Across& a = across[lattice.index(i, j)];
    const Across& b = across[lattice.index(oi, oj)];
    if (a.curvature * b.curvature <= 0.0) return kNan;
    const double sign = a.direction.dot(b.direction) >= 0.0 ? 1.0 : -1.0;
    const double share = zero_between(rise(i, j).dot(a.direction), sign * rise(oi, oj).dot(b.direction));
    if (std::isnan(share)) return kNan;
    return counts(Vector2d(i + (up ? 0.0 : share), j + (up ? share : 0.0)), a.direction) ? share : kNan;
  });
}

template <class Bend>
std::vector<Across> at_each_node(const Lattice& lattice, const Bend& bend) {
  std::vector<Across> across;
  across.reserve(lattice.count());
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) across.push_back(bend(i, j));
  return across;
}

std::vector<Contour> find_ridges(const Relief& relief, const Nodes& nodes, const Lattice& lattice) {
  const auto across = at_each_node(lattice, [&](int i, int j) { return across_ridge(relief, i, j); });
  return trace_across(
      across, nodes, lattice, [&](int i, int j) { return relief.slope(i, j); },
      [](const Vector2d&, const Vector2d&) { return true; });
}

/// The strongest curvature of the surface at a node: across which direction of the lattice (unit), and how much the
/// surface turns there per node distance, radians; of none that is strong, or of one with another beside it, 0.
Across sharpest_bend(const Relief& relief, int i, int j) {
  const Vector2d slope = relief.slope(i, j);
  Eigen::Matrix2d metric = Eigen::Matrix2d::Identity();
  metric += slope * slope.transpose();
  const Eigen::Matrix2d root_inverse = Eigen::LLT<Eigen::Matrix2d>(metric).matrixL().solve(Eigen::Matrix2d::Identity());
  const Eigen::Matrix2d shape =
      root_inverse * relief.curvature(i, j) * root_inverse.transpose() / std::sqrt(1.0 + slope.squaredNorm());
  const double mean = 0.5 * shape.trace();
  const double half = std::hypot(0.5 * (shape(0, 0) - shape(1, 1)), 0.5 * (shape(0, 1) + shape(1, 0)));
  const double strong = mean >= 0.0 ? mean + half : mean - half;
  const double weak = 2.0 * mean - strong;
  if (!(std::abs(strong) > 0.0) || std::abs(weak) > kLineLike * std::abs(strong)) return {};
  const double turn = 0.5 * std::atan2(shape(0, 1) + shape(1, 0), shape(0, 0) - shape(1, 1)) +
                      (mean >= 0.0 ? 0.0 : 0.5 * std::numbers::pi);
  const Vector2d across = root_inverse.transpose() * Vector2d(std::cos(turn), std::sin(turn));
  return {across.normalized(), strong / across.norm()};
}

/// Where the surface bends the most, along the way across.
std::vector<Contour> find_bends(const Relief& relief, const Nodes& nodes, const Lattice& lattice) {
  const auto across = at_each_node(lattice, [&](int i, int j) { return sharpest_bend(relief, i, j); });
  Field turns(lattice.nx, lattice.ny);
  for (std::size_t node = 0; node < across.size(); ++node)
    turns.values()[node] = static_cast<float>(std::abs(across[node].curvature));
  const auto rise = [&](int i, int j) {
    return Vector2d(turns.get(i + 1, j) - turns.get(i - 1, j), turns.get(i, j + 1) - turns.get(i, j - 1));
  };
  return trace_across(across, nodes, lattice, rise, [&](const Vector2d& place, const Vector2d& direction) {
    const double here = turns.between(place);
    const double beside =
        std::max(turns.between(place - kBeside * direction), turns.between(place + kBeside * direction));
    return here >= kTurn * kPeak && here >= kProminent * beside;
  });
}

/// Lines without what lies near `others`; pieces of at least kShortest nodes.
std::vector<Contour> away_from(const std::vector<Contour>& lines, const std::vector<Contour>& others,
                               const Lattice& lattice) {
  std::vector<bool> taken(lattice.count(), false);
  const int reach = static_cast<int>(kNearOther);
  for (const Contour& other : others)
    for (const Vector2d& point : other.points)
      for (int dj = -reach; dj <= reach; ++dj)
        for (int di = -reach; di <= reach; ++di) {
          const int i = static_cast<int>(std::lround(point.x())) + di;
          const int j = static_cast<int>(std::lround(point.y())) + dj;
          if (i >= 0 && j >= 0 && i < lattice.nx && j < lattice.ny) taken[lattice.index(i, j)] = true;
        }
  std::vector<Contour> left;
  for (const Contour& line : lines) {
    Contour run;
    const auto end_run = [&] {
      if (run.length() >= kShortest) left.push_back(run);
      run.points.clear();
    };
    for (const Vector2d& point : line.points) {
      const int i = std::clamp(static_cast<int>(std::lround(point.x())), 0, lattice.nx - 1);
      const int j = std::clamp(static_cast<int>(std::lround(point.y())), 0, lattice.ny - 1);
      if (taken[lattice.index(i, j)])
        end_run();
      else
        run.points.push_back(point);
    }
    end_run();
  }
  return left;
}

bool on_rim(const Vector2d& point, const Lattice& lattice) {
  return point.x() <= 0.0 || point.y() <= 0.0 || point.x() >= lattice.nx - 1 || point.y() >= lattice.ny - 1;
}

/// Without the rim, where that is much of it.
std::vector<Contour> without_rim(const Contour& border, const Lattice& lattice) {
  double rim = 0.0;
  for (std::size_t k = 1; k < border.points.size(); ++k)
    if (on_rim(border.points[k - 1], lattice) && on_rim(border.points[k], lattice))
      rim += (border.points[k] - border.points[k - 1]).norm();
  if (rim <= kMostRim * border.length()) return {border};
  // From a point on the rim on, so that no run is cut where the line happens to begin.
  std::vector<Vector2d> points = border.points;
  if (border.closed()) {
    points.pop_back();
    const auto first =
        std::find_if(points.begin(), points.end(), [&](const Vector2d& p) { return on_rim(p, lattice); });
    std::rotate(points.begin(), first, points.end());
    points.push_back(points.front());
  }
  std::vector<Contour> runs(1);
  for (const Vector2d& point : points) {
    if (!on_rim(point, lattice))
      runs.back().points.push_back(point);
    else if (!runs.back().points.empty())
      runs.emplace_back();
  }
  return runs;
}

/// Between known and unknown nodes.
std::vector<Contour> stone_borders(const DepthGrid& grid) {
  const Lattice& lattice = grid.lattice;
  std::vector<Contour> found;
  if (lattice.nx < 3 || lattice.ny < 3) return found;
  const Nodes nodes(grid);
  for (const Contour& border : trace_border(lattice.nx, lattice.ny, [&](int i, int j) { return nodes.known(i, j); }))
    for (Contour& run : without_rim(border, lattice))
      if (run.length() >= kShortestBorder) found.push_back(std::move(run));
  return found;
}

/// Steps and what else `find` finds, each away from the ones before and from `borders`.
template <class Find>
std::vector<Contour> creases_beside(const std::vector<Contour>& borders, const DepthGrid& grid, double noise_m,
                                    const Find& find) {
  const Lattice& lattice = grid.lattice;
  if (lattice.nx < 3 || lattice.ny < 3) return {};
  const Nodes nodes(grid);
  const Relief relief(grid);
  // Smoothed, a step of height h between two nodes is h / (sigma sqrt(2 pi)) steep.
  const double least_step = std::max(kStepNodes, kStepNoises * noise_m / lattice.spacing_m);
  const double least_excess = least_step / (kSigma * std::sqrt(2.0 * std::numbers::pi));
  std::vector<Contour> found = away_from(find_steps(relief, nodes, lattice, least_excess), borders, lattice);
  std::vector<Contour> taken = borders;
  taken.insert(taken.end(), found.begin(), found.end());
  for (Contour& line : away_from(find(relief, nodes, lattice), taken, lattice)) found.push_back(std::move(line));
  return found;
}

/// In the grid frame, longest first.
std::vector<Line> finished(std::vector<Contour> contours, const Lattice& lattice) {
  std::sort(contours.begin(), contours.end(),
            [](const Contour& a, const Contour& b) { return a.length() > b.length(); });
  std::vector<Line> lines;
  for (Contour& contour : contours) {
    smooth(contour, kSmoothings);
    simplify(contour, kTolerance);
    Line line;
    for (const Vector2d& point : contour.points)
      line.emplace_back(lattice.origin_m.head<2>() + lattice.spacing_m * point);
    if (line.size() > 1) lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace

std::vector<Contour> trace_border(int nx, int ny, const std::function<bool(int, int)>& inside) {
  const auto is_inside = [&](int i, int j) { return i >= 0 && j >= 0 && i < nx && j < ny && inside(i, j); };
  const auto on_grid = [&](int i, int j) { return i >= 0 && j >= 0 && i < nx && j < ny; };
  // One node more on every side.
  std::vector<Contour> lines = trace_contours(nx + 2, ny + 2, [&](int pi, int pj, bool up) {
    const int i = pi - 1;
    const int j = pj - 1;
    const int oi = i + (up ? 0 : 1);
    const int oj = j + (up ? 1 : 0);
    const bool here = is_inside(i, j);
    if (here == is_inside(oi, oj)) return kNan;
    if (!on_grid(i, j)) return 1.0;
    return on_grid(oi, oj) ? 0.5 : 0.0;
  });
  for (Contour& line : lines)
    for (Vector2d& point : line.points) point -= Vector2d::Ones();
  return lines;
}

std::vector<Line> find_borders(const Lattice& lattice, const std::function<bool(int, int)>& inside) {
  return finished(trace_border(lattice.nx, lattice.ny, inside), lattice);
}

std::vector<Line> find_outlines(const DepthGrid& grid, double noise_m) {
  std::vector<Contour> found = stone_borders(grid);
  std::vector<Contour> creases = creases_beside(found, grid, noise_m, find_ridges);
  found.insert(found.end(), creases.begin(), creases.end());
  return finished(std::move(found), grid.lattice);
}

std::vector<Line> find_creases(const DepthGrid& grid, double noise_m) {
  return finished(creases_beside(stone_borders(grid), grid, noise_m, find_bends), grid.lattice);
}

}  // namespace sparsha::haptics
