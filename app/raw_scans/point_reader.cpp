// Reads one scan after the other with the reader of the pipeline.
#include "app/raw_scans/point_reader.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <Eigen/Geometry>

#include "base/error.h"
#include "base/numbers/hash.h"
#include "pipeline/scan/empty_scan.h"
#include "pipeline/scan/set.h"
#include "pipeline/scan/units.h"

namespace sparsha::app {
namespace {

using pipeline::Cloud;
using pipeline::CloudBlock;
using pipeline::ScanSet;

constexpr std::uint64_t kMeshPoints = 2'000'000;

class Collector {
 public:
  Collector(viewer::PointView& view, std::uint64_t total, std::uint64_t at_most)
      : view_(view), share_(total > at_most ? static_cast<double>(at_most) / static_cast<double>(total) : 1.0) {
    const double room = std::min(1.001 * share_ * static_cast<double>(total) + 1000.0, 4e9);
    view_.points.reserve(static_cast<std::size_t>(room));
  }

  void begin(const Eigen::Vector3d& origin_m, std::uint8_t station) {
    if (view_.points.empty()) view_.origin_m = origin_m;
    shift_m_ = origin_m - view_.origin_m;
    station_ = station;
  }

  void add(const CloudBlock& block) {
    for (std::size_t n = 0; n < block.points.size(); ++n) {
      if (share_ < 1.0 && !chosen()) continue;
      add(block.points[n].cast<double>(), block.rgba.empty() ? nullptr : &block.rgba[n],
          block.intensity.empty() ? nullptr : &block.intensity[n]);
    }
  }

  /// Even points over the triangles: each gets its share of the area, at places of a Kronecker sequence.
  void add_mesh(const Cloud& cloud, std::uint64_t count) {
    const auto corner = [&](std::uint32_t n) {
      const float* p = cloud.xyz1() + 4 * static_cast<std::size_t>(n);
      return Eigen::Vector3d(p[0], p[1], p[2]);
    };
    double area = 0.0;
    const auto area_of = [&](const std::array<std::uint32_t, 3>& f) {
      return 0.5 * (corner(f[1]) - corner(f[0])).cross(corner(f[2]) - corner(f[0])).norm();
    };
    for (const auto& face : cloud.faces) area += area_of(face);
    if (!(area > 0.0)) return;
    double owed = 0.0, u = 0.5, v = 0.5;
    for (const auto& face : cloud.faces) {
      owed += static_cast<double>(count) * area_of(face) / area;
      for (; owed >= 1.0; owed -= 1.0) {
        u = std::fmod(u + 0.7548776662466927, 1.0);
        v = std::fmod(v + 0.5698402909980532, 1.0);
        const bool over = u + v > 1.0;
        const double b = over ? 1.0 - u : u, c = over ? 1.0 - v : v;
        const std::uint32_t near = face[b > 0.5 ? 1 : c > 0.5 ? 2 : 0];
        add((1.0 - b - c) * corner(face[0]) + b * corner(face[1]) + c * corner(face[2]),
            cloud.rgba.empty() ? nullptr : &cloud.rgba[near],
            cloud.intensity.empty() ? nullptr : &cloud.intensity[near]);
      }
    }
  }

  [[nodiscard]] bool thins_out() const { return share_ < 1.0; }

 private:
  bool chosen() {
    const std::uint64_t h = hash_word(number_++);
    return static_cast<double>(h >> 11U) * 0x1p-53 < share_;
  }

  void add(const Eigen::Vector3d& point, const std::uint32_t* rgba, const float* intensity) {
    const std::size_t before = view_.points.size();
    if (before >= std::numeric_limits<std::uint32_t>::max()) return;
    view_.points.emplace_back((point + shift_m_).cast<float>());
    if (rgba != nullptr || !view_.rgba.empty()) {
      const bool coloured = rgba != nullptr && *rgba != pipeline::kNoColour;
      view_.rgba.resize(before, kUncoloured);
      view_.rgba.push_back(coloured ? *rgba | 0xFF000000U : kUncoloured);
    }
    if (intensity != nullptr || !view_.intensity.empty()) {
      view_.intensity.resize(before, 0.0F);
      view_.intensity.push_back(intensity != nullptr ? *intensity : 0.0F);
    }
    view_.station.push_back(station_);
  }

