// A build that several processes share: how many there are, and what they tell each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/threads/progress.h"
#include "pipeline/cluster/transport.h"

namespace sparsha::pipeline {

/// Whether this process was started by mpirun, srun or another launcher of MPI.
[[nodiscard]] bool started_by_mpi();

/// What the launcher says without MPI: which process this is and of how many; 0 of 1 without a launcher, and where it
/// does not say.
struct Launched {
  int rank = 0, size = 1;
};
[[nodiscard]] Launched launched();

/// Loads the plug-in and sets MPI up, which takes half a second; the same object at every call. Throws Error{failure}
/// when the plug-in is not installed.
[[nodiscard]] Transport& mpi_transport();

/// The ranks of a build. Every call but those that say otherwise is made by all ranks at the same time.
class Ranks {
 public:
  using Bytes = std::vector<std::byte>;
  /// Bytes that a rank sends and receives in one round, together; the counts of MPI are int.
  static constexpr std::size_t kRoundBytes = std::size_t{1} << 28U;

  /// Both outlive the ranks. `round_bytes`: at least a byte a rank, and below 2^31.
  Ranks(Transport& transport, const Progress& progress, std::size_t round_bytes = kRoundBytes);

  [[nodiscard]] int rank() const { return transport_.rank(); }
  [[nodiscard]] std::size_t number() const { return static_cast<std::size_t>(transport_.rank()); }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(transport_.size()); }
  /// On which this rank runs.
  [[nodiscard]] const char* host() const { return transport_.host(); }
  /// Whether this rank writes the scene.
  [[nodiscard]] bool is_root() const { return transport_.rank() == 0; }

  /// What each rank has for this one, in their order; `to` has what this one has for each. Of any size: sent in rounds.
  /// Throws Cancelled.
  [[nodiscard]] std::vector<Bytes> all_to_all(const std::vector<Bytes>& to) const;
  /// What all ranks have, in their order, to all of them. Throws Cancelled.
  void join(Bytes& bytes) const;
  /// What `merge` makes of what all ranks have, two neighbours at a time, to all of them: each keeps no more than two
  /// of them in memory, whatever their number. Throws Cancelled.
  [[nodiscard]] Bytes merged(Bytes mine,
                             const std::function<Bytes(const Bytes& first, const Bytes& second)>& merge) const;
  /// What all ranks have, in their order, to the root; nothing to the others. Throws Cancelled.
  [[nodiscard]] std::vector<Bytes> gather(Bytes bytes) const;

  /// Bytes that all ranks have sent to others so far, and the longest that one of them has spent on it, waiting for the
  /// others included; seconds. Throws Cancelled.
  struct Traffic {
    std::uint64_t bytes = 0;
    double seconds = 0.0;
  };
  [[nodiscard]] Traffic traffic() const;

 private:
  void exchange(const Bytes& send, const std::vector<int>& counts, Bytes& receive, const std::vector<int>& from) const;

  Transport& transport_;
  const Progress& progress_;
  std::size_t most_;  ///< bytes in a round between two ranks
  mutable Traffic own_;
};

}  // namespace sparsha::pipeline
