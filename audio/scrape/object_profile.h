// A whole object as a needle reads it: the sheets of its charts, on all sides.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "audio/scrape/profile.h"
#include "scene/charts.h"
#include "scene/scene_fwd.h"

namespace sparsha::audio {

/// Heights along the side that a sheet belongs to, cubic between its nodes; at its ends the nearest nodes go on.
class ObjectProfile final : public Profile {
 public:
  /// Without `texture` the envelope, where the charts have one. `grain` may be null. Requires scene.charts.
  ObjectProfile(scene::ScenePointer scene, bool texture, std::shared_ptr<const scene::GrainField> grain);

  [[nodiscard]] const Eigen::Vector3d& origin_m() const noexcept override;
  /// The one that the needle was on, as far as the stone faces it by 60 degrees, else the one that it faces best.
  [[nodiscard]] std::size_t sheet_at(const Eigen::Vector3d& place_m, std::size_t last) const noexcept override;
  [[nodiscard]] double height_m(std::size_t sheet, const Eigen::Vector3d& place_m) const noexcept override;
  [[nodiscard]] double facing(std::size_t sheet, const Eigen::Vector3d& place_m) const noexcept override;
  [[nodiscard]] double grain_m(std::size_t sheet, const Eigen::Vector3d& place_m, double per_sample_m,
                               double shortest_m) const noexcept override;

 private:
  /// A cell of a sheet and where in it a place is.
  struct Cell {
    int i = 0, j = 0;
    double s = 0.0, t = 0.0;
    double w_m = 0.0;  ///< of the place
  };
  [[nodiscard]] std::optional<Cell> cell_at(const scene::Sheet& sheet, const Eigen::Vector3d& place_m) const noexcept;
  [[nodiscard]] double node_m(const scene::Sheet& sheet, std::size_t node) const noexcept;
  [[nodiscard]] std::optional<double> facing_of(const scene::Sheet& sheet,
                                                const Eigen::Vector3d& place_m) const noexcept;
  [[nodiscard]] Eigen::Vector3d in_chart_normal(const scene::Sheet& sheet, const Cell& cell) const noexcept;

  scene::ScenePointer scene_;  // keeps the charts
  const scene::Charts& charts_;
  bool texture_;
  ProfileGrain grain_;
};

}  // namespace sparsha::audio
