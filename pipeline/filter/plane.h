// The floor, table or wall of a scan: the largest plane of about a given direction (Fischler & Bolles 1981, RANSAC).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/numbers/hash.h"
#include "base/numbers/key_table.h"
#include "base/threads/context.h"
#include "pipeline/filter/point_test.h"
#include "scene/config/filters.h"

namespace sparsha::pipeline {

/// One point a cube of space, chosen by a hash of its coordinates: counts area, not points, so that a dense statue does
/// not outweigh a floor seen from afar. Cubes are twice the plane's thickness wide at first and double while there are
/// more than kMost, so that the sample depends on the set of points alone. Constant memory.
class PlaneSample {
 public:
  static constexpr std::size_t kMost = std::size_t{1} << 16;

  explicit PlaneSample(double distance_m) : per_m_(0.5 / distance_m) {}
  void add(const Eigen::Vector3f& point);
  /// In the order of their hashes; relative to the cloud's origin.
  [[nodiscard]] std::vector<Eigen::Vector3f> take();

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::uint64_t operator()(const Cell& cell) const { return hash_cell(cell); }
  };
  struct Chosen {
    Cell key{};
    std::uint64_t hash = ~std::uint64_t{0};
    Eigen::Vector3f point = Eigen::Vector3f::Zero();
  };
  static bool before(const Chosen& a, const Chosen& b);
  void offer(const Chosen& chosen);

  double per_m_;
  KeyTable<Chosen, CellHash> table_;
};

struct FoundPlane {
  PlaneCut cut;
  double angle_deg = 0.0;  ///< between its normal and the one asked for
  double share = 0.0;      ///< of the sampled surface that lies within the distance
  double rms_m = 0.0;      ///< of that, about the plane
  double of_object = 0.0;  ///< share_of_object() of the sampled surface
};

/// In words, for a report.
[[nodiscard]] std::string to_string(const FoundPlane& plane);

/// The largest plane within the angle, fitted again in double precision to what lies within the distance. Seeded: the
/// same sample gives the same plane. Throws Error{input} with what was found when no plane stands out.
[[nodiscard]] FoundPlane find_plane(PlaneSample& sample, const scene::RemovePlaneConfig& config,
                                    const Context& context);

/// By PCL's RANSAC and model of a plane: normal and offset of the plane with the most of `points` within `distance`,
/// its normal within `max_angle_deg` of `direction` (length 1); zeros when there is none.
[[nodiscard]] Eigen::Vector4d plane_by_pcl(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& direction,
                                           double max_angle_deg, double distance);

}  // namespace sparsha::pipeline
