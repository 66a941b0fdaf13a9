// Which side of a surface is outside, voted by what is seen of it from 26 directions: so a layer seen from behind
// through a hole is no front, wherever one looks from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/threads/thread_pool.h"
#include "pipeline/projection/extent.h"
#include "pipeline/projection/points.h"
#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/tangent_discs.h"

namespace sparsha::pipeline {

/// Some points that a scanner saw, as oriented points are, and the unit direction in which each was seen from, or in
/// which its file's normal points.
struct StationView {
  std::vector<Eigen::Vector3f> seen;
  std::vector<Eigen::Vector3f> towards;
  Eigen::Vector3f stood = Eigen::Vector3f::Zero();  ///< where the scanner stood, as oriented points are
  bool normals = false;                             ///< `towards` are normals
  bool proved = false;  ///< a scanner stood there, whatever is seen of the points from outside
};

/// What tells the sides of a surface. `views`: what is seen of it from 26 directions. `certain`: only surfaces that
/// are seen to be closed, which both face the viewer and face away, and stations. From the views alone a front before a
/// back and a canopy before the ground look the same. `whole`: as views, and what is connected has one outer side, on
/// which most of its votes are: an object that is touched from all sides, although its foot may be open.
enum class SideEvidence { views, certain, whole };

/// A sample of the cloud with outward normals, in columns.
class FacingField {
 public:
  /// Of about `samples` points, chosen by a hash. `spacing_m` is the cloud's on the surface. Depends neither on threads
  /// nor on the points' order. What a station saw faces it, unless its points' sides are known and say otherwise; where
  /// it is proved that a scanner stood there, it was within a room, a cave or a tunnel, whose inside is the surface.
  FacingField(const OrientedPieces& pieces, const PointTotals& totals, const Extent& extent, double spacing_m,
              double samples, const std::vector<StationView>& stations, SideEvidence evidence, ThreadPool& pool);

  /// What a sample takes at most while sides are told apart, and what of it is kept, bytes: measured, and rounded up.
  static constexpr std::uint64_t kBytesOfSample = 500, kKeptOfSample = 150;

  /// Of what the viewer sees first, the share that faces away: holes in the front. Where it is large, holes are an
  /// unlikely reason.
  [[nodiscard]] double share_turned_away() const;

  /// Whether walls of a room that face away stand before those that a viewer without the nearer ones would see, by
  /// proved stations.
  [[nodiscard]] bool sees_through() const;
  /// Whether a place is on such a wall, which hides nothing then.
  [[nodiscard]] bool is_wall_from_behind(float x, float y, float z) const;

  /// Stations that contradict what is seen of their points from outside; they are not asked.
  [[nodiscard]] const std::vector<std::size_t>& lying_stations() const { return lying_stations_; }

  /// Sets the facing of each disc: 1 towards the viewer, -1 away, 0 where neither is sure.
  void set_facing(TangentDiscs& discs, ThreadPool& pool) const;
  /// Whose word is taken: of everything that tells a side, of surfaces alone that are seen to be closed, or of
  /// stations.
  enum class Word { of_all, of_closed_surfaces, of_stations };
  /// The same for places [0, count): of their records (kDiscRecord values) z and slopes are read, and facing is set
  /// where samples can be near.
  void set_facing(Word word, const float* x, const float* y, float* records, std::size_t count) const;

  /// Whether it tells the side of any sample.
  [[nodiscard]] bool has(Word word) const;

 private:
  struct Neighbour {
    std::uint32_t sample;
    float cosine;  // of the normals
  };
  void vote(ThreadPool& pool);
  void find_neighbours(ThreadPool& pool);
  void spread_votes(ThreadPool& pool);
  void overrule_by_surface(SideEvidence evidence);
  void forget_views();
  void ask_stations(const std::vector<StationView>& stations);
  void turn_rooms(const std::vector<float>& sides);
  [[nodiscard]] std::vector<float> seen_from(const StationView& station) const;
  [[nodiscard]] float side_of_stations(const Eigen::Vector3f& place, const Eigen::Vector3f& normal) const;
  void ask_where_scanners_stood(const float* x, const float* y, float* records, std::size_t begin,
                                std::size_t end) const;
  void spread_sides(std::vector<float>& sides) const;
  [[nodiscard]] FacingKernel kernel() const;
  /// The samples of a row of columns: the first, and how many.
  [[nodiscard]] std::uint32_t row_begin(std::size_t row) const { return row_start(row)[0]; }
  [[nodiscard]] std::uint32_t row_size(std::size_t row) const {
    return row_start(row)[samples_.columns.bins_x()] - row_start(row)[0];
  }
  [[nodiscard]] const std::uint32_t* row_start(std::size_t row) const {
    return samples_.start.get() + row * static_cast<std::size_t>(samples_.columns.bins_x() + 1);
  }

  double spacing_m_ = 0.0;  // of the sample
  TangentDiscs samples_;
  std::vector<std::uint32_t> of_slot_;  // samples in order -> places in the arrays of samples_
  // By place, and some zeros beyond for vector reads.
  std::vector<float> height_;                          // metres
  std::vector<float> normal_x_, normal_y_, normal_z_;  // unit; z >= 0
  std::vector<float> votes_;                           // positive: the normal points outwards
  std::vector<std::vector<Neighbour>> near_;           // of the samples of each row, in order, while votes are counted
  std::vector<std::uint32_t> near_counts_;
  std::vector<std::uint8_t> seen_;                // by the viewer
  std::vector<std::uint8_t> told_;                // by stations
  std::vector<std::uint8_t> closed_;              // on a surface that is seen to be closed
  std::vector<float> told_votes_, closed_votes_;  // votes_ of these alone, else 0
  std::vector<float> outside_;        // where a surface's votes agree: 1 the normal's side, -1 the other; else 0
  std::vector<std::uint32_t> part_;   // of each sample a number for what it is connected with,
  std::vector<float> part_side_;      // and which of its sides is on the same side of that
  std::vector<std::uint8_t> proved_;  // by a proved station; empty without any
  bool sees_through_ = false;
  std::vector<Eigen::Vector3f> stood_;  // all scanners of a room, each of them proved; else empty
  std::vector<std::size_t> lying_stations_;
  std::vector<float> away_top_m_;  // of each column: above it nothing near faces away
};

}  // namespace sparsha::pipeline
