// Gauss-Newton over the poses. Every edge gives a 6x6 block: both of its poses move the same matches, in opposite ways.
#include "pipeline/register/relaxation.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "base/numbers/statistics.h"
#include "pipeline/register/match.h"

namespace sparsha::pipeline {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kShrink = 0.6;  // of the distance from stage to stage
// Of a stage.
struct Effort {
  int iterations;
  double settled;      ///< spacings that the last step may move points
  std::size_t sample;  ///< elements tried of a surface; 0: all
};
constexpr Effort kRough{12, 3e-3, 3000};
constexpr Effort kSettling{40, 3e-4, 8000};
constexpr Effort kWhole{8, 3e-4, 0};
constexpr double kNear = 2.0;              // distances within which elements are looked at again in a stage
constexpr double kTukey = 4.685 * 1.4826;  // 95 % efficiency at Gaussian noise, from the median of magnitudes
constexpr double kDamping = 1e-7;          // of the diagonal: directions that no match holds stay

class Relaxation {
 public:
  Relaxation(std::vector<PosedSurface>& scans, const std::vector<Edge>& edges, const Context& context)
      : scans_(scans), edges_(edges), context_(context), matches_(2 * edges.size()) {
    for (const PosedSurface& scan : scans) spacing_m_ = std::max(spacing_m_, scan.surface->spacing_m());
    measure_reach();
  }

  void stage(double distance_m, const Effort& effort) {
    MatchLimits limits;
    limits.distance_m = distance_m;
    limits.most = effort.sample;
    find_near(limits);
    for (int k = 0; k < effort.iterations; ++k) {
      context_.progress.throw_if_cancelled();
      find_matches(limits);
      if (step(distance_m) < effort.settled * spacing_m_) return;
    }
  }

 private:
  // Rotations are about the middle of all elements and counted in lengths at their RMS distance, so that all six
  // unknowns of a pose are of one kind.
  void measure_reach() {
    double count = 0.0;
    for (const PosedSurface& scan : scans_) {
      for (const StationSurface::Element& element : scan.surface->elements()) {
        middle_ += scan.pose * element.point;
        count += 1.0;
      }
    }
    middle_ /= std::max(1.0, count);
    for (const PosedSurface& scan : scans_)
      for (const StationSurface::Element& element : scan.surface->elements())
        reach_m_ += (scan.pose * element.point - middle_).squaredNorm();
    reach_m_ = std::sqrt(reach_m_ / std::max(1.0, count));
    if (!(reach_m_ > 0.0)) reach_m_ = 1.0;
  }

  [[nodiscard]] Matches match_of(std::size_t k, MatchLimits limits, const std::vector<std::size_t>* among) const {
    const Edge& edge = edges_[k / 2];
    const PosedSurface& from = scans_[k % 2 == 0 ? edge.a : edge.b];
    const PosedSurface& to = scans_[k % 2 == 0 ? edge.b : edge.a];
    limits.any_sign = edge.any_sign;
    return match(*from.surface, from.pose, *to.surface, to.pose, limits, among);
  }