  viewer::PointView& view_;
  double share_;
  Eigen::Vector3d shift_m_ = Eigen::Vector3d::Zero();
  std::uint8_t station_ = 0;
  std::uint64_t number_ = 0;
};

void set_unit(viewer::PointView& view, const std::vector<scene::ScanConfig>& scans) {
  view.unit = scans.front().units.unit;
  const bool common = std::ranges::all_of(scans, [&](const auto& scan) { return scan.units.unit == view.unit; });
  const bool plain = view.unit != scene::LengthUnit::longest_side;
  view.metres_per_unit = common && plain ? scene::metres_in(view.unit) : 0.0;
}

// Formats have room for colours and intensities that a program left at zero: painted so, a cloud would be one black
// patch.
void leave_out_alike(viewer::PointView& view) {
  const auto apart = [](float a, float b) { return std::isnan(a) ? !std::isnan(b) : a != b; };
  if (std::ranges::adjacent_find(view.rgba, std::not_equal_to()) == view.rgba.end()) view.rgba.clear();
  if (std::ranges::adjacent_find(view.intensity, apart) == view.intensity.end()) view.intensity.clear();
}

}  // namespace

ReadPoints read_points(const std::vector<scene::ScanConfig>& scans, const std::string& title, Progress& progress,
                       std::uint64_t at_most, std::uint64_t coarse) {
  ReadPoints result;
  auto view = std::make_shared<viewer::PointView>();
  view->title = title;
  set_unit(*view, scans);
  progress.begin("Reading the scans");
  std::vector<std::unique_ptr<ScanSet>> sets;
  std::uint64_t meshes = 0, unread = 0;
  coarse = std::min(coarse, at_most) / std::max<std::size_t>(scans.size(), 1);
  for (const scene::ScanConfig& scan : scans) {
    try {
      std::unique_ptr<pipeline::OctreeScan> octree = pipeline::OctreeScan::open(scan, progress);
      sets.push_back(std::make_unique<ScanSet>(std::vector{scan}, ScanSet::Keep::disk, false, progress,
                                               std::vector<std::string>{}, pipeline::MeshRefusal{},
                                               pipeline::ScanPart{{}, octree ? coarse : at_most}));
      if (octree && sets.back()->unread() > 0) {
        const int level = octree->level_of_points(coarse);
        const auto station = static_cast<std::uint8_t>(std::min<std::size_t>(sets.size() - 1, 255));
        if (sets.back()->drops_empty_returns()) octree->drop_empty_returns();
        result.coarse.push_back({std::move(octree), level, station});
      }
    } catch (const pipeline::EmptyScan& empty) {
      if (scans.size() == 1) throw;
      progress.warn(pipeline::left_out_warning(empty));
      sets.push_back(nullptr);
      continue;
    }
    view->total += sets.back()->points();
    unread += sets.back()->unread();
    view->z_up = view->z_up || sets.back()->z_up();
    meshes += sets.back()->faces() > 0 ? 1 : 0;
    for (pipeline::Station& station : sets.back()->stations()) result.stations.push_back(std::move(station));
    progress.at(0.3 * static_cast<double>(sets.size()) / static_cast<double>(scans.size()));
  }
  Collector collector(*view, view->total + meshes * kMeshPoints, at_most);
  // What was thinned out here is in no deeper level.
  if (collector.thins_out()) result.coarse.clear();
  view->total += unread;
  for (std::size_t s = 0; s < sets.size(); ++s) {
    if (!sets[s]) continue;
    collector.begin(sets[s]->origin_m(), static_cast<std::uint8_t>(std::min<std::size_t>(s, 255)));
    if (sets[s]->faces() > 0) {
      collector.add_mesh(sets[s]->load(sets[s]->origin_m(), progress),
                         std::min(kMeshPoints, at_most / std::max<std::uint64_t>(meshes, 1)));
    } else {
      sets[s]->stream([&](const CloudBlock& block) { collector.add(block); }, progress);
    }
    progress.at(0.3 + 0.5 * static_cast<double>(s + 1) / static_cast<double>(sets.size()));
    sets[s].reset();
  }
  if (view->points.empty()) {
    throw input_error(scans.front().file.string(), "there are no points in it",
                      "a scan with at least one finite point");
  }
  view->rgba.resize(view->rgba.empty() ? 0 : view->points.size(), kUncoloured);
  view->intensity.resize(view->intensity.empty() ? 0 : view->points.size(), 0.0F);
  leave_out_alike(*view);
  if (scans.size() < 2) view->station.clear();
  viewer::arrange(*view);
  progress.finish();
  result.view = std::move(view);
  return result;
}

}  // namespace sparsha::app
