// whole_way SECONDS [FIRST_SEED]: made-up scans on their whole way for so long, for builds with sanitizers. Prints what
// broke with its seed, and ends with 1 if anything did. `whole_way 0 SEED` tries one.
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <random>

#include "tests/support/whole_way.h"

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::seconds(argc > 1 ? std::atoi(argv[1]) : 20);
  auto seed = static_cast<std::uint32_t>(argc > 2 ? std::atoll(argv[2]) : 1000);
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("sparsha-whole-way-" + std::to_string(::getpid()));
  unsigned long tried = 0, built = 0, broken = 0;
  do {
    std::array<std::uint8_t, 64> bytes{};
    std::mt19937 random(seed);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    const auto began = Clock::now();
    try {
      built += sparsha::test::go_whole_way(bytes, folder) ? 1U : 0U;
    } catch (const std::exception& error) {
      ++broken;
      std::printf("seed %u: %s\n", seed, error.what());
    }
    const std::chrono::duration<double> took = Clock::now() - began;
    if (took.count() > 30.0) {
      ++broken;
      std::printf("seed %u: took %.1f s\n", seed, took.count());
    }
    std::fflush(stdout);
    ++tried;
    ++seed;
  } while (Clock::now() < end);
  std::filesystem::remove_all(folder);
  std::printf("%lu scans tried, %lu built and touched, %lu broken; the next seed is %u\n", tried, built, broken, seed);
  return broken > 0 ? 1 : 0;
}
