#include "app/raw_scans/refinement.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include <Eigen/LU>

namespace sparsha::app {
namespace {

/// Of the machine's cores, so that pictures are drawn meanwhile.
unsigned some_cores() { return std::max(std::thread::hardware_concurrency() / 2, 1U); }

/// What is read is shown so often.
constexpr std::chrono::milliseconds kPublished{50};

std::uint64_t counted(const DetailNode& node) { return std::max(node.points, kLeastCounted); }

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
    if (counted(nodes[n]) > most_points - points) {
      wanted.all = false;
      break;
    }
    points += counted(nodes[n]);
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
  failures_.resize(scans_.size());
}

void Refinement::look(const Look& look) {
  {
    const std::lock_guard lock(mutex_);
    last_ = look;
    if (resting_) return;
    asked_ = look;
    busy_ = true;
  }
  wake_.notify_all();
}

void Refinement::rest() {
  std::unique_lock lock(mutex_);
  resting_ = true;
  asked_.reset();
  idle_.wait(lock, [&] { return !working_; });
  busy_ = false;
  detail_.reset();
  for (const std::size_t n : here_) loaded_[n].points.reset();  // the worker waits for the lock
  here_.clear();
  held_ = 0;
}

void Refinement::resume() {
  {
    const std::lock_guard lock(mutex_);
    resting_ = false;
    asked_ = last_;
    busy_ = asked_.has_value();
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

std::uint64_t Refinement::failures() const {
  const std::lock_guard lock(mutex_);
  return failed_;
}

bool Refinement::outdated() const {
  const std::lock_guard lock(mutex_);
  return stop_ || resting_ || asked_.has_value();
}

void Refinement::work() {
  ThreadPool pool(some_cores());
  for (;;) {
    Look look;
    {
      std::unique_lock lock(mutex_);
      busy_ = asked_.has_value();
      working_ = false;
      idle_.notify_all();
      wake_.wait(lock, [&] { return stop_ || asked_.has_value(); });
      if (stop_) return;
      working_ = true;
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
  const std::vector<Batch> batches = batches_of(wanted, pool.threads());
  std::uint64_t points = 0;
  for (const Batch& batch : batches)
    for (const std::size_t n : batch) points += counted(nodes_[n]);
  make_room(points);
  publish(wanted, batches.empty());  // what makes room leaves the picture before more is read
  auto published = std::chrono::steady_clock::now();
  for (std::size_t k = 0; k < batches.size(); ++k) {
    if (outdated()) return;
    read(batches[k], pool);
    const bool last = k + 1 == batches.size();
    if (last) say_failures();
    if (!last && std::chrono::steady_clock::now() - published < kPublished) continue;
    publish(wanted, last);
    published = std::chrono::steady_clock::now();
  }
}

std::vector<Refinement::Batch> Refinement::batches_of(const Wanted& wanted, std::size_t at_most) const {
  std::vector<Batch> batches;
  std::vector<std::size_t> open(scans_.size());  // 1 + the batch that a scan's next node comes to
  for (const std::size_t n : wanted.nodes) {
    if (loaded_[n].points || loaded_[n].failed) continue;
    std::size_t& batch = open[nodes_[n].scan];
    if (batch == 0) {
      batches.emplace_back();
      batch = batches.size();
    }
    batches[batch - 1].push_back(n);
    if (batches[batch - 1].size() == at_most) batch = 0;
  }
  for (Batch& batch : batches) std::sort(batch.begin(), batch.end());  // as they are in the file
  return batches;
}

void Refinement::read(const Batch& batch, ThreadPool& pool) {
  if (loaded_[batch.front()].failed) return;  // its scan was given up
  pipeline::OctreeScan& octree = *scans_[nodes_[batch.front()].scan].octree;
  std::vector<std::size_t> in_scan;
  for (const std::size_t n : batch) in_scan.push_back(nodes_[n].node);
  const std::uint64_t before = octree.bytes_read();
  try {
    keep(batch, octree.read(in_scan, coarse_->origin_m, pool), pool);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    fail(batch, error, pool);
    return;
  }
  const std::lock_guard lock(mutex_);
  bytes_read_ += octree.bytes_read() - before;
}

void Refinement::keep(const Batch& batch, std::vector<pipeline::OctreeScan::Points> read, ThreadPool& pool) {
  const std::uint8_t station = scans_[nodes_[batch.front()].scan].station;
  const auto arranged = [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      auto part = std::make_shared<viewer::PointView>();
      part->origin_m = coarse_->origin_m;
      part->points = std::move(read[k].places);
      const std::size_t count = part->points.size();
      // As the coarse points: of several scans, one may have what another has not.
      if (!coarse_->rgba.empty()) part->rgba = std::move(read[k].rgba);
      for (std::uint32_t& colour : part->rgba) colour |= 0xFF000000U;
      if (!coarse_->rgba.empty() && part->rgba.empty()) part->rgba.assign(count, kUncoloured);
      if (!coarse_->intensity.empty()) part->intensity = std::move(read[k].intensity);
      if (!coarse_->intensity.empty() && part->intensity.empty()) part->intensity.assign(count, 0.0F);
      if (!coarse_->station.empty()) part->station.assign(count, station);
      viewer::arrange(*part);
      loaded_[batch[k]].points = std::move(part);
    }
  };
  pool.for_ranges(batch.size(), 1, arranged);
  for (const std::size_t n : batch) {
    here_.insert(n);
    held_ += counted(nodes_[n]);
  }
}

void Refinement::fail(const Batch& batch, const Error& error, ThreadPool& pool) {
  const std::size_t scan = nodes_[batch.front()].scan;
  try {
    scans_[scan].octree->require_whole();
  } catch (const Error& cut) {
    give_up(scan);
    say_(fmt::format("{}; its finer points are not read any more", cut.what()));
    return;
  }
  if (batch.size() > 1) {  // which of them it is
    for (const std::size_t n : batch) read({n}, pool);
    return;
  }
  loaded_[batch.front()].failed = true;
  {
    const std::lock_guard lock(mutex_);
    ++failed_;
  }
  if (++failures_[scan].nodes > 1) return;
  failures_[scan].said = 1;
  const std::size_t number = nodes_[batch.front()].node;
  say_(fmt::format("{}; node {} of level {} is left out", error.what(), number,
                   scans_[scan].octree->nodes()[number].level));
}

void Refinement::give_up(std::size_t scan) {
  std::uint64_t count = 0;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (nodes_[n].scan != scan || loaded_[n].failed) continue;
    loaded_[n].failed = true;  // also of what is here: it may have to make room
    if (!loaded_[n].points) ++count;
  }
  failures_[scan].said = failures_[scan].nodes += count;
  const std::lock_guard lock(mutex_);
  failed_ += count;
}

void Refinement::say_failures() {
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    Failures& failures = failures_[s];
    if (failures.nodes < 2 * std::max<std::uint64_t>(failures.said, 1)) continue;
    failures.said = failures.nodes;
    say_(fmt::format("{}: {} nodes cannot be read and are left out", scans_[s].octree->name(), failures.nodes));
  }
}

void Refinement::make_room(std::uint64_t points) {
  if (held_ + points <= most_points_) return;
  std::vector<std::size_t> old;
  for (const std::size_t n : here_)
    if (loaded_[n].wanted_at < looks_) old.push_back(n);
  std::sort(old.begin(), old.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(loaded_[a].wanted_at, a) < std::pair(loaded_[b].wanted_at, b);
  });
  for (const std::size_t n : old) {
    if (held_ + points <= most_points_) return;
    loaded_[n].points.reset();
    here_.erase(n);
    held_ -= counted(nodes_[n]);
  }
}

void Refinement::publish(const Wanted& wanted, bool last) {
  auto detail = std::make_shared<viewer::PointDetail>();
  for (const std::size_t n : here_) {
    detail->parts.push_back(loaded_[n].points);
    detail->points += loaded_[n].points->points.size();
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
