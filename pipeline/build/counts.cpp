// What the report says of the points of a projected scan.
#include <utility>

#include "pipeline/build/project_scans.h"

namespace sparsha::pipeline {

Report take_counts(ProjectedScans& scans) {
  Report report;
  report.points = scans.points;
  report.triangles = scans.triangles;
  report.filters = std::move(scans.filters);
  report.kept_m = std::move(scans.kept_m);
  report.orientation = std::move(scans.orientation);
  report.points.used = scans.projection.used;
  report.points.occluded = scans.projection.occluded;
  report.points.scattered = scans.projection.scattered;
  report.surface.method = scans.projection.only_mesh ? "triangles"
                          : scans.projection.discs   ? "tangent discs"
                                                     : "windows";
  report.surface.sparse_share = scans.projection.sparse_share;
  report.points.edge_on = scans.projection.edge_on;
  report.points.outlier += scans.projection.outlier;
  report.points.outside = scans.projection.outside;
  return report;
}

}  // namespace sparsha::pipeline
