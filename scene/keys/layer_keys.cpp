// What is made from the heights: `fill`, `texture`, `friction`, `levels`, `check`.
#include "scene/keys/forms.h"

namespace sparsha::scene::keys {

std::vector<Key> layer_keys() {
  return {
      {"fill", {block(), nothing()}, "", "", "Holes are filled; absent: none"},
      {"fill.max_gap_mm",
       {number(0.0, kNoMost)},
       "mm",
       "5",
       "Widest hole that is filled; never outside the outline, not across a step"},
      {"texture",
       {block(), nothing()},
       "",
       "",
       "Fine relief apart from the shape; absent: none, unless `friction` is there"},
      {"texture.sigma_space_mm",
       {length()},
       "mm",
       "2",
       "Of the bilateral filter: standard deviation along the surface"},
      {"texture.sigma_range_mm", {length()}, "mm", "0.5", "Of the bilateral filter: standard deviation of heights"},
      {"texture.method", {word({"direct", "opencv"})}, "", "direct", "Which implementation filters"},
      {"friction", {block(), nothing()}, "", "", "Friction follows the relief; absent: none"},
      {"friction.law", {word({"curvature", "paper", "constant"})}, "", "curvature", "What the coefficient follows"},
      {"friction.mu_static", {number(0.0, 10.0)}, "", "0.4", "Coefficient at rest"},
      {"friction.mu_0", {number(0.0, 10.0)}, "", "0.2", "Coefficient on flat stone, at most `mu_max`"},
      {"friction.mu_max", {number(0.0, 10.0)}, "", "0.9", "Largest coefficient"},
      {"friction.scale_mm",
       {length()},
       "mm",
       "",
       "Scale of the derivatives; absent: the larger of 3 spacings and `texture.sigma_space_mm`"},
      {"friction.c_m",
       {number(0.0, 1e12)},
       "m",
       "",
       "Slope of `law: curvature`; absent: the 95th percentile of curvature reaches `mu_max`"},
      {"levels", {block()}, "", "", "Levels of detail"},
      {"levels.window", {whole(16, 8192)}, "", "200", "Nodes per side of the window that is touched"},
      {"check", {block(), nothing()}, "", "", "The surface is compared with the raw points; absent: not"},
      {"check.samples", {word({"all"}), whole(1, 9e15)}, "", "50000", "How many points"},
  };
}

}  // namespace sparsha::scene::keys
