// Which side of a surface is outside, voted by what is seen of it from 26 directions: so a layer seen from behind
// through a hole is no front, wherever one looks from.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/base/thread_pool.h"
#include "pipeline/grid/project_extent.h"
#include "pipeline/grid/project_points.h"
#include "pipeline/grid/tangent_discs.h"

namespace sparsha::pipeline {

/// A sample of the cloud with outward normals, in columns.
class FacingField {
 public:
  /// Of about `most` points, chosen by a hash. `spacing_m` is the cloud's on the surface. Depends neither on threads
  /// nor on the points' order.
  FacingField(const OrientedPieces& pieces, const PointTotals& totals, const Extent& extent, double spacing_m,
              ThreadPool& pool);

  /// Of what the viewer sees first, the share that faces away: holes in the front. Where it is large, holes are an
  /// unlikely reason.
  [[nodiscard]] double share_turned_away() const;

  /// Sets the facing of each disc: 1 towards the viewer, -1 away, 0 where neither is sure.
  void set_facing(TangentDiscs& discs, ThreadPool& pool) const;

 private:
  struct Neighbour {
    std::uint32_t sample;
    float cosine;  // of the normals
  };
  void vote(ThreadPool& pool);
  void find_neighbours(ThreadPool& pool);
  void spread_votes(ThreadPool& pool);
  void overrule_by_surface();
  [[nodiscard]] float facing(float x, float y, float z, float slope_x, float slope_y) const;
  /// Calls use(sample) for the samples of the columns around a place; false when it lies beyond them.
  template <typename Use>
  bool for_near(float x, float y, const Use& use) const;

  double spacing_m_ = 0.0;  // of the sample
  TangentDiscs samples_;
  std::vector<std::uint32_t> of_slot_;                 // samples in order -> places in the arrays of samples_
  std::vector<float> normal_x_, normal_y_, normal_z_;  // unit; z >= 0
  std::vector<float> votes_;                           // positive: the normal points outwards
  std::vector<std::vector<Neighbour>> near_;  // of the samples, in order and in pieces, while votes are counted
  std::vector<std::uint32_t> near_counts_;
  std::vector<std::uint8_t> seen_;  // by the viewer
  std::vector<float> away_top_m_;   // of each column: above it nothing near faces away
};

}  // namespace sparsha::pipeline
