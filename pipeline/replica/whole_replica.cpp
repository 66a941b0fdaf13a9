// The closed mesh of a scene, scaled and set upright.
#include "pipeline/replica/whole_replica.h"

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/files/files.h"
#include "pipeline/replica/print_file.h"
#include "pipeline/replica/replica.h"
#include "pipeline/solid/closed_mesh.h"
#include "pipeline/solid/vertex_colours.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

constexpr double kCoarse_mm = 1.0;  // between nodes in print, from which facets are felt

class StandingMesh : public PrintedMesh {
 public:
  /// `colours`: one a vertex, or none.
  StandingMesh(const ClosedMesh& mesh, std::vector<std::uint32_t> colours, double longest_mm)
      : mesh_(mesh), colours_(std::move(colours)) {
    Eigen::Vector3f low = standing(mesh.vertices_m.front()), high = low;
    for (const Eigen::Vector3f& p : mesh.vertices_m) {
      low = low.cwiseMin(standing(p));
      high = high.cwiseMax(standing(p));
    }
    mm_per_m_ = longest_mm / static_cast<double>((high - low).maxCoeff());
    foot_ = {0.5 * static_cast<double>(low.x() + high.x()), 0.5 * static_cast<double>(low.y() + high.y()),
             static_cast<double>(low.z())};
    size_mm_ = (high - low).cast<double>() * mm_per_m_;
  }

  [[nodiscard]] std::string name() const override { return "whole object"; }
  [[nodiscard]] std::uint32_t vertices() const override { return static_cast<std::uint32_t>(mesh_.vertices_m.size()); }
  [[nodiscard]] std::uint64_t triangles() const override { return mesh_.triangles.size(); }
  [[nodiscard]] PointMm vertex(std::uint32_t number) const override {
    const Eigen::Vector3f p = ((standing(mesh_.vertices_m[number]).cast<double>() - foot_) * mm_per_m_).cast<float>();
    return {p.x(), p.y(), p.z()};
  }
  [[nodiscard]] bool has_colours() const override { return !colours_.empty(); }
  [[nodiscard]] std::uint32_t colour(std::uint32_t number) const override { return colours_[number]; }
  void for_each_triangle(const ForTriangle& triangle, const ForShare& row) const override {
    constexpr std::size_t kRow = 1U << 16U;
    for (std::size_t k = 0; k < mesh_.triangles.size(); ++k) {
      if (k % kRow == 0) row(static_cast<double>(k) / static_cast<double>(mesh_.triangles.size()));
      const auto& t = mesh_.triangles[k];
      triangle(t[0], t[1], t[2]);
    }
  }

  [[nodiscard]] double mm_per_m() const { return mm_per_m_; }
  [[nodiscard]] const Eigen::Vector3d& size_mm() const { return size_mm_; }

 private:
  /// The grid's y goes up, its z to the front, which is -y in print.
  static Eigen::Vector3f standing(const Eigen::Vector3f& grid) { return {grid.x(), -grid.z(), grid.y()}; }

  const ClosedMesh& mesh_;
  std::vector<std::uint32_t> colours_;
  double mm_per_m_ = 1.0;
  Eigen::Vector3d foot_, size_mm_;
};

void warn(WholeReplicaReport& report, const scene::SceneDescription& scene, const ClosedMeshFacts& facts) {
  if (report.unseen > 0.0) {
    report.warnings.push_back(fmt::format(
        "no scan saw {:.2g} % of the surface; holes are closed smoothly there, which may be no foot to stand on",
        100.0 * report.unseen));
  }
  if (report.shells > 1) {
    report.warnings.push_back(
        fmt::format("the object is {} separate surfaces; a filter `clusters` may take away what does not belong to it",
                    report.shells));
  }
  if (facts.crumbs > 0) {
    report.warnings.push_back(
        fmt::format("{} left out: smaller than a ball of 2 spacings radius",
                    facts.crumbs == 1 ? "1 crumb is" : fmt::format("{} crumbs are", facts.crumbs)));
  }
  if (report.spacing_mm > kCoarse_mm) {
    report.warnings.push_back(fmt::format(
        "nodes are {:.2g} mm apart in print, so that facets are felt; print it smaller", report.spacing_mm));
  }
  if (!scene.config.parts.empty()) {
    report.warnings.emplace_back(
        "a whole object has no plate, so that the names of its parts are not in Braille; --front has them");
  }
}

}  // namespace

WholeReplicaReport export_whole_replica(const scene::Scene& scene, const std::filesystem::path& file, double longest_mm,
                                        const Context& context) {
  check_replica_size(longest_mm);
  context.progress.begin("mesh");
  const scene::SceneDescription& description = scene.description();
  const ClosedMesh closed = make_closed_mesh(*description.charts, Holes::close, context);
  std::vector<std::uint32_t> colours;
  if (has_colours(*description.charts)) colours = vertex_colours(*description.charts, closed.vertices_m, context);
  const StandingMesh mesh(closed, std::move(colours), longest_mm);
  context.progress.begin("replica");
  AtomicPath target(file);
  write_print_file(mesh, target.temporary(), file.string(), context.progress);
  target.commit();
  context.progress.finish();

  WholeReplicaReport report;
  report.width_mm = mesh.size_mm().x();
  report.depth_mm = mesh.size_mm().y();
  report.height_mm = mesh.size_mm().z();
  report.scale = 1e-3 * mesh.mm_per_m();
  report.spacing_mm = description.charts->spacing_m * mesh.mm_per_m();
  report.volume_mm3 = closed.facts.volume_m3 * std::pow(mesh.mm_per_m(), 3.0);
  report.triangles = mesh.triangles();
  report.shells = closed.facts.shells;
  report.unseen = closed.facts.unseen();
  warn(report, description, closed.facts);
  return report;
}

}  // namespace sparsha::pipeline
