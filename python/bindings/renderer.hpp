// The force on a hand: tick by tick, or along a whole path.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>

#include <Eigen/Core>

#include "haptics/around/around_proxy.h"
#include "haptics/proxy/proxy.h"
#include "haptics/replay/traced_surface.h"
#include "haptics/window/surface.h"
#include "python/bindings/scene.hpp"
#include "scene/config/haptics.h"

namespace sparsha::python {

/// One hand on one scene: the surface, and where its proxy is. Ticks as haptics::trace() and trace_around() render
/// them.
struct Renderer {
  BuiltPointer scene;
  std::shared_ptr<const haptics::MongeSurface> surface;  ///< of one view, or null
  std::shared_ptr<const haptics::ObjectSurface> object;  ///< of a whole object, or null
  /// Of an unrolled object in the frame of its scans: a path decides which surface it is traced on, so that there is
  /// none.
  std::optional<haptics::SurfaceOptions> unrolled;
  scene::HapticsConfig haptics;
  haptics::SolverOptions options;
  haptics::HipFrame frame = haptics::HipFrame::grid;
  Eigen::Matrix4d grid_from_scan = Eigen::Matrix4d::Identity();
  Eigen::Matrix3d force_from_grid = Eigen::Matrix3d::Identity();
  haptics::ProxyState proxy;
  haptics::AroundState around;
  bool started = false;
  bool contact = false;  ///< in the last tick

  struct Tick {
    Eigen::Vector3d proxy_m;
    Eigen::Vector3d force_n;
  };
  /// Not of an unrolled object in the frame of its scans.
  [[nodiscard]] Tick step(const Eigen::Vector3d& hip_m) noexcept;
  void reset() noexcept;

 private:
  [[nodiscard]] Tick step_on_view(const Eigen::Vector3d& hip_m) noexcept;
  [[nodiscard]] Tick step_around(const Eigen::Vector3d& hip_m) noexcept;
};

/// `step` as a method of the class, by Python's own calling convention: a call through pybind11 costs more than a tick.
void add_step(const pybind11::class_<Renderer>& renderer);

void bind_renderer(pybind11::module_& module);

}  // namespace sparsha::python
