// make_seeds OUT [FILE...]: what scan_fuzz begins with, a small surface in every format and the given scans, each with
// the byte behind it that chooses its name.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

#include "base/files/files.h"
#include "tests/fuzz/scan_names.h"
#include "tests/support/mended.h"
#include "tests/support/wave_files.h"

namespace {

namespace fs = std::filesystem;

/// Of the name with this ending; that of rows of numbers for others.
std::size_t choice_of(const std::string& ending) {
  using sparsha::fuzz::kScanNames;
  for (std::size_t k = 0; k < kScanNames.size(); ++k)
    if (kScanNames[k] == "s" + ending) return k;
  return 5;
}

void write_seed(const fs::path& folder, const fs::path& name, std::string bytes) {
  bytes += static_cast<char>(choice_of(name.extension().string()));
  sparsha::write_file(folder / name.filename(), bytes);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  try {
    const fs::path folder = argv[1];
    fs::create_directories(folder);
    for (const auto& wave : sparsha::pipeline::testing::wave_files()) {
      const std::string bytes = wave.bytes({4}), contents = sparsha::pipeline::testing::bare(bytes, wave.name);
      write_seed(folder, std::string(wave.name), bytes);
      if (contents != bytes) write_seed(folder, "bare-" + std::string(wave.name), contents);
    }
    for (int k = 2; k < argc; ++k) write_seed(folder, argv[k], sparsha::read_file(argv[k], std::size_t{1} << 20U));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
