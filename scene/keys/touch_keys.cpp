// What is felt: `haptics` and `parts`.
#include "scene/keys/forms.h"
#include "scene/material/materials.h"

namespace sparsha::scene::keys {

Form material() {
  std::vector<std::string_view> names;
  for (const MaterialTouch& known : kMaterials) names.emplace_back(known.name);
  return word(names);
}

std::vector<Key> touch_keys() {
  return {
      {"haptics", {block()}, "", "", "Requests to the device, which limits them"},
      {"haptics.stiffness_n_per_m", {number(1.0, 1e5)}, "N/m", "800", "Stiffness of the surface"},
      {"haptics.solver", {word({"exact", "paper"})}, "", "exact", "How the proxy is found"},
      {"haptics.surface", {word({"bilinear", "c1"})}, "", "bilinear", "Surface between the nodes"},
      {"haptics.rate_hz", {number(100.0, 10000.0)}, "Hz", "1000", "Ticks of the servo a second"},
      {"haptics.resolution_mm",
       {number(1e-6, 1000.0)},
       "mm",
       "0.05",
       "Resolution of the device; automatic grids are no finer"},
      {"haptics.creases",
       {word({"sharp", "rounded"})},
       "",
       "rounded",
       "Creases of the bilinear surface: cell by cell, or without jumps of force"},
      {"haptics.beyond",
       {word({"continued", "falls", "rim"})},
       "",
       "falls",
       "Beyond an outline or a wide hole the surface goes on, falls away, or falls after a low ridge"},
      {"haptics.tip_radius_mm",
       {number(0.0, 2.0)},
       "mm",
       "0.5",
       "Radius of the ball that touches, at the hand; 0 is a point"},
      {"haptics.impact", {toggle()}, "", "false", "Strikes ring; invented, not measured"},
      {"haptics.grain",
       {toggle()},
       "",
       "false",
       "The texture goes on above what the scan resolves; invented, not measured"},
      {"haptics.material", {material()}, "", "granite", "Material of impact and grain"},
      {"parts", {list()}, "", "", "Places that have a name; the first one that has a value gives it"},
      {"parts[].name", {name(true)}, "", "", "By what it is known", true},
      {"parts[].say", {text()}, "", "", "Spoken when it is touched; absent: the name"},
      {"parts[].more", {text()}, "", "", "Told when more is asked for"},
      {"parts[].box_m",
       {numbers(4), numbers(6)},
       "m",
       "",
       "xmin, ymin, xmax, ymax, grid frame; of a whole object (around) also xmin, ymin, zmin, xmax, ymax, zmax, scan "
       "frame"},
      {"parts[].polygon_m", {points(3, 1000)}, "m", "", "Corners in their order, grid frame"},
      {"parts[].label", {whole(1, 65535)}, "", "", "Pixels of this value of the image `audio.labels`"},
      {"parts[].material", {material()}, "", "", "Material of impact and grain; absent: the scene's"},
      {"parts[].stiffness_n_per_m", {number(1.0, 1e5)}, "N/m", "", "Stiffness; absent: the scene's"},
      {"parts[].mu_dynamic",
       {number(0.0, 10.0)},
       "",
       "",
       "Friction in place of the scene's; needs the block `friction`"},
      {"parts[].mu_static",
       {number(0.0, 10.0)},
       "",
       "",
       "At least `mu_dynamic`; absent: the larger of `mu_dynamic` and the scene's"},
  };
}

}  // namespace sparsha::scene::keys
