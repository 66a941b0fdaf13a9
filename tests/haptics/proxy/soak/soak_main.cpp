// The long soak of the proxy: haptics_soak [moves] [seed] [threads]. Exit 0 only without a single failure.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "tests/haptics/proxy/soak.h"

namespace {

using sparsha::haptics::test::SoakCount;

constexpr std::uint64_t kPiece = 1'000'000;

std::uint64_t argument(int argc, char** argv, int index, std::uint64_t otherwise) {
  return argc > index ? std::strtoull(argv[index], nullptr, 10) : otherwise;
}

void add(SoakCount& sum, const SoakCount& piece) {
  sum.moves += piece.moves;
  sum.contacts += piece.contacts;
  sum.non_stationary += piece.non_stationary;
  sum.below += piece.below;
  sum.not_a_number += piece.not_a_number;
  sum.stuck += piece.stuck;
  sum.rose += piece.rose;
  sum.tunnelled += piece.tunnelled;
  sum.unfinished += piece.unfinished;
  sum.most_segments = std::max(sum.most_segments, piece.most_segments);
  sum.worst_excess_cells = std::max(sum.worst_excess_cells, piece.worst_excess_cells);
  sum.worst_below_cells = std::max(sum.worst_below_cells, piece.worst_below_cells);
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t moves = argument(argc, argv, 1, 100'000'000);
  const std::uint64_t seed = argument(argc, argv, 2, 1);
  const std::uint64_t threads =
      std::max<std::uint64_t>(1, argument(argc, argv, 3, std::thread::hardware_concurrency()));
  const std::uint64_t pieces = (moves + kPiece - 1) / kPiece;
  std::vector<SoakCount> sums(threads);
  std::vector<std::thread> workers;
  for (std::uint64_t thread = 0; thread < threads; ++thread)
    workers.emplace_back([&, thread] {
      for (std::uint64_t piece = thread; piece < pieces; piece += threads)
        add(sums[thread], sparsha::haptics::test::run_soak(std::min(kPiece, moves - piece * kPiece), seed + piece));
    });
  for (std::thread& worker : workers) worker.join();
  SoakCount total;
  for (const SoakCount& sum : sums) add(total, sum);
  const auto print = [](const char* name, std::uint64_t value) {
    std::printf("%-16s %llu\n", name, static_cast<unsigned long long>(value));
  };
  print("seed", seed);
  print("moves", total.moves);
  print("contacts", total.contacts);
  print("non-stationary", total.non_stationary);
  print("below", total.below);
  print("not a number", total.not_a_number);
  print("stuck", total.stuck);
  print("rose", total.rose);
  print("tunnelled", total.tunnelled);
  print("unfinished", total.unfinished);
  print("most segments", total.most_segments);
  std::printf("worst excess     %.3g cells\nworst depth      %.3g cells\n", total.worst_excess_cells,
              total.worst_below_cells);
  return sparsha::haptics::test::failures(total) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
