#include "haptics/replay/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "base/files/files.h"
#include "base/numbers/statistics.h"
#include "base/text/csv.h"
#include "base/text/text.h"
#include "base/threads/progress.h"
#include "haptics/proxy/rest_residual.h"

namespace sparsha::haptics {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kBlock = 4096;  // rows between two looks at the progress: some milliseconds

double nanoseconds(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double, std::nano>(end - begin).count();
}

/// What two readings of the clock cost with nothing between them: the median of many.
double timer_overhead_ns() {
  std::vector<double> pauses(2001);
  for (double& pause : pauses) {
    const Clock::time_point begin = Clock::now();
    pause = nanoseconds(begin, Clock::now());
  }
  return median(pauses);
}

void summarise_times(const std::vector<TraceRow>& rows, TraceSummary& summary) {
  std::vector<double> times;
  times.reserve(rows.size());
  double sum = 0.0;
  for (const TraceRow& row : rows) {
    times.push_back(row.tick_ns);
    sum += row.tick_ns;
  }
  if (times.empty()) return;
  summary.ns_p50 = quantile(times, 0.5);
  summary.ns_p99 = quantile(times, 0.99);
  summary.ns_p999 = quantile(times, 0.999);
  summary.ns_max = *std::max_element(times.begin(), times.end());
  summary.ns_mean = sum / static_cast<double>(times.size());
}

std::string rows_text(std::uint64_t count) { return std::to_string(count) + (count == 1 ? " row" : " rows"); }

std::string doubt_of(std::uint64_t count, std::uint64_t first, std::string_view what) {
  return rows_text(count) + " of the hand's path " + std::string(what) + (count == 1 ? " (row " : " (first: row ") +
         std::to_string(first) + " below the header)";
}

/// Between two rows: tells the share that is done. Throws Cancelled.
void tell_progress(Progress* progress, std::size_t done, std::size_t rows) {
  if (progress != nullptr && done % kBlock == 0)
    progress->at(static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(1, rows)));
}

}  // namespace

std::vector<std::string> sentences(const PathDoubts& doubts) {
  std::vector<std::string> all;
  const auto say = [&](std::uint64_t count, std::uint64_t first, const char* of_one, const char* of_many) {
    if (count > 0) all.push_back(doubt_of(count, first, count == 1 ? of_one : of_many));
  };
  say(doubts.not_a_number, doubts.first_not_a_number, "has a time or a position that is not a number",
      "have times or positions that are not numbers");
  say(doubts.same_time, doubts.first_same_time, "has the time of the row before", "have the time of the row before");
  say(doubts.backwards, doubts.first_backwards, "is earlier than a row before", "are earlier than a row before");
  if (doubts.outside > 0 && doubts.outside_object)
    all.push_back(doubt_of(
        doubts.outside, doubts.first_outside,
        fmt::format(
            "{} farther from the object than it is long, by up to {} from its box: are these metres, in the frame "
            "that was said?",
            doubts.outside == 1 ? "is" : "are", length_text(doubts.outside_m))));
  else if (doubts.outside > 0)
    all.push_back(doubt_of(
        doubts.outside, doubts.first_outside,
        fmt::format("{} beside the scene, by up to {}, and {} of them in contact with the level "
                    "ground that goes on from its border: are these metres, in the frame that was "
                    "said?",
                    doubts.outside == 1 ? "is" : "are", length_text(doubts.outside_m), doubts.outside_in_contact)));
  if (doubts.impossible_force > 0)
    all.push_back(
        fmt::format("{} of the path {} forces above {:.0f} N, which no device gives: up to {:.4g} N, with "
                    "the hand {} from where it is held; are these metres, in the frame that was said?",
                    rows_text(doubts.impossible_force), doubts.impossible_force == 1 ? "has" : "have",
                    kImpossibleForce_n, doubts.largest_force_n, length_text(doubts.deepest_m)));
  return all;
}

double distance_beside_m(const MongeSurface& surface, const Eigen::Vector3d& local_m) {
  const auto beyond = [](double at, double end) { return std::max({0.0, -at, at - end}); };
  const double distance_m = std::hypot(beyond(local_m.x(), surface.width_m()), beyond(local_m.y(), surface.depth_m()));
  return std::isfinite(distance_m) ? distance_m : 0.0;
}

TraceRecorder::TraceRecorder(std::size_t rows, Progress* progress) : expected_(rows), progress_(progress) {
  result_.summary.timer_overhead_ns = timer_overhead_ns();
  result_.rows.reserve(rows);
  residuals_.reserve(rows);
}

void TraceRecorder::add(const TraceRow& row, const MongeSurface& surface, const ProxyUpdate& found,
                        const Eigen::Vector3d& hip_local_m, CellShape shape) {
  add(row, found.unfinished);
  if (!row.contact) return;
  const RestResidual residual = rest_residual(surface, found, hip_local_m, shape);
  residuals_.push_back(residual.excess_cells);
  if (residual.below_cells > 0.0) ++result_.summary.below_surface;
}

