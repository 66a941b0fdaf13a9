// More points of raw clouds where somebody looks: a worker reads the nodes of COPC files that the picture shows, coarse
// and near ones first, into a bounded memory.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <Eigen/Core>

#include "base/error.h"
#include "base/threads/thread_pool.h"
#include "pipeline/scan/formats/las/octree_scan.h"
#include "viewer/cloud/point_view.h"
#include "viewer/cloud/splat.h"

namespace sparsha::app {

/// Points without a colour beside others that have one.
inline constexpr std::uint32_t kUncoloured = 0xFFB0B0B0U;

/// A node counts as at least so many points: it takes memory, and time in every picture, beside its points.
inline constexpr std::uint64_t kLeastCounted = 4096;

/// A scan whose levels down to `read_level` are in the PointView already.
struct CoarseScan {
  std::unique_ptr<pipeline::OctreeScan> octree;
  int read_level = 0;
  std::uint8_t station = 0;
};

/// What a picture asks for.
struct Look {
  viewer::SplatView view;
  std::optional<scene::CropConfig> crop;  ///< scan frame, metres
};

/// A node that may be read.
struct DetailNode {
  std::size_t scan = 0, node = 0;  ///< numbers in the list of scans, and in the scan
  int levels_below = 0;            ///< under its scan's read level; 1: the first one
  Eigen::Vector3d low_m, high_m;   ///< as PointView::points
  double parents_apart_m = 0.0;    ///< distance of the points on the level above
  std::uint64_t points = 0;
};

/// The nodes that the picture wants, as numbers in the list: those in it whose parents' points are more than a pixel
/// apart; coarse ones first, then those near to its middle and to the viewer. As many as `most_points` allows, each
/// counted as at least kLeastCounted; `all` says whether these are all.
struct Wanted {
  std::vector<std::size_t> nodes;
  bool all = true;
};
[[nodiscard]] Wanted wanted_nodes(const std::vector<DetailNode>& nodes, const Look& look,
                                  const Eigen::Vector3d& origin_m, std::uint64_t most_points);

class Refinement {
 public:
  /// `coarse` is what the scans' coarse levels gave; `most_points`: kept in memory beside it, counted as wanted_nodes()
  /// does. `say` is called from the worker for the first node of a scan that cannot be read, which is left out; later
  /// ones are counted, and their number is said each time that it has doubled. Of a file that became shorter no further
  /// node is read.
  Refinement(std::vector<CoarseScan> scans, std::shared_ptr<const viewer::PointView> coarse, std::uint64_t most_points,
             std::function<void(const std::string&)> say);
  /// Stops the worker.
  ~Refinement();
  Refinement(const Refinement&) = delete;
  Refinement& operator=(const Refinement&) = delete;

  /// Returns at once; what was asked for before is given up.
  void look(const Look& look);
  /// Waits until nothing is read, gives up what was loaded, and stays so until resume(): for who needs the memory.
  /// From one thread at a time, as resume().
  void rest();
  /// Looks again as it was asked last.
  void resume();
  /// Null until there is some.
  [[nodiscard]] std::shared_ptr<const viewer::PointDetail> detail() const;
  /// More is to come for the last look.
  [[nodiscard]] bool busy() const;
  /// Of chunks of the files.
  [[nodiscard]] std::uint64_t bytes_read() const;
  /// Nodes that could not be read.
  [[nodiscard]] std::uint64_t failures() const;

 private:
  struct Loaded {
    std::shared_ptr<const viewer::PointView> points;
    std::uint64_t wanted_at = 0;  ///< number of the last look that wanted it
    bool failed = false;
  };
  void list_nodes();
  void work();
  using Batch = std::vector<std::size_t>;
  struct Failures {
    std::uint64_t nodes = 0, said = 0;
  };
  void refine(const Look& look, ThreadPool& pool);
  /// What is wanted and not here, each batch of one scan and at most as many nodes as there are threads.
  [[nodiscard]] std::vector<Batch> batches_of(const Wanted& wanted, std::size_t at_most) const;
  void read(const Batch& batch, ThreadPool& pool);
  void keep(const Batch& batch, std::vector<pipeline::OctreeScan::Points> read, ThreadPool& pool);
  void fail(const Batch& batch, const Error& error, ThreadPool& pool);
  void give_up(std::size_t scan);
  void say_failures();
  void make_room(std::uint64_t points);
  void publish(const Wanted& wanted, bool last);
  [[nodiscard]] bool outdated() const;

  std::vector<CoarseScan> scans_;
  std::shared_ptr<const viewer::PointView> coarse_;
  std::uint64_t most_points_;
  std::function<void(const std::string&)> say_;
  std::vector<DetailNode> nodes_;

  // The worker's own.
  std::vector<Loaded> loaded_;
  std::set<std::size_t> here_;  ///< nodes whose points are loaded
  std::uint64_t held_ = 0, looks_ = 0;
  std::vector<Failures> failures_;  ///< one a scan

  mutable std::mutex mutex_;  ///< of what follows
  std::condition_variable wake_, idle_;
  std::optional<Look> asked_, last_;
  std::shared_ptr<const viewer::PointDetail> detail_;
  std::uint64_t bytes_read_ = 0, failed_ = 0;
  bool busy_ = false, working_ = false, resting_ = false, stop_ = false;
  std::thread worker_;
};

}  // namespace sparsha::app
