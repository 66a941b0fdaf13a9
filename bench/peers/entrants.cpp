#include "bench/peers/entrants.h"

#include "bench/peers/ball.h"
#include "bench/peers/box.h"
#include "bench/peers/embree.h"
#include "bench/peers/god_object.h"
#include "bench/peers/implicit.h"
#include "bench/peers/mls.h"
#include "bench/peers/own.h"
#include "bench/peers/sphere.h"
#include "bench/peers/voxel.h"
#include "bench/report/figure_text.h"

namespace sparsha::bench {
namespace {

using haptics::MongeSurface;

}  // namespace

std::vector<Entrant> all_entrants() {
  std::vector<Entrant> all;
  for (const char* method : {"exact", "rounded", "c1"})
    for (const double tolerance : {1e-9, 1e-3})
      all.push_back({method, text_of("tolerance %g cells", tolerance), tolerance == 1e-9,
                     [method, tolerance](const MongeSurface& surface) {
                       haptics::SolverOptions options;
                       options.tolerance_cells = tolerance;
                       return make_own(surface, method, options);
                     }});
  for (const int iterations : {100, 1, 10})
    all.push_back(
        {"paper", text_of("%.0f iterations", iterations), iterations == 100, [iterations](const MongeSurface& surface) {
           haptics::SolverOptions options;
           options.paper_iterations = iterations;
           return make_own(surface, "paper", options);
         }});
  for (const int moves : {100, 1})
    all.push_back({"god-object", text_of("%.0f moves", moves), moves == 100,
                   [moves](const MongeSurface& surface) { return make_god_object(surface, {moves}); }});
  for (const double radius : {1.0, 0.3})
    all.push_back(
        {"god-object", text_of("a ball of %g spacings", radius), false, [radius](const MongeSurface& surface) {
           BallOptions options;
           options.radius_spacings = radius;
           return make_ball(surface, options);
         }});
  for (const double radius : {3.0, 2.0, 5.0, 12.0})
    all.push_back(
        {"sphere", text_of("radius %g spacings", radius), radius == 3.0, [radius](const MongeSurface& surface) {
           SphereOptions options;
           options.radius_spacings = radius;
           return make_sphere(surface, options);
         }});
  for (const double width : {0.5, 0.8, 1.5})
    all.push_back({"mls", text_of("width %g spacings", width), width == 0.5, [width](const MongeSurface& surface) {
                     MlsOptions options;
                     options.width_spacings = width;
                     return make_mls(surface, options);
                   }});
  for (const double radius : {2.5, 2.0, 3.0, 5.0})
    all.push_back(
        {"implicit", text_of("radius %g spacings", radius), radius == 2.5, [radius](const MongeSurface& surface) {
           ImplicitOptions options;
           options.radius_spacings = radius;
           return make_implicit(surface, options);
         }});
  for (const double half : {3.0, 1.5, 6.0})
    all.push_back({"box", text_of("half side %g spacings", half), half == 3.0,
                   [half](const MongeSurface& surface) { return make_box(surface, {half}); }});
  for (const double millions : {1.0, 4.0})
    all.push_back(
        {"voxel", text_of("%g million voxels", millions), millions == 1.0, [millions](const MongeSurface& surface) {
           VoxelOptions options;
           options.most_voxels = static_cast<std::size_t>(1e6 * millions);
           return make_voxel(surface, options);
         }});
  if (has_embree()) all.push_back({"embree", "closest point of the mesh", true, make_embree});
  return all;
}

}  // namespace sparsha::bench