void TraceRecorder::add(TraceRow row, bool unfinished) {
  TraceSummary& summary = result_.summary;
  tell_progress(progress_, result_.rows.size(), expected_);
  ++summary.updates;
  row.tick_ns = std::max(0.0, row.tick_ns - summary.timer_overhead_ns);
  result_.rows.push_back(row);
  doubt(row);
  if (!row.proxy_m.allFinite() || !row.force_n.allFinite()) ++summary.not_a_number;
  if (unfinished) ++summary.unfinished;
  if (row.contact) ++summary.contacts;
}

void TraceRecorder::doubt(const TraceRow& row) {
  PathDoubts& path = result_.summary.path;
  const auto count = [&](std::uint64_t& rows, std::uint64_t& first) {
    if (rows++ == 0) first = result_.rows.size();
  };
  if (!std::isfinite(row.t_s) || !row.hip_m.allFinite()) count(path.not_a_number, path.first_not_a_number);
  if (const double force_n = row.force_n.norm(); row.contact && std::isfinite(force_n)) {
    path.largest_force_n = std::max(path.largest_force_n, force_n);
    path.deepest_m = std::max(path.deepest_m, (row.proxy_m - row.hip_m).norm());
    if (force_n > kImpossibleForce_n) ++path.impossible_force;
  }
  if (!std::isfinite(row.t_s)) return;
  if (row.t_s == latest_s_) count(path.same_time, path.first_same_time);
  if (row.t_s < latest_s_) count(path.backwards, path.first_backwards);
  latest_s_ = std::max(latest_s_, row.t_s);
}

void TraceRecorder::outside(double distance_m, bool object) {
  PathDoubts& path = result_.summary.path;
  path.outside_object = path.outside_object || object;
  if (path.outside++ == 0) path.first_outside = result_.rows.size();
  if (result_.rows.back().contact) ++path.outside_in_contact;
  path.outside_m = std::max(path.outside_m, distance_m);
}

TraceResult TraceRecorder::finish() && {
  TraceSummary& summary = result_.summary;
  summarise_times(result_.rows, summary);
  if (!residuals_.empty()) {
    summary.residual_cells_p99 = quantile(residuals_, 0.99);
    summary.residual_cells_max = *std::max_element(residuals_.begin(), residuals_.end());
  }
  return std::move(result_);
}

TraceResult trace(const MongeSurface& surface, const std::vector<HipSample>& path, const scene::HapticsConfig& haptics,
                  const SolverOptions& solver, Progress* progress) {
  SolverOptions options = solver;
  if (haptics.surface == scene::HapticsConfig::Surface::c1) options.shape = CellShape::c1;
  TraceRecorder recorder(path.size(), progress);

  const Eigen::Vector3d& origin = surface.lattice.origin_m;
  const bool paper = haptics.solver == scene::HapticsConfig::Solver::paper;
  const double newtons_per_m = haptics.stiffness_n_per_m * surface.scale;
  ProxyState state;
  bool started = false;
  for (const HipSample& sample : path) {
    const Eigen::Vector3d hip = sample.position_m - origin;
    if (!started && hip.allFinite()) {
      state = start_proxy(surface, hip);
      started = true;
    }
    const Clock::time_point begin = Clock::now();
    const ProxyUpdate update =
        paper ? update_paper(surface, hip, state, options) : update_exact(surface, hip, state, options);
    const double elapsed_ns = nanoseconds(begin, Clock::now());

    TraceRow row;
    row.t_s = sample.t_s;
    row.hip_m = sample.position_m;
    row.proxy_m = update.position == hip ? sample.position_m : Eigen::Vector3d(update.position + origin);
    row.force_n = update.contact ? Eigen::Vector3d(newtons_per_m * (update.position - hip)) : Eigen::Vector3d::Zero();
    row.contact = update.contact;
    row.tick_ns = elapsed_ns;
    row.level = surface.level;
    recorder.add(row, surface, update, hip, paper ? CellShape::bilinear : options.shape);
    if (const double beside_m = distance_beside_m(surface, hip); beside_m > surface.lattice.spacing_m)
      recorder.outside(beside_m);
  }
  return std::move(recorder).finish();
}

void write_trace(const std::filesystem::path& file, const TraceResult& result, Progress* progress) {
  std::string text =
      "t_s,hip_x_m,hip_y_m,hip_z_m,proxy_x_m,proxy_y_m,proxy_z_m,force_x_n,force_y_n,force_z_n,contact,level,tick_ns";
  text += result.summary.around ? ",sheet\n" : "\n";
  std::size_t written = 0;
  for (const TraceRow& row : result.rows) {
    tell_progress(progress, written++, result.rows.size());
    csv::append(text, row.t_s);
    for (const Eigen::Vector3d* v : {&row.hip_m, &row.proxy_m, &row.force_n})
      for (const double coordinate : *v) csv::append(text, coordinate);
    csv::append(text, std::int64_t{row.contact});
    csv::append(text, std::int64_t{row.level});
    csv::append(text, row.tick_ns);
    if (result.summary.around) csv::append(text, row.sheet);
    csv::end_row(text);
  }
  write_file(file, text);
}

}  // namespace sparsha::haptics
