// Messages of any size in rounds whose counts are small, and the plug-in behind them.
#include "pipeline/cluster/ranks.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <utility>

#include "base/error.h"
#include "base/system/library.h"

extern "C" sparsha::pipeline::Transport* sparsha_mpi_transport();

namespace sparsha::pipeline {
namespace {

// Places of pieces that lie one behind the other.
std::vector<int> places(const std::vector<int>& counts) {
  std::vector<int> places(counts.size(), 0);
  for (std::size_t k = 1; k < counts.size(); ++k) places[k] = places[k - 1] + counts[k - 1];
  return places;
}

// The piece of a message that a round takes.
int piece(std::uint64_t size, std::uint64_t round, std::size_t most) {
  const std::uint64_t begin = std::min<std::uint64_t>(size, round * most);
  return static_cast<int>(std::min<std::uint64_t>(most, size - begin));
}

bool is_cancelled(const void* progress) { return static_cast<const Progress*>(progress)->cancelled(); }

}  // namespace

bool started_by_mpi() {
  const auto is_set = [](const char* name) { return std::getenv(name) != nullptr; };
  // Set by OpenMPI, by MPICH, Intel's MPI and Slurm, and by every launcher with PMIx.
  return is_set("OMPI_COMM_WORLD_SIZE") || is_set("PMI_SIZE") || is_set("PMIX_RANK");
}

Launched launched() {
  if (!started_by_mpi()) return {};
  const auto first_of = [](std::initializer_list<const char*> names, int otherwise) {
    for (const char* name : names)
      if (const char* const value = std::getenv(name)) return std::atoi(value);
    return otherwise;
  };
  // PMIx itself tells the rank alone; Slurm, which may start it, knows how many there are.
  return {first_of({"OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"}, 0),
          first_of({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}, 1)};
}

#if defined(SPARSHA_MPI_LIBRARY)

Transport& mpi_transport() {
  static Transport* const kTransport = [] {
    std::string problem;
    void* const library = system::load_library(SPARSHA_MPI_LIBRARY, problem);
    if (library == nullptr)
      throw Error(ErrorKind::failure, {SPARSHA_MPI_LIBRARY}, "Sparsha's part for MPI cannot be loaded: " + problem,
                  "this file in lib/sparsha beside the program's folder, and the MPI that it was built with");
    const auto get =
        reinterpret_cast<decltype(&sparsha_mpi_transport)>(system::symbol(library, "sparsha_mpi_transport"));
    if (get == nullptr)
      throw Error(ErrorKind::failure, {SPARSHA_MPI_LIBRARY}, "this file does not hold Sparsha's part for MPI",
                  "the file that was installed with the program");
    return get();
  }();
  return *kTransport;
}

#else

Transport& mpi_transport() {
  throw Error(ErrorKind::failure, {}, "this program was built without MPI, and was started by a launcher of MPI",
              "`sparsha` without mpirun, or a program that was built where MPI is installed");
}

#endif

Ranks::Ranks(Transport& transport, const Progress& progress, std::size_t round_bytes)
    : transport_(transport), progress_(progress), most_(std::max<std::size_t>(1, round_bytes / size())) {}

void Ranks::exchange(const Bytes& send, const std::vector<int>& counts, Bytes& receive,
                     const std::vector<int>& from) const {
  const std::vector<int> send_places = places(counts);
  const std::vector<int> receive_places = places(from);
  const auto began = std::chrono::steady_clock::now();
  if (!transport_.exchange(send.data(), counts.data(), send_places.data(), receive.data(), from.data(),
                           receive_places.data(), is_cancelled, &progress_)) {
    throw Cancelled();
  }
  for (std::size_t r = 0; r < size(); ++r) own_.bytes += r == number() ? 0U : static_cast<std::uint64_t>(counts[r]);
  own_.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

std::vector<Ranks::Bytes> Ranks::all_to_all(const std::vector<Bytes>& to) const {
  // Sizes first, and with them the most rounds that any rank needs.
  constexpr int kWord = sizeof(std::uint64_t);
  const std::vector<int> words(size(), 2 * kWord);
  std::vector<std::uint64_t> mine(2 * size());
  std::uint64_t rounds = 0;
  for (const Bytes& bytes : to) rounds = std::max<std::uint64_t>(rounds, (bytes.size() + most_ - 1) / most_);
  for (std::size_t r = 0; r < size(); ++r) {
    mine[2 * r] = to[r].size();
    mine[2 * r + 1] = rounds;
  }
  Bytes send(mine.size() * kWord);
  Bytes receive(send.size());
  std::memcpy(send.data(), mine.data(), send.size());
  exchange(send, words, receive, words);
  std::vector<std::uint64_t> theirs(mine.size());
  std::memcpy(theirs.data(), receive.data(), receive.size());
  for (std::size_t r = 0; r < size(); ++r) rounds = std::max(rounds, theirs[2 * r + 1]);

  std::vector<Bytes> got(size());
  for (std::size_t r = 0; r < size(); ++r) got[r].reserve(static_cast<std::size_t>(theirs[2 * r]));
  std::vector<int> counts(size());
  std::vector<int> from(size());
  for (std::uint64_t round = 0; round < rounds; ++round) {
    send.clear();
    std::size_t expected = 0;
    for (std::size_t r = 0; r < size(); ++r) {
      counts[r] = piece(to[r].size(), round, most_);
      from[r] = piece(theirs[2 * r], round, most_);
      expected += static_cast<std::size_t>(from[r]);
      const auto begin =
          to[r].begin() + static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(to[r].size(), round * most_));
      send.insert(send.end(), begin, begin + counts[r]);
    }
    receive.resize(expected);
    exchange(send, counts, receive, from);
    auto at = receive.cbegin();
    for (std::size_t r = 0; r < size(); ++r) {
      got[r].insert(got[r].end(), at, at + from[r]);
      at += from[r];
    }
  }
  return got;
}

Ranks::Bytes Ranks::merged(Bytes mine, const std::function<Bytes(const Bytes&, const Bytes&)>& merge) const {
  const std::size_t rank = number();
  // Up a tree: each takes what the one `step` behind it has gathered. Then down again.
  std::size_t step = 1;
  for (; step < size(); step *= 2) {
    std::vector<Bytes> to(size());
    if (rank % (2 * step) == step) to[rank - step] = std::exchange(mine, {});
    std::vector<Bytes> got = all_to_all(to);
    if (rank % (2 * step) == 0 && rank + step < size()) mine = merge(mine, got[rank + step]);
  }
  for (step /= 2; step > 0; step /= 2) {
    std::vector<Bytes> to(size());
    if (rank % (2 * step) == 0 && rank + step < size()) to[rank + step] = mine;
    std::vector<Bytes> got = all_to_all(to);
    if (rank % (2 * step) == step) mine = std::move(got[rank - step]);
  }
  return mine;
}

void Ranks::join(Bytes& bytes) const {
  bytes = merged(std::move(bytes), [](const Bytes& first, const Bytes& second) {
    Bytes both = first;
    both.insert(both.end(), second.begin(), second.end());
    return both;
  });
}

std::vector<Ranks::Bytes> Ranks::gather(Bytes bytes) const {
  std::vector<Bytes> to(size());
  to.front() = std::move(bytes);
  return all_to_all(to);
}

Ranks::Traffic Ranks::traffic() const {
  Bytes bytes(sizeof(Traffic));
  std::memcpy(bytes.data(), &own_, sizeof(Traffic));
  join(bytes);
  Traffic all;
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(Traffic)) {
    Traffic one;
    std::memcpy(&one, bytes.data() + at, sizeof(Traffic));
    all.bytes += one.bytes;
    all.seconds = std::max(all.seconds, one.seconds);
  }
  return all;
}

}  // namespace sparsha::pipeline
