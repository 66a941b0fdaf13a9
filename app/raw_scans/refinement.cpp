#include "app/raw_scans/refinement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/LU>

#include "base/error.h"

namespace sparsha::app {
namespace {

/// Of the machine's cores, so that pictures are drawn meanwhile.
unsigned some_cores() { return std::max(std::thread::hardware_concurrency() / 2, 1U); }

bool outside(const scene::CropConfig& crop, const DetailNode& node, const Eigen::Vector3d& origin_m) {
  return ((node.low_m + origin_m).array() > crop.max_m.array()).any() ||
         ((node.high_m + origin_m).array() < crop.min_m.array()).any();
}

/// Pixels from the middle of the picture and below what is nearest to the viewer.
double distance_px(const DetailNode& node, const viewer::SplatView& view) {
  const Eigen::Vector3d middle = view.to_pixel(0.5 * (node.low_m + node.high_m));
  return std::hypot(middle.x() - 0.5 * view.width, middle.y() - 0.5 * view.height) - middle.z();
}

}  // namespace

Wanted wanted_nodes(const std::vector<DetailNode>& nodes, const Look& look, const Eigen::Vector3d& origin_m,
                    std::uint64_t most_points) {
  const double pixels_per_m =
      look.view.pixels_per_m * std::cbrt(std::abs(look.view.scan_to_view.determinant()));  // of the scan frame
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const DetailNode& node = nodes[n];
    if (!(node.parents_apart_m * pixels_per_m > 1.0) || !look.view.sees(node.low_m, node.high_m)) continue;
    if (look.crop && outside(*look.crop, node, origin_m)) continue;
    order.emplace_back(distance_px(node, look.view), n);
  }
  std::sort(order.begin(), order.end(), [&](const auto& a, const auto& b) {
    const int level_a = nodes[a.second].levels_below, level_b = nodes[b.second].levels_below;
    return level_a != level_b ? level_a < level_b : a < b;
  });
  Wanted wanted;
  std::uint64_t points = 0;
  for (const auto& [distance, n] : order) {
    if (nodes[n].points > most_points - points) {
      wanted.all = false;
      break;
    }
    points += nodes[n].points;
    wanted.nodes.push_back(n);
  }
  return wanted;
}

Refinement::Refinement(std::vector<CoarseScan> scans, std::shared_ptr<const viewer::PointView> coarse,
                       std::uint64_t most_points, std::function<void(const std::string&)> say)
    : scans_(std::move(scans)), coarse_(std::move(coarse)), most_points_(most_points), say_(std::move(say)) {
  list_nodes();
  for (const CoarseScan& scan : scans_) bytes_read_ += scan.octree->bytes_read();
  worker_ = std::thread([this] { work(); });
}

Refinement::~Refinement() {
  for (const CoarseScan& scan : scans_) scan.octree->cancel();
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  worker_.join();
}

void Refinement::list_nodes() {
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    const pipeline::OctreeScan& octree = *scans_[s].octree;
    for (std::size_t n = 0; n < octree.nodes().size(); ++n) {
      const pipeline::OctreeScan::Node& node = octree.nodes()[n];
      if (node.level <= scans_[s].read_level) continue;
      nodes_.push_back({s, n, node.level - scans_[s].read_level, node.low - coarse_->origin_m,
                        node.high - coarse_->origin_m, octree.spacing_m(node.level - 1), node.points});
    }
  }
  loaded_.resize(nodes_.size());
}

void Refinement::look(const Look& look) {
  {
    const std::lock_guard lock(mutex_);
    asked_ = look;
    busy_ = true;
  }
  wake_.notify_all();
}

std::shared_ptr<const viewer::PointDetail> Refinement::detail() const {
  const std::lock_guard lock(mutex_);
  return detail_;
}

bool Refinement::busy() const {
  const std::lock_guard lock(mutex_);
  return busy_;
}

std::uint64_t Refinement::bytes_read() const {
  const std::lock_guard lock(mutex_);
  return bytes_read_;
}

bool Refinement::outdated() const {
  const std::lock_guard lock(mutex_);
  return stop_ || asked_.has_value();
}

void Refinement::work() {
  ThreadPool pool(some_cores());
  for (;;) {
    Look look;
    {
      std::unique_lock lock(mutex_);
      busy_ = asked_.has_value();
      wake_.wait(lock, [&] { return stop_ || asked_.has_value(); });
      if (stop_) return;
      look = *asked_;
      asked_.reset();
    }
    try {
      refine(look, pool);
    } catch (const Cancelled&) {
      return;
    } catch (const std::exception& error) {
      say_(error.what());
    }
  }
}

