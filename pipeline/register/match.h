// Where two posed surfaces meet: pairs of elements, and what they say of overlap and distance.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "pipeline/register/surface.h"

namespace sparsha::pipeline {

/// Two elements that are taken for the same place. Common frame.
struct Match {
  Eigen::Vector3d place;        ///< between the two
  Eigen::Vector3d from_normal;  ///< both with the sign of the one searched from
  Eigen::Vector3d to_normal;
  double distance_m = 0.0;  ///< from minus to, along the mean normal (Rusinkiewicz 2019)
  std::size_t from = 0;     ///< elements
  std::size_t to = 0;

  [[nodiscard]] Eigen::Vector3d normal() const { return (from_normal + to_normal).normalized(); }
};

struct MatchLimits {
  double distance_m = 0.0;
  double least_cosine = 0.7;  ///< between normals
  std::size_t most = 0;       ///< of the elements at most so many, evenly chosen; 0 = all
  bool any_sign = false;      ///< normals may be opposite although their signs are known
};

struct Matches {
  std::vector<Match> pairs;
  std::size_t tried = 0;  ///< elements with a normal
  [[nodiscard]] double share() const {
    return tried == 0 ? 0.0 : static_cast<double>(pairs.size()) / static_cast<double>(tried);
  }
};

/// For elements of `from` the nearest ones of `to`. Places where `to` ends match nothing: what lies beyond them would
/// pull. Poses take the surfaces' coordinates to the common frame.
/// Only the elements `among` are tried where it is given.
[[nodiscard]] Matches match(const StationSurface& from, const Eigen::Isometry3d& from_pose, const StationSurface& to,
                            const Eigen::Isometry3d& to_pose, const MatchLimits& limits,
                            const std::vector<std::size_t>* among = nullptr);

/// Least information below which what two surfaces have in common can slide.
constexpr double kLeastInformation = 2e-4;

/// Of two surfaces, in both directions.
struct Agreement {
  double overlap = 0.0;     ///< the larger of the two shares
  double residual_m = 0.0;  ///< RMS of the distances
  std::size_t matches = 0;
  /// Mean information about the motion of one against the other, of unit distances and of lengths over `reach_m`:
  /// its smallest eigenvalue is near 0 when a motion changes no distance. From products of the two surfaces' own
  /// normals, whose noises are independent, so that noise does not look like form.
  double least_information = 0.0;
};
[[nodiscard]] Agreement agreement(const StationSurface& a, const Eigen::Isometry3d& a_pose, const StationSurface& b,
                                  const Eigen::Isometry3d& b_pose, const MatchLimits& limits);

/// How firmly two surfaces hold each other where they lie on one another within their noise.
struct Hold {
  std::size_t matches = 0;         ///< that do
  double share = 0.0;              ///< of all that meet
  double least_information = 0.0;  ///< of those, as of an Agreement
  /// Of the information about the motion that is told worst, the share that those tell: where it is low, most of what
  /// could tell contradicts.
  double least_share = 0.0;
  /// That motion of the one searched from: turned about `middle` and shifted, so that it moves points by 1 m.
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< radians
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();

  /// Whether most of what could contradict the pose agrees. Of scans of a hall, one that lies 0.5 m along it from its
  /// place has a share of 0.95 and a least share of 0.4 at most; right ones have 0.94 and 0.5 at least.
  [[nodiscard]] bool holds() const {
    return share >= 0.8 && least_share >= 0.48 && least_information >= kLeastInformation;
  }
  /// The motion by so much.
  [[nodiscard]] Eigen::Isometry3d moved(double by_m) const;
};
[[nodiscard]] Hold hold_of(const std::vector<Match>& met, double near_m);

}  // namespace sparsha::pipeline
