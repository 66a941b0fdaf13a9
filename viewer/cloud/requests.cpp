// What is asked of the work on the scans, and the side that is chosen from its pictures.
#include <algorithm>

#include "scene/config/orientation.h"
#include "viewer/cloud/controller.h"

namespace sparsha::viewer {

void CloudController::start_scan() {
  if (frame_.status.busy) {
    words_.emplace_back("Work on the scans is still running; Escape stops it");
  } else if (!frame_.status.points) {
    words_.emplace_back("There is nothing to scan yet");
  } else if (!frame_.preview.any) {
    words_.emplace_back("The crop box holds no point");
  } else if (orienting_.scan) {
    orienting_.scan(frame_.setup);
  }
}

// The depth scan as a scene folder, or, also where there is none yet, the orientation as a configuration.
void CloudController::save(bool as_scene) {
  if (frame_.status.busy) {
    words_.emplace_back("Work on the scans is still running; Escape stops it");
  } else if (as_scene && frame_.status.can_save_scene) {
    if (orienting_.save_scene) orienting_.save_scene();
  } else if (!frame_.status.points) {
    words_.emplace_back("There is nothing to save yet");
  } else if (orienting_.save) {
    orienting_.save(frame_.setup);
  }
}

void CloudController::cancel() {
  if (orienting_.cancel) orienting_.cancel();
}

void CloudController::choose_side(std::size_t side) {
  if (!frame_.status.sides || side >= frame_.status.sides->sides.size()) return;
  const SidePictures::Side& chosen = frame_.status.sides->sides[side];
  for (const UpAxis& axis : all_up_axes())
    if (axis.direction().isApprox(chosen.up.normalized(), 1e-3) && chosen.name != "Top" && chosen.name != "Bottom")
      frame_.up = axis;
  turn(scene::look_from(chosen.look_from, chosen.up, scale_of(frame_.setup.scan_to_grid)), false);
  words_.push_back(chosen.name);
}

}  // namespace sparsha::viewer
