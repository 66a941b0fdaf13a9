#include "pipeline/scan/formats/las/octree_scan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "pipeline/scan/empty_returns.h"
#include "pipeline/scan/formats/las/las.h"
#include "pipeline/scan/formats/las/laz.h"

namespace sparsha::pipeline {
namespace {

/// A box around the turned box.
std::pair<Eigen::Vector3d, Eigen::Vector3d> placed(const Placement& placement, const Eigen::Vector3d& low,
                                                   const Eigen::Vector3d& high) {
  const Eigen::Vector3d middle = placement(0.5 * (low + high));
  const Eigen::Vector3d half = placement.trivial
                                   ? Eigen::Vector3d(0.5 * (high - low))
                                   : Eigen::Vector3d(placement.turn_and_scale.cwiseAbs() * (0.5 * (high - low)));
  return {middle - half, middle + half};
}

Error damaged(const ScanFile& file, const laz::Damage& damage) {
  return file.error(fmt::format("{}, at byte {}", damage.what, damage.byte), "an undamaged LAZ file");
}

}  // namespace

std::unique_ptr<OctreeScan> OctreeScan::open(const scene::ScanConfig& scan, const Progress& progress) {
  auto opened = std::unique_ptr<OctreeScan>(new OctreeScan(scan));
  opened->file_.progress = &progress;
  if (!is_las(opened->file_)) return nullptr;
  opened->header_ = las::parse_header(opened->file_);
  opened->units_ = las::find_units(opened->header_);
  if (!opened->header_.compressed || opened->units_.degrees) return nullptr;
  opened->metres_ = metres_in_unit(scan, opened->units_.unit);
  if (opened->metres_ == 0.0) return nullptr;
  try {
    opened->packing_ = las::find_packing(opened->file_, opened->header_);
    std::optional<las::Octree> octree = las::read_octree(opened->file_, opened->header_, opened->packing_);
    if (!octree || octree->nodes.empty()) return nullptr;
    opened->octree_ = std::move(*octree);
    opened->place_nodes(scan);
    opened->look_at_colours();
  } catch (const laz::Damage&) {
    return nullptr;  // who reads all of the file says what is wrong
  }
  opened->map_.require_whole();
  opened->file_.progress = &opened->stopped_;
  return opened;
}

OctreeScan::OctreeScan(const scene::ScanConfig& scan) : map_(scan.file) {
  file_.name = scan.file.string();
  file_.bytes = map_.text();
  file_.map = &map_;
}

OctreeScan::~OctreeScan() = default;

void OctreeScan::place_nodes(const scene::ScanConfig& scan) {
  placement_ = place(scan, metres_);
  nodes_.reserve(octree_.nodes.size());
  for (const las::Octree::Node& node : octree_.nodes) {
    const las::Octree::Box box = octree_.box_of(node, units_.z_factor);
    const auto [low, high] = placed(placement_, box.low, box.high);
    nodes_.push_back({node.level, low, high, node.chunk.points, node.chunk.size});
  }
}

void OctreeScan::look_at_colours() {
  if (header_.colour_offset() == 0) return;
  RawScan raw;
  const PointSink nowhere;
  ScanWriter out(raw, nowhere);
  las::PointReader reader(header_, units_, out);
  bytes_read_ += las::look_at_colours(file_, {file_.bytes, header_.first_point, header_.points, packing_},
                                      octree_.chunks(), reader);
  colours_ = reader.colours();
}

double OctreeScan::spacing_m(int level) const {
  // Files lie about it at will; a node has at least a few points and at most millions.
  const double spacing = std::clamp(octree_.spacing, octree_.side / 4096.0, octree_.side);
  return std::ldexp(spacing, -level) * metres_;
}

void OctreeScan::add_records(std::string_view records, const Eigen::Vector3d& origin_m, Points& points) const {
  constexpr float kFar = 1e30F;
  RawScan raw;
  const PointSink sink = [&](const PointBlock& block) {
    for (std::size_t i = 0; i < block.points.size(); ++i) {
      if (drop_empty_returns_ && is_at_scanner(block.points[i], block.station)) continue;
      const Eigen::Vector3f q = (placement_(block.points[i]) - origin_m).cast<float>();
      if (!(q.cwiseAbs().maxCoeff() < kFar)) continue;
      points.places.push_back(q);
      if (!block.rgba.empty()) points.rgba.push_back(block.rgba[i]);
      if (!block.intensity.empty()) points.intensity.push_back(block.intensity[i]);
    }
  };
  ScanWriter out(raw, sink);
  las::PointReader reader(header_, units_, out);
  reader.set_colours(colours_);
  out.begin(0, header_.colour_offset() != 0, true);
  for (std::size_t at = 0; at < records.size(); at += header_.record_size) reader.add(records.data() + at);
  out.finish();
}

std::vector<OctreeScan::Points> OctreeScan::read(std::span<const std::size_t> nodes, const Eigen::Vector3d& origin_m,
                                                 ThreadPool& pool) {
  std::vector<laz::Chunk> chunks;
  for (const std::size_t n : nodes) {
    chunks.push_back(octree_.nodes[n].chunk);
    bytes_read_ += chunks.back().size;
  }
  RawScan raw;
  const PointSink nowhere;
  ScanWriter out(raw, nowhere);
  const laz::Layers layers = las::wanted_layers(packing_, las::PointReader(header_, units_, out));
  std::vector<Points> points(nodes.size());
  std::size_t k = 0;
  try {
    laz::read_chunks({file_.bytes, header_.first_point, header_.points, packing_}, chunks, layers, pool,
                     [&](std::string_view records, std::size_t place) {
                       while (k + 1 < chunks.size() && chunks[k].begin < place) ++k;
                       add_records(records, origin_m, points[k]);
                       file_.throw_if_cancelled();
                     });
  } catch (const laz::Damage& damage) {
    map_.require_whole();
    throw damaged(file_, damage);
  }
  map_.require_whole();
  return points;
}

}  // namespace sparsha::pipeline