void Refinement::refine(const Look& look, ThreadPool& pool) {
  const Wanted wanted = wanted_nodes(nodes_, look, coarse_->origin_m, most_points_);
  ++looks_;
  for (const std::size_t n : wanted.nodes) loaded_[n].wanted_at = looks_;
  while (!outdated()) {
    const std::vector<std::size_t> batch = next_batch(wanted, pool.threads());
    publish(wanted, batch.empty());
    if (batch.empty()) return;
    read(batch, pool);
  }
}

std::vector<std::size_t> Refinement::next_batch(const Wanted& wanted, std::size_t at_most) const {
  std::vector<std::size_t> batch;
  for (const std::size_t n : wanted.nodes) {
    if (loaded_[n].points || loaded_[n].failed) continue;
    if (!batch.empty() && nodes_[n].scan != nodes_[batch.front()].scan) continue;
    batch.push_back(n);
    if (batch.size() == at_most) break;
  }
  std::sort(batch.begin(), batch.end());  // as they are in the file
  return batch;
}

void Refinement::read(const std::vector<std::size_t>& batch, ThreadPool& pool) {
  CoarseScan& scan = scans_[nodes_[batch.front()].scan];
  std::vector<std::size_t> in_scan;
  std::uint64_t points = 0;
  for (const std::size_t n : batch) {
    in_scan.push_back(nodes_[n].node);
    points += nodes_[n].points;
  }
  make_room(points);
  const std::uint64_t before = scan.octree->bytes_read();
  std::vector<pipeline::OctreeScan::Points> read;
  try {
    read = scan.octree->read(in_scan, coarse_->origin_m, pool);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    if (batch.size() > 1) {  // which of them it is
      for (const std::size_t n : batch) this->read({n}, pool);
      return;
    }
    loaded_[batch.front()].failed = true;
    say_(error.what());
    return;
  }
  const auto arranged = [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      auto part = std::make_shared<viewer::PointView>();
      part->origin_m = coarse_->origin_m;
      part->points = std::move(read[k].places);
      if (!coarse_->rgba.empty()) part->rgba = std::move(read[k].rgba);
      if (!coarse_->intensity.empty()) part->intensity = std::move(read[k].intensity);
      if (!coarse_->station.empty()) part->station.assign(part->points.size(), scan.station);
      for (std::uint32_t& colour : part->rgba) colour |= 0xFF000000U;
      viewer::arrange(*part);
      loaded_[batch[k]].points = std::move(part);
    }
  };
  pool.for_ranges(batch.size(), 1, arranged);
  held_ += points;
  const std::lock_guard lock(mutex_);
  bytes_read_ += scan.octree->bytes_read() - before;
}

void Refinement::make_room(std::uint64_t points) {
  if (held_ + points <= most_points_) return;
  std::vector<std::size_t> old;
  for (std::size_t n = 0; n < loaded_.size(); ++n)
    if (loaded_[n].points && loaded_[n].wanted_at < looks_) old.push_back(n);
  std::sort(old.begin(), old.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(loaded_[a].wanted_at, a) < std::pair(loaded_[b].wanted_at, b);
  });
  for (const std::size_t n : old) {
    if (held_ + points <= most_points_) return;
    loaded_[n].points.reset();
    held_ -= nodes_[n].points;
  }
}

void Refinement::publish(const Wanted& wanted, bool last) {
  auto detail = std::make_shared<viewer::PointDetail>();
  for (const Loaded& loaded : loaded_) {
    if (!loaded.points) continue;
    detail->parts.push_back(loaded.points);
    detail->points += loaded.points->points.size();
  }
  // Down to the last level that is here wherever the picture wants it.
  int whole = wanted.nodes.empty() ? 0 : nodes_[wanted.nodes.back()].levels_below - (wanted.all ? 0 : 1);
  for (const std::size_t n : wanted.nodes) {
    if (loaded_[n].points || loaded_[n].failed) continue;
    whole = std::min(whole, nodes_[n].levels_below - 1);
    break;
  }
  if (whole > 0) detail->spacing_m = std::ldexp(coarse_->spacing_m, -whole);
  detail->whole = last && wanted.all;
  const std::lock_guard lock(mutex_);
  detail_ = std::move(detail);
  if (last && !asked_) busy_ = false;
}

}  // namespace sparsha::app
