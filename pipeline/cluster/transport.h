// What ranks need of a message-passing library: implemented by a plug-in of its own (cluster/mpi), so that neither the
// library nor its headers are met where a build runs alone.
#pragma once

#include <cstddef>

namespace sparsha::pipeline {

/// One process among several that were started together. One call at a time; nothing throws, since what is thrown in a
/// plug-in is not always known in the program.
class Transport {
 public:
  virtual ~Transport() = default;

  [[nodiscard]] virtual int rank() const noexcept = 0;  ///< 0 to size() - 1
  [[nodiscard]] virtual int size() const noexcept = 0;
  [[nodiscard]] virtual const char* host() const noexcept = 0;  ///< on which this process runs

  /// Bytes for and from each rank: as many, from that place on, of `send` and `receive`. Every rank calls this at the
  /// same time. False when `stopped(what)` has become true meanwhile; nothing else can be exchanged then.
  [[nodiscard]] virtual bool exchange(const std::byte* send, const int* send_counts, const int* send_places,
                                      std::byte* receive, const int* receive_counts, const int* receive_places,
                                      bool (*stopped)(const void*), const void* what) noexcept = 0;

  /// Waits for all ranks and ends what was set up.
  virtual void finish() noexcept = 0;
  /// Ends the processes of all ranks with that exit code; does not return.
  [[noreturn]] virtual void abort(int code) noexcept = 0;
};

}  // namespace sparsha::pipeline
