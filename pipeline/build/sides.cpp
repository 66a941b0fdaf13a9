// Pictures of the sample of points that is kept for the report.
#include "pipeline/build/sides.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include "pipeline/orient/side_picture.h"
#include "pipeline/orient/thumbnails.h"
#include "pipeline/scan/sampled_faces.h"

namespace sparsha::pipeline {

Cloud places_on_faces(const Cloud& mesh) {
  constexpr double kPlaces = 65'000.0;
  constexpr std::uint64_t kSeed = 5;
  const double area_m2 = area_of_faces(mesh);
  return area_m2 > 0.0 ? sample_faces(mesh, std::sqrt(area_m2 / kPlaces), kSeed) : mesh;
}

void add_sides(const Eigen::Matrix4d& scan_to_grid, Report& report) {
  static_assert(Report::kNoSurface == Thumbnail::kNothing);
  const EvenPoints object = even_points(report.kept_m);
  if (object.points.empty()) return;
  const Eigen::Vector3d ahead = scan_to_grid.block<1, 3>(2, 0).transpose().normalized();
  const Eigen::Vector3d up = scan_to_grid.block<1, 3>(1, 0).transpose().normalized();
  if (seen_share(object, picture_from(object, ahead, up), ahead, up) >= kOneSided) return;
  report.side_pixel_m = object.pixel_m;
  for (Thumbnail& side : six_thumbnails(object, rounded_direction(ahead), rounded_direction(up)))
    report.sides.push_back({std::move(side.name), side.look_from, side.up, side.side, std::move(side.grey)});
}

}  // namespace sparsha::pipeline
