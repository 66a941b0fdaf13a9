// report.json, report.html and the PNG previews of a scene folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pipeline/check/charts_check.h"
#include "pipeline/check/check.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// How two scans fit each other with the poses that the scene was built with.
struct ScanPair {
  struct Fit {
    double within_m = 0.0;    ///< points nearer than that are in common
    double overlap = 0.0;     ///< the larger share of one scan's points in common
    double residual_m = 0.0;  ///< RMS distance of what is in common
  };
  std::string first, second;  ///< files
  Fit fit;                    ///< with the poses that are used
  bool linked = false;        ///< enough in common
  std::optional<Fit> before;  ///< with the poses as given to `sparsha register`
};

/// The whole object, of a configuration with a block `around`.
struct AroundReport {
  std::uint64_t sheets = 0, nodes = 0;
  double spacing_m = 0.0;        ///< of nodes
  double point_spacing_m = 0.0;  ///< median, on the surface
  double noise_m = 0.0;
  std::uint64_t discs = 0;        ///< points with a tangent plane
  std::uint64_t undecided = 0;    ///< of them, those whose outer side nothing tells; left out
  std::uint64_t thin = 0;         ///< of them, those of walls whose two faces mix; left out
  double mixed_share = 0.0;       ///< of the surface, 0 to 1: two faces of thin walls that are taken for one
  std::uint64_t small_nodes = 0;  ///< nodes of sheets of fewer than nine; left out
  std::optional<ChartCheck> check;
};

/// Everything report.json says (docs/formats.md); SI units.
struct Report {
  struct Points {
    std::uint64_t read = 0, used = 0, occluded = 0, outlier = 0, outside = 0, filtered = 0, invalid = 0;
    std::uint64_t scattered =
        0;  ///< of those in the grid: no nearer to others than by chance, so that no surface is theirs
    std::uint64_t edge_on = 0;  ///< of the occluded: on surfaces that the view shows edge-on
  } points;
  /// What decided about the nodes: "triangles", "tangent discs" or "windows"; and the share of an object's places (0 to
  /// 1) whose points are so far apart that discs are wider there than elsewhere, or that windows decide instead.
  struct Surface {
    std::string method;
    double sparse_share = 0.0;
  } surface;
  std::uint64_t triangles = 0;  ///< of meshes among the scans, as they reached the projection
  /// What a filter of the configuration did, in their order.
  struct Filter {
    std::string name;
    std::uint64_t removed = 0;
    bool outliers = false;                  ///< counted in points.outlier, else in points.filtered
    bool merges = false;                    ///< other points stand for those that are gone
    std::string found;                      ///< in words; may be empty
    std::vector<Eigen::Vector3d> sample_m;  ///< of the points it took away, scan frame, for the picture
  };
  std::vector<Filter> filters;
  std::string orientation;              ///< what `face` has found, in words; else empty
  std::vector<Eigen::Vector3d> kept_m;  ///< a sample of the points that filters left
  /// A side of the object as its points look from there, a light from the upper left.
  struct Side {
    std::string name;                ///< front (the scene's view), back, ...
    Eigen::Vector3d look_from, up;   ///< scan frame, as `orientation` takes them
    int width = 0;                   ///< pixels: it is a square
    std::vector<std::uint8_t> grey;  ///< rows from the top down; kNoSurface where nothing is
  };
  static constexpr std::uint8_t kNoSurface = 255;
  std::vector<Side> sides;       ///< six of one size; empty where nearly all is seen from the scene's view
  double side_pixel_m = 0.0;     ///< of a pixel of them, scan frame
  double coverage = 0.0;         ///< measured nodes / all
  double filled_fraction = 0.0;  ///< filled nodes / all
  /// Of a friction map: known nodes, and those of them where no curvature could be told; these take mu_0.
  struct Friction {
    std::uint64_t nodes = 0, undecided = 0;
  };
  std::optional<Friction> friction;
  std::optional<CheckResult> check;
  std::optional<AroundReport> around;
  std::vector<ScanPair> pairs;  ///< of a configuration with a block `register`
  std::vector<StageTime> stages;
  double total_seconds = 0.0;
  std::uint64_t peak_rss_bytes = 0;
  std::vector<std::string> warnings;
};

[[nodiscard]] std::string report_json(const scene::Scene& scene, const Report& report);
/// Writes report.json, report.html and the previews (relief.png, around.png, sides.png, height.png, texture.png,
/// friction.png, coverage.png, error.png, filters.png; those that the scene has) into an existing folder.
void write_report(const scene::Scene& scene, const Report& report, const std::filesystem::path& folder,
                  ThreadPool& pool);

}  // namespace sparsha::pipeline
