// The only file that sees MPI.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "pipeline/cluster/transport.h"

namespace sparsha::pipeline {
namespace {

class MpiTransport final : public Transport {
 public:
  MpiTransport() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    int length = 0;
    MPI_Get_processor_name(host_, &length);
  }

  [[nodiscard]] int rank() const noexcept override { return rank_; }
  [[nodiscard]] int size() const noexcept override { return size_; }
  [[nodiscard]] const char* host() const noexcept override { return host_; }

  [[nodiscard]] bool exchange(const std::byte* send, const int* send_counts, const int* send_places, std::byte* receive,
                              const int* receive_counts, const int* receive_places, bool (*stopped)(const void*),
                              const void* what) noexcept override {
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Ialltoallv(send, send_counts, send_places, MPI_BYTE, receive, receive_counts, receive_places, MPI_BYTE,
                   MPI_COMM_WORLD, &request);
    return wait(request, stopped, what);
  }

  void finish() noexcept override {
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Ibarrier(MPI_COMM_WORLD, &request);
    (void)wait(
        request, [](const void*) { return false; }, nullptr);
    MPI_Finalize();
  }

  [[noreturn]] void abort(int code) noexcept override {
    MPI_Abort(MPI_COMM_WORLD, code);
    std::_Exit(code);
  }

 private:
  // MPI's own waiting takes a whole core, and does not hear that the build is to end.
  static bool wait(MPI_Request& request, bool (*stopped)(const void*), const void* what) noexcept {
    using std::chrono::microseconds;
    constexpr int kBusy = 200;  // calls without a pause
    constexpr microseconds kLongest(1000);
    microseconds pause(10);
    for (int calls = 0;; ++calls) {
      int done = 0;
      MPI_Test(&request, &done, MPI_STATUS_IGNORE);
      if (done != 0) return true;
      if (stopped(what)) return false;
      if (calls < kBusy) continue;
      std::this_thread::sleep_for(pause);
      if (pause < kLongest) pause *= 2;
    }
  }

  int rank_ = 0;
  int size_ = 1;
  char host_[MPI_MAX_PROCESSOR_NAME] = {};
};

}  // namespace
}  // namespace sparsha::pipeline

extern "C" sparsha::pipeline::Transport* sparsha_mpi_transport();

extern "C" sparsha::pipeline::Transport* sparsha_mpi_transport() {
  static sparsha::pipeline::MpiTransport transport;
  return &transport;
}
