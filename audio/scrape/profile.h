// The heights that a sliding hand passes over, as the needle of the scraping sound reads them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "haptics/state/state.h"
#include "scene/area/region_frame.h"
#include "scene/depth_grid.h"
#include "scene/frame/touched_view.h"
#include "scene/material/grain_field.h"
#include "scene/scene_fwd.h"

namespace sparsha::audio {

/// What a needle reads: how high the stone is along its way. Places in metres of the grid frame, relative to
/// origin_m(). Immutable; made off the sound card's thread, read by it. No allocation.
class Profile {
 public:
  virtual ~Profile() = default;
  Profile() = default;
  Profile(const Profile&) = delete;
  Profile& operator=(const Profile&) = delete;

  [[nodiscard]] virtual const Eigen::Vector3d& origin_m() const noexcept = 0;
  /// Within a sheet heights go on in each other. The one at a place on the stone; `last` where the needle was.
  [[nodiscard]] virtual std::size_t sheet_at(const Eigen::Vector3d& place_m, std::size_t last) const noexcept = 0;
  /// Smooth along a sheet; not a number where it has none.
  [[nodiscard]] virtual double height_m(std::size_t sheet, const Eigen::Vector3d& place_m) const noexcept = 0;
  /// What of a rise of heights is along the stone's normal, 0 to 1.
  [[nodiscard]] virtual double facing(std::size_t sheet, const Eigen::Vector3d& place_m) const noexcept = 0;
  /// Height of the grain at such a place, along the normal, of waves that are `shortest_m` long or longer and that
  /// samples which are `per_sample_m` apart can tell.
  [[nodiscard]] virtual double grain_m(std::size_t sheet, const Eigen::Vector3d& place_m, double per_sample_m,
                                       double shortest_m) const noexcept = 0;
};

/// The grain of a scene as sound has it. Immutable; cheap to copy.
class ProfileGrain {
 public:
  ProfileGrain() = default;
  /// `field` may be null.
  ProfileGrain(const scene::SceneDescription& scene, std::shared_ptr<const scene::GrainField> field);
  /// As Profile::grain_m() at a place of the grid frame; on a whole object where its normal (unit) is `normal`, null:
  /// of one view.
  [[nodiscard]] double height_m(const Eigen::Vector3d& grid_m, const Eigen::Vector3d* normal, double per_sample_m,
                                double shortest_m) const noexcept;

 private:
  std::shared_ptr<const scene::GrainField> field_;
  std::optional<scene::RegionFrame> region_from_grid_;
  double enlarged_ = 1.0;  // metres of the regions' frame per metre of the grid frame
};

/// One window of one view.
class ViewProfile final : public Profile {
 public:
  /// Which nodes of which level: the finest one of which the window has at most kMostNodes per side.
  using Window = scene::TouchedView;  ///< of a point: the tip's place lies on the stone
  static constexpr int kMostNodes = 1024;
  /// The window that the servo renders.
  [[nodiscard]] static Window window_of(const scene::SceneDescription& scene, const haptics::State& state);

  /// `grain` may be null. Throws Error{input} when tiles cannot be read.
  ViewProfile(const scene::Scene& scene, const Window& window, std::shared_ptr<const scene::GrainField> grain);

  /// The window's node (0, 0) and zero of its heights.
  [[nodiscard]] const Eigen::Vector3d& origin_m() const noexcept override { return origin_m_; }
  [[nodiscard]] std::size_t sheet_at(const Eigen::Vector3d&, std::size_t) const noexcept override { return 0; }
  /// Cubic between the nodes (Catmull-Rom: through them, without creases), level beyond the window; z is not read.
  [[nodiscard]] double height_m(std::size_t sheet, const Eigen::Vector3d& place_m) const noexcept override;
  [[nodiscard]] double facing(std::size_t, const Eigen::Vector3d&) const noexcept override { return 1.0; }
  [[nodiscard]] double grain_m(std::size_t sheet, const Eigen::Vector3d& place_m, double per_sample_m,
                               double shortest_m) const noexcept override;

 private:
  scene::Lattice lattice_;  ///< of the window with its margin
  int margin_ = 0;          ///< nodes on every side
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
  std::vector<float> height_m_;
  ProfileGrain grain_;
};

/// Makes the profile of the window under the hand, or of the whole object, whenever that changes. One thread, not the
/// sound card's.
class ProfileReader {
 public:
  /// `grain`: whether what lies between the nodes is continued.
  ProfileReader(scene::ScenePointer scene, bool grain) : scene_(std::move(scene)), with_grain_(grain) {}

  /// After a new depth scan.
  void set_scene(scene::ScenePointer scene);
  /// Null while the last one given still holds. Throws Error{input} when tiles cannot be read, once for a window.
  [[nodiscard]] std::shared_ptr<const Profile> update(const haptics::State& state);

 private:
  scene::ScenePointer scene_;
  bool with_grain_;
  std::shared_ptr<const scene::GrainField> grain_;
  std::optional<ViewProfile::Window> window_;
  std::optional<bool> textured_;  // the whole object whose profile was given last
};

}  // namespace sparsha::audio
