#include "app/edited_parts.h"

#include <utility>

#include "scene/folder/folder.h"

namespace sparsha::app {

pipeline::ScenePointer with_parts(const pipeline::ScenePointer& scene, const std::vector<pipeline::PartConfig>& parts) {
  pipeline::SceneDescription description = scene->description();
  description.config.parts = parts;
  pipeline::ScenePointer edited = pipeline::with_description(scene, std::move(description));
  if (!edited->folder().empty()) pipeline::write_description(*edited, edited->folder());
  return edited;
}

const Eigen::Matrix4d& parts_frame(const pipeline::SceneDescription& scene) {
  const pipeline::OrientationConfig& orientation = scene.config.orientation;
  return orientation.regions_scan_to_grid ? *orientation.regions_scan_to_grid : orientation.scan_to_grid;
}

}  // namespace sparsha::app
