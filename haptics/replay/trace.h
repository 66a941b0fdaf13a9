// Offline rendering: a path of the hand in, proxy and force out (`sparsha trace`).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "haptics/proxy/proxy.h"
#include "haptics/surface/monge_surface.h"

namespace sparsha {
class Progress;
}

namespace sparsha::haptics {

struct HipSample {
  double t_s = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
};

/// Reads path.csv (t_s,x_m,y_m,z_m) or the HIP columns of a run.csv. A last row that ends in its middle is left out,
/// as in a playback, and `progress` is warned of it. Throws Error{input} with file and line.
[[nodiscard]] std::vector<HipSample> read_hip_path(const std::filesystem::path& file, Progress* progress = nullptr);

/// One row of trace.csv; grid frame, force in the device frame.
struct TraceRow {
  double t_s = 0.0;
  Eigen::Vector3d hip_m, proxy_m, force_n;
  bool contact = false;
  double tick_ns = 0.0;
  int level = 0;
  std::int64_t sheet = -1;  ///< of a whole object, that the proxy lies on; -1: none
};

/// More than any desktop device gives, newtons: a spring that long is a path in other units or another frame.
inline constexpr double kImpossibleForce_n = 50.0;

/// Rows of a path that say nothing, or nothing new, of where the hand was, or that it was where no hand can be. All are
/// rendered as they stand.
struct PathDoubts {
  std::uint64_t not_a_number = 0;  ///< time or position is NaN or infinite
  std::uint64_t same_time = 0;     ///< the time of the row before
  std::uint64_t backwards = 0;     ///< earlier than a row before
  std::uint64_t first_not_a_number = 0, first_same_time = 0, first_backwards = 0;  ///< row, 1 below the header; 0: none
  /// More than a cell beside the surface, which goes on level there (MongeSurface); of a whole object, farther from its
  /// box than that is long, where no device that holds it reaches.
  std::uint64_t outside = 0, outside_in_contact = 0, first_outside = 0;
  double outside_m = 0.0;              ///< the farthest of them, beyond the border or the box
  bool outside_object = false;         ///< one of them was outside a whole object
  std::uint64_t impossible_force = 0;  ///< above kImpossibleForce_n
  double largest_force_n = 0.0;        ///< of all rows
  double deepest_m = 0.0;              ///< from hand to proxy, of all rows in contact
};

/// One sentence for each kind of doubtful rows, with their count and the first; empty for a path without them.
[[nodiscard]] std::vector<std::string> sentences(const PathDoubts& doubts);

/// What a path on a whole object did besides.
struct AroundSummary {
  std::uint64_t sheets = 0;      ///< of the object
  std::uint64_t touched = 0;     ///< of them, on which the proxy rested
  std::uint64_t hand_overs = 0;  ///< from sheet to sheet of one surface
  std::uint64_t edges = 0;       ///< across sharp edges
  std::uint64_t releases = 0;    ///< the surface ended under the proxy
};

/// What `trace --json` prints.
struct TraceSummary {
  std::uint64_t updates = 0, contacts = 0, below_surface = 0, not_a_number = 0, unfinished = 0;
  double ns_p50 = 0, ns_p99 = 0, ns_p999 = 0, ns_max = 0, ns_mean = 0, timer_overhead_ns = 0;
  double residual_cells_p99 = 0, residual_cells_max = 0;  ///< of rest condition (c), in cells
  PathDoubts path;
  std::optional<AroundSummary> around;
};

struct TraceResult {
  std::vector<TraceRow> rows;
  TraceSummary summary;
};

/// Renders `path` (grid frame) on `surface`. At the first sample the proxy starts above or at the HIP. `progress`,
/// where there is one, is told the share of the rows every few thousand of them; when it is cancelled, Cancelled is
/// thrown.
[[nodiscard]] TraceResult trace(const MongeSurface& surface, const std::vector<HipSample>& path,
                                const scene::HapticsConfig& haptics, const SolverOptions& options,
                                Progress* progress = nullptr);

/// How far a place in the frame of a surface is beside its rectangle, in its plane; 0 within and for what is no number.
[[nodiscard]] double distance_beside_m(const MongeSurface& surface, const Eigen::Vector3d& local_m);

/// Gathers rows and judges every rest, for trace() and others that render offline.
class TraceRecorder {
 public:
  /// `progress` as in trace().
  explicit TraceRecorder(std::size_t rows, Progress* progress = nullptr);

  /// `row.tick_ns` as measured; `found` on `surface` for the hand at `hip_local_m`.
  void add(const TraceRow& row, const MongeSurface& surface, const ProxyUpdate& found,
           const Eigen::Vector3d& hip_local_m, CellShape shape);
  /// The same without a rest to be judged: the proxy is free, or in a crease between two surfaces.
  void add(TraceRow row, bool unfinished);
  /// That the hand of the row that was added last is so far beside the surface, or from a whole object.
  void outside(double distance_m, bool object = false);
  [[nodiscard]] TraceResult finish() &&;

 private:
  void doubt(const TraceRow& row);

  TraceResult result_;
  std::size_t expected_;  // rows
  Progress* progress_;
  std::vector<double> residuals_;
  double latest_s_ = -std::numeric_limits<double>::infinity();
};

/// Writes trace.csv atomically, 17 significant digits, with each row's own level. `progress` as in trace(); a cancelled
/// one leaves no file.
void write_trace(const std::filesystem::path& file, const TraceResult& result, Progress* progress = nullptr);
}  // namespace sparsha::haptics
