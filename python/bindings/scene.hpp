// Scenes: built, opened, looked at as arrays, checked and kept.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>

#include "python/bindings/cloud.hpp"
#include "scene/scene.h"

namespace sparsha::python {

/// A scene with what is known of how it was made.
struct BuiltScene {
  scene::ScenePointer scene;
  std::string report_json;                       ///< empty: in the folder, if anywhere
  std::shared_ptr<const pipeline::Cloud> cloud;  ///< that it was built from, or null
};
using BuiltPointer = std::shared_ptr<const BuiltScene>;

/// The scene of an argument. Raises TypeError.
[[nodiscard]] BuiltPointer scene_of(const pybind11::handle& given);

void bind_scene(pybind11::module_& module);
void bind_build(pybind11::module_& module, pybind11::class_<BuiltScene, std::shared_ptr<BuiltScene>>& scene);
void bind_whole_object(pybind11::class_<BuiltScene, std::shared_ptr<BuiltScene>>& scene);

}  // namespace sparsha::python
