// The block `filters`.
#include "scene/keys/forms.h"

namespace sparsha::scene::keys {
namespace {

constexpr std::string_view kMethod = "`pcl` is the reference, single-threaded";
Form method() { return word({"fast", "pcl"}); }

}  // namespace

std::vector<Key> filter_keys() {
  return {
      {"filters",
       {list()},
       "",
       "",
       "What is done to the points before they are projected, in this order, one filter an entry"},
      {"filters[].crop", {block()}, "", "", "Keeps what lies in a box, borders included"},
      {"filters[].crop.min_m", {numbers(3)}, "m", "", "Smallest x, y, z, scan frame after poses", true},
      {"filters[].crop.max_m", {numbers(3)}, "m", "", "Largest x, y, z", true},
      {"filters[].voxel", {block()}, "", "", "One point a voxel, the mean of its points"},
      {"filters[].voxel.leaf_mm", {length()}, "mm", "0.5", "Side of a voxel"},
      {"filters[].outliers",
       {block(), nothing()},
       "",
       "",
       "Keeps points whose mean distance to their neighbours is at most the mean of all + sigma standard deviations"},
      {"filters[].outliers.neighbours", {whole(1, 1000)}, "", "8", "How many neighbours count"},
      {"filters[].outliers.sigma", {number(1e-6, 1e6)}, "", "2", "Standard deviations"},
      {"filters[].outliers.method", {method()}, "", "fast", kMethod},
      {"filters[].radius_outliers", {block(), nothing()}, "", "", "Keeps points with enough others within the radius"},
      {"filters[].radius_outliers.radius_mm", {length()}, "mm", "5", "Radius"},
      {"filters[].radius_outliers.neighbours", {whole(1, 1000)}, "", "4", "How many others must be there"},
      {"filters[].radius_outliers.method", {method()}, "", "fast", kMethod},
      {"filters[].pass",
       {block()},
       "",
       "",
       "Keeps what lies between limits along an axis, one of which may be left out"},
      {"filters[].pass.axis", {word({"x", "y", "z"})}, "", "", "Axis of the scan frame", true},
      {"filters[].pass.min_m", {number(-kNoMost, kNoMost)}, "m", "", "Smallest coordinate that stays"},
      {"filters[].pass.max_m", {number(-kNoMost, kNoMost)}, "m", "", "Largest coordinate that stays"},
      {"filters[].remove_plane", {block(), nothing()}, "", "", "Takes the largest plane away, and what lies beyond it"},
      {"filters[].remove_plane.distance_mm",
       {length()},
       "mm",
       "5",
       "How far from it, on either side, a point belongs to the plane"},
      {"filters[].remove_plane.side",
       {word({"below", "above", "both"})},
       "",
       "below",
       "What goes besides the plane; `both` takes the plane alone"},
      {"filters[].remove_plane.normal", {numbers(3)}, "", "[0, 0, 1]", "From below to above, scan frame"},
      {"filters[].remove_plane.max_angle_deg",
       {number(0.01, 90.0)},
       "deg",
       "15",
       "How far the plane's normal may lie from `normal`"},
      {"filters[].keep",
       {block(), nothing()},
       "",
       "",
       "Keeps one group of points, each closer than the tolerance to another of it"},
      {"filters[].keep.cluster", {word({"largest"}), block()}, "", "largest", "Which group stays"},
      {"filters[].keep.cluster.nearest_to", {numbers(3)}, "m", "", "The group nearest to this place, scan frame", true},
      {"filters[].keep.nearest_to", {numbers(3)}, "m", "", "The same, without `cluster`"},
      {"filters[].keep.tolerance_mm", {length()}, "mm", "10", "Largest gap within the group"},
      {"filters[].keep.method", {method()}, "", "fast", kMethod},
      {"filters[].smooth", {block(), nothing()}, "", "", "Moves points onto a polynomial through their neighbours"},
      {"filters[].smooth.radius_mm", {length()}, "mm", "3", "How far neighbours lie"},
      {"filters[].smooth.order", {whole(1, 4)}, "", "2", "Order of the polynomial; 1 is a plane"},
      {"filters[].smooth.method", {method()}, "", "fast", kMethod},
      {"filters[].thin", {block(), nothing()}, "", "", "Leaves about so many points for each node of the grid"},
      {"filters[].thin.points_per_node", {whole(1, 1000000)}, "", "4", "Points a node"},
      {"filters[].field", {block()}, "", "", "Keeps points by a value that the scan says of them; one limit or both"},
      {"filters[].field.name", {name()}, "", "", "The field, as `sparsha info` lists it, such as confidence", true},
      {"filters[].field.min", {number(-kNoMost, kNoMost)}, "", "", "Smallest value that stays"},
      {"filters[].field.max", {number(-kNoMost, kNoMost)}, "", "", "Largest value that stays"},
      {"filters[].classes", {block()}, "", "", "Keeps points by their LAS class"},
      {"filters[].classes.keep", {wholes(0, 255)}, "", "", "Classes that stay"},
      {"filters[].classes.drop", {wholes(0, 255)}, "", "", "Classes that go"},
  };
}

}  // namespace sparsha::scene::keys
