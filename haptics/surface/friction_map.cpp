#include "haptics/surface/friction_map.h"

#include <cstddef>

#include "haptics/surface/large_pages.h"
#include "pipeline/scene/friction_law.h"
#include "pipeline/scene/workspace.h"

namespace sparsha::haptics {

FrictionMap evaluate_friction(const pipeline::SceneDescription& scene, const pipeline::Layers& window, double scale) {
  FrictionMap map;
  if (!scene.config.friction) return map;
  const pipeline::Lattice& lattice = window.grid.lattice;
  const double width_m = pipeline::window_width_m(lattice.nx, lattice.ny, lattice.spacing_m);
  const pipeline::FrictionLaw law(scene, scale, scale * width_m);
  for (std::vector<float>* values : {&map.mu_dynamic, &map.mu_static}) {
    *values = room_for(lattice.count());
    values->resize(lattice.count());
  }
  for (std::size_t node = 0; node < lattice.count(); ++node) {
    if (window.grid.state[node] == pipeline::NodeState::unknown) continue;
    map.mu_dynamic[node] = law.dynamic(window, node);
    map.mu_static[node] = law.at_rest(map.mu_dynamic[node]);
  }
  return map;
}

}  // namespace sparsha::haptics