  template <typename Work>
  void for_directions(const Work& work) {
    context_.pool.for_ranges(matches_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        context_.progress.throw_if_cancelled();
        work(k);
      }
    });
  }

  // Elements that may meet the other surface within this stage: most of a scan lies elsewhere.
  void find_near(MatchLimits limits) {
    limits.distance_m *= kNear;
    near_.assign(matches_.size(), {});
    for_directions([&](std::size_t k) {
      for (const Match& pair : match_of(k, limits, nullptr).pairs) near_[k].push_back(pair.from);
    });
  }

  void find_matches(const MatchLimits& limits) {
    for_directions([&](std::size_t k) { matches_[k] = match_of(k, limits, &near_[k]); });
  }

  // Where Tukey's weight ends.
  [[nodiscard]] double cut() const {
    std::vector<double> magnitudes;
    for (const Matches& matches : matches_)
      for (const Match& pair : matches.pairs) magnitudes.push_back(std::fabs(pair.distance_m));
    if (magnitudes.empty()) return 0.0;
    return std::max(kTukey * median(magnitudes), 1e-6 * spacing_m_);
  }

  // One step of all poses; returns how far it moves a point at the reach, at most.
  double step(double most_m) {
    const double limit = cut();
    if (!(limit > 0.0)) return 0.0;
    const auto size = static_cast<Eigen::Index>(6 * (scans_.size() - 1));
    Eigen::MatrixXd normal_matrix = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    for (std::size_t k = 0; k < matches_.size(); ++k) {
      const Edge& edge = edges_[k / 2];
      const std::size_t from = k % 2 == 0 ? edge.a : edge.b;
      const std::size_t to = k % 2 == 0 ? edge.b : edge.a;
      Matrix6d block = Matrix6d::Zero();
      Vector6d pull = Vector6d::Zero();
      for (const Match& pair : matches_[k].pairs) {
        const double u = pair.distance_m / limit;
        if (std::fabs(u) >= 1.0) continue;
        const double weight = (1.0 - u * u) * (1.0 - u * u);
        const Eigen::Vector3d normal = pair.normal();
        Vector6d row;
        row << ((pair.place - middle_) / reach_m_).cross(normal), normal;
        block += weight * row * row.transpose();
        pull += weight * pair.distance_m * row;
      }
      const auto f = static_cast<Eigen::Index>(6 * from) - 6;
      const auto t = static_cast<Eigen::Index>(6 * to) - 6;
      if (f >= 0) {
        normal_matrix.block<6, 6>(f, f) += block;
        right.segment<6>(f) -= pull;
      }
      if (t >= 0) {
        normal_matrix.block<6, 6>(t, t) += block;
        right.segment<6>(t) += pull;
      }
      if (f >= 0 && t >= 0) {
        normal_matrix.block<6, 6>(f, t) -= block;
        normal_matrix.block<6, 6>(t, f) -= block;
      }
    }
    normal_matrix.diagonal() += kDamping * normal_matrix.diagonal();
    normal_matrix.diagonal().array() += 1e-12;
    const Eigen::VectorXd solution = normal_matrix.ldlt().solve(right);
    if (!solution.allFinite()) return 0.0;
    double moved = 0.0;
    for (Eigen::Index k = 0; k < size; k += 3) moved = std::max(moved, solution.segment<3>(k).norm());
    const double scale = moved > most_m ? most_m / moved : 1.0;
    for (std::size_t s = 1; s < scans_.size(); ++s)
      move(scans_[s].pose, scale * solution.segment<6>(static_cast<Eigen::Index>(6 * s) - 6));
    return moved;
  }

  void move(Eigen::Isometry3d& pose, const Vector6d& by) const {
    const Eigen::Vector3d turn = by.head<3>() / reach_m_;
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    if (const double angle = turn.norm(); angle > 0.0)
      rotation = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
    const Eigen::Vector3d translation = rotation * (pose.translation() - middle_) + middle_ + by.tail<3>();
    pose.linear() = Eigen::Quaterniond(Eigen::Matrix3d(rotation * pose.linear())).normalized().toRotationMatrix();
    pose.translation() = translation;
  }

  std::vector<PosedSurface>& scans_;
  const std::vector<Edge>& edges_;
  const Context& context_;
  std::vector<Matches> matches_;  // of edge k: 2k from a to b, 2k + 1 from b to a
  std::vector<std::vector<std::size_t>> near_;
  double spacing_m_ = 0.0;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  double reach_m_ = 0.0;
};

}  // namespace

void relax_jointly(std::vector<PosedSurface>& scans, const std::vector<Edge>& edges, double from_m, double to_m,
                   const Context& context) {
  if (scans.size() < 2 || edges.empty()) return;
  Relaxation relaxation(scans, edges, context);
  for (double distance_m = from_m; distance_m > to_m; distance_m *= kShrink) relaxation.stage(distance_m, kRough);
  relaxation.stage(to_m, kSettling);
}

void settle_jointly(std::vector<PosedSurface>& scans, const std::vector<Edge>& edges, double within_m,
                    const Context& context) {
  if (scans.size() < 2 || edges.empty()) return;
  Relaxation(scans, edges, context).stage(within_m, kWhole);
}

}  // namespace sparsha::pipeline
