// report.json: the keys are a contract (docs/formats.md).
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/report/report.h"
#include "scene/folder/layer_file.h"
#include "scene/scene.h"

#ifndef SPARSHA_VERSION
#define SPARSHA_VERSION "unknown"
#endif

namespace sparsha::pipeline {
namespace {

using Json = nlohmann::ordered_json;

/// JSON knows no NaN: what is not known is null.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json statistics(const DistanceStatistics& s) {
  if (s.samples == 0) return nullptr;
  return {{"samples", s.samples},
          {"mean_m", number(s.mean_m)},
          {"rms_m", number(s.rms_m)},
          {"median_m", number(s.median_m)},
          {"mad_m", number(s.mad_m)},
          {"p95_m", number(s.p95_m)},
          {"p99_m", number(s.p99_m)},
          {"max_m", number(s.max_m)},
          {"signed_mean_m", number(s.signed_mean_m)},
          {"mean_ci95_m", number(s.mean_ci95_m)}};
}

Json histogram(const std::vector<std::uint64_t>& counts, double bin_m) {
  if (counts.empty() || !(bin_m > 0)) return nullptr;
  return {{"bin_m", bin_m}, {"counts", counts}};
}

Json check(const std::optional<CheckResult>& result) {
  if (!result) return {{"cloud_to_surface", nullptr}, {"surface_to_cloud", nullptr}, {"completeness", nullptr}};
  const CheckResult& r = *result;
  Json second = nullptr;
  if (r.second_method_samples > 0)
    second = {{"samples", r.second_method_samples}, {"max_difference_m", number(r.second_method_max_difference_m)}};
  constexpr std::array kAgainst = {"points", "mesh", "mesh and points"};
  return {{"against", kAgainst.at(static_cast<std::size_t>(r.against))},
          {"cloud_to_surface", statistics(r.cloud_to_surface)},
          {"surface_to_cloud", statistics(r.surface_to_cloud)},
          {"completeness", r.completeness ? number(*r.completeness) : Json(nullptr)},
          {"tolerance_m", number(r.tolerance_m)},
          {"cloud_histogram", histogram(r.cloud_histogram, r.histogram_bin_m)},
          {"surface_histogram", histogram(r.surface_histogram, r.surface_histogram_bin_m)},
          {"second_method", second}};
}

Json sides(const SidesCheck& r) {
  Json places = Json::array();
  for (const SidesCheck::Place& place : r.places) {
    Json box = Json::array();
    for (const Eigen::Vector3d* end : {&place.min_m, &place.max_m})
      for (const double coordinate : *end) box.push_back(number(coordinate));
    places.push_back({{"nodes", place.nodes}, {"box_m", std::move(box)}});
  }
  return {{"told", r.told}, {"inwards", r.inwards}, {"untold", r.untold}, {"places", std::move(places)}};
}

Json around(const AroundReport& r) {
  Json json = {
      {"sheets", r.sheets},
      {"nodes", r.nodes},
      {"spacing_m", number(r.spacing_m)},
      {"point_spacing_m", number(r.point_spacing_m)},
      {"noise_m", number(r.noise_m)},
      {"discs",
       {{"found", r.discs}, {"undecided", r.undecided}, {"thin", r.thin}, {"mixed_share", number(r.mixed_share)}}},
      {"small_sheet_nodes", r.small_nodes},
      {"check", nullptr}};
  if (r.check) {
    json["check"] = {{"points", r.check->points},
                     {"sampled", r.check->sampled},
                     {"far", r.check->far},
                     {"cloud_to_surface", statistics(r.check->cloud_to_surface)},
                     {"agreement", statistics(r.check->agreement)},
                     {"nodes", r.check->nodes},
                     {"nodes_alone", r.check->nodes_alone},
                     {"sides", sides(r.check->sides)}};
  }
  return json;
}

}  // namespace

std::string report_json(const scene::Scene& scene, const Report& report) {
  const scene::SceneDescription& description = scene.description();
  const scene::Lattice lattice = description.levels.empty() ? scene::Lattice{} : description.levels.front();
  const Report::Points& p = report.points;

  Json json;
  json["version"] = SPARSHA_VERSION;
  json["points"] = {{"read", p.read},       {"used", p.used},         {"occluded", p.occluded}, {"outlier", p.outlier},
                    {"outside", p.outside}, {"filtered", p.filtered}, {"invalid", p.invalid}};
  // Of those read; the others are what the cross-check judges, and what is no part of the object.
  json["not_visible"] = {{"share", p.read > 0 ? static_cast<double>(p.occluded) / static_cast<double>(p.read) : 0.0},
                         {"behind", p.occluded - p.edge_on},
                         {"edge_on", p.edge_on}};
  json["scattered"] = p.scattered;
  if (!report.surface.method.empty())
    json["surface"] = {{"method", report.surface.method}, {"sparse_share", report.surface.sparse_share}};
  json["triangles"] = report.triangles;
  json["filters"] = Json::array();
  for (const Report::Filter& filter : report.filters) {
    json["filters"].push_back({{"name", filter.name},
                               {"removed", filter.removed},
                               {"counted_as", filter.outliers ? "outlier" : "filtered"},
                               {"found", filter.found.empty() ? Json(nullptr) : Json(filter.found)}});
  }
  json["orientation"] = report.orientation.empty() ? Json(nullptr) : Json(report.orientation);
  json["grid"] = {
      {"nx", lattice.nx},
      {"ny", lattice.ny},
      {"spacing_m", number(lattice.spacing_m)},
      {"levels", description.levels.size()},
      {"origin_m", {number(lattice.origin_m.x()), number(lattice.origin_m.y()), number(lattice.origin_m.z())}},
      {"axes", scene::keeps_scan_axes(description) ? "scan" : "local"}};
  json["size_m"] = {number((lattice.nx - 1) * lattice.spacing_m), number((lattice.ny - 1) * lattice.spacing_m),
                    number(description.height_max_m - description.height_min_m)};
  json["coverage"] = number(report.coverage);
  json["filled_fraction"] = number(report.filled_fraction);
  json["noise_m"] = number(description.noise_m);
  json["invented"] = Json::array();
  if (description.config.haptics.impact) json["invented"].push_back("impact");
  if (description.config.haptics.grain) json["invented"].push_back("grain");
  json["friction"] = nullptr;
  if (report.friction)
    json["friction"] = {{"nodes", report.friction->nodes}, {"undecided", report.friction->undecided}};
  json["check"] = check(report.check);
  if (report.around) json["around"] = around(*report.around);
  json["inputs"] = Json::array();
  for (const scene::ScanSource& source : description.sources)
    json["inputs"].push_back(
        {{"file", source.file.generic_string()}, {"sha256", source.sha256}, {"points", source.points}});
  if (!report.pairs.empty()) {
    json["pairs"] = Json::array();
    for (const ScanPair& pair : report.pairs)
      json["pairs"].push_back({{"first", pair.first},
                               {"second", pair.second},
                               {"within_m", number(pair.fit.within_m)},
                               {"overlap", number(pair.fit.overlap)},
                               {"residual_m", number(pair.fit.residual_m)},
                               {"linked", pair.linked}});
  }
  json["warnings"] = report.warnings;
  json["stages"] = Json::array();
  for (const StageTime& stage : report.stages)
    json["stages"].push_back({{"name", stage.name}, {"seconds", number(stage.seconds)}});
  json["total_seconds"] = number(report.total_seconds);
  json["peak_rss_bytes"] = report.peak_rss_bytes;
  // File names and warnings may hold bytes that are not UTF-8; they are replaced, not fatal.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sparsha::pipeline
