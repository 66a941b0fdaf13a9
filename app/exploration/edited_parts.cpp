#include "app/exploration/edited_parts.h"

#include <utility>

#include "scene/folder/folder.h"
#include "scene/scene.h"

namespace sparsha::app {

scene::ScenePointer with_parts(const scene::ScenePointer& scene, const std::vector<scene::PartConfig>& parts) {
  scene::SceneDescription description = scene->description();
  description.config.parts = parts;
  scene::ScenePointer edited = scene::with_description(scene, std::move(description));
  if (!edited->folder().empty()) scene::write_description(*edited, edited->folder());
  return edited;
}

const Eigen::Matrix4d& parts_frame(const scene::SceneDescription& scene) {
  const scene::OrientationConfig& orientation = scene.config.orientation;
  return orientation.regions_scan_to_grid ? *orientation.regions_scan_to_grid : orientation.scan_to_grid;
}

}  // namespace sparsha::app
