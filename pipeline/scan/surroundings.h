// The points about some places of a scan, gathered from a stream of all its points.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "base/numbers/hash.h"

namespace sparsha::pipeline {

class Surroundings {
 public:
  /// Points within `reach` of a place are gathered.
  Surroundings(std::vector<Eigen::Vector3d> places, double reach);

  void add(const Eigen::Vector3d& point);

  /// Median over the places of the distance of points that lie evenly about each. There must be places.
  [[nodiscard]] double apart() const;

  /// Calls use(away) with the points about each place, itself among them, relative to it; crowds are left out.
  template <typename Use>
  void each(const Use& use) const {
    for (const Around& around : around_)
      if (around.count <= kMostKept) use(around.away);
  }

 private:
  static constexpr std::uint64_t kMostKept = 2048;
  struct Around {
    std::uint64_t count = 0;
    std::vector<Eigen::Vector3d> away;
  };
  using Cell = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Cell& cell) const { return static_cast<std::size_t>(hash_cell(cell)); }
  };
  [[nodiscard]] Cell cell_of(const Eigen::Vector3d& p) const;

  std::vector<Eigen::Vector3d> places_;
  std::vector<Around> around_;
  double reach_;
  std::unordered_map<Cell, std::vector<std::uint32_t>, Hash> near_;  ///< places by the cells about them
};

}  // namespace sparsha::pipeline
