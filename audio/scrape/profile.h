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

/// One window of one scene. Immutable; made off the sound card's thread, read by it.
class Profile {
 public:
  /// Which nodes of which level: the finest one of which the window has at most kMostNodes per side.
  using Window = scene::TouchedView;  ///< of a point: the tip's place lies on the stone
  static constexpr int kMostNodes = 1024;
  /// The window that the servo renders.
  [[nodiscard]] static Window window_of(const scene::SceneDescription& scene, const haptics::State& state);

  /// `grain` may be null. Throws Error{input} when tiles cannot be read.
  Profile(const scene::Scene& scene, const Window& window, std::shared_ptr<const scene::GrainField> grain);

  /// Cubic between the nodes (Catmull-Rom: through them, without creases), level beyond the window. Metres of the grid
  /// frame, relative to origin_m().
  [[nodiscard]] double height_m(double x_m, double y_m) const noexcept;
  /// Height of the grain at such a place, of waves that are `shortest_m` long or longer and that samples which are
  /// `per_sample_m` apart can tell.
  [[nodiscard]] double grain_m(const Eigen::Vector3d& place_m, double per_sample_m, double shortest_m) const noexcept;
  /// The window's node (0, 0) and zero of its heights.
  [[nodiscard]] const Eigen::Vector3d& origin_m() const noexcept { return origin_m_; }

 private:
  scene::Lattice lattice_;  ///< of the window with its margin
  int margin_ = 0;          ///< nodes on every side
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
  std::vector<float> height_m_;
  std::shared_ptr<const scene::GrainField> grain_;
  std::optional<scene::RegionFrame> region_from_grid_;
  double enlarged_ = 1.0;  ///< metres of the grid frame in the regions' frame
};

/// Makes the profile of the window under the hand whenever that changes. One thread, not the sound card's.
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
  std::optional<Profile::Window> window_;
};

}  // namespace sparsha::audio
