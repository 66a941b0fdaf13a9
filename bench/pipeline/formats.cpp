// Speed of each reader, points a second, beside the speed at which the file's bytes alone are read ("cat"): one surface
// in every format that is read, and the real scans of SPARSHA_SCANS_DIR where it is set.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/files/files.h"
#include "bench/pipeline/run.h"
#include "pipeline/scan/reader.h"
#include "tests/support/wave_files.h"

namespace sparsha::bench {
namespace {

namespace fs = std::filesystem;

/// Seconds of processor time, all threads together, the least of several.
double least_cpu(const std::function<void()>& work) {
  constexpr int kTimes = 5;
  double least = 1e300;
  for (int k = 0; k < kTimes; ++k) {
    const std::clock_t from = std::clock();
    work();
    least = std::min(least, static_cast<double>(std::clock() - from) / CLOCKS_PER_SEC);
  }
  return std::max(least, 1e-6);
}

std::size_t cat(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::vector<char> block(std::size_t{1} << 20U);
  std::size_t bytes = 0;
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0)
    bytes += static_cast<std::size_t>(in.gcount());
  return bytes;
}

class Table {
 public:
  explicit Table(const fs::path& file) : csv_(file) {
    csv_ << "format,file,points,megabytes,points_per_s,megabytes_per_s,cat_megabytes_per_s\n";
    fmt::print("\n## Readers, processor time, beside reading the bytes alone\n\n");
    fmt::print("| format | file | points | MB | M points/s | MB/s | cat, MB/s |\n|---|---|---|---|---|---|---|\n");
  }
  void row(const fs::path& file) {
    std::string format;
    std::uint64_t points = 0;
    const double seconds = least_cpu([&] {
      const pipeline::RawScan scan = pipeline::read_scan(file);
      format = scan.format;
      points = scan.records;
    });
    const double cat_seconds = least_cpu([&] { (void)cat(file); });
    const double megabytes = static_cast<double>(fs::file_size(file)) * 1e-6;
    const double rate = static_cast<double>(points) / seconds;
    fmt::print("| {} | {} | {} | {:.1f} | {:.2f} | {:.0f} | {:.0f} |\n", format, file.filename().string(), points,
               megabytes, 1e-6 * rate, megabytes / seconds, megabytes / cat_seconds);
    csv_ << fmt::format("\"{}\",\"{}\",{},{},{},{},{}\n", format, file.filename().string(), points, megabytes, rate,
                        megabytes / seconds, megabytes / cat_seconds);
    csv_.flush();
  }

 private:
  std::ofstream csv_;
};

/// Real scans of a megabyte and more, which say what they are worth only together with their size.
void add_real_scans(Table& table) {
  const char* const folder = std::getenv("SPARSHA_SCANS_DIR");
  if (folder == nullptr) return;
  std::vector<fs::path> files;
  for (const char* part : {"scans", "heritage"}) {
    std::error_code code;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(folder) / part, code)) {
      if (entry.is_regular_file() && entry.file_size() >= 1'000'000) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    try {
      table.row(file);
    } catch (const Error&) {
      continue;  // what is no scan
    }
  }
}

}  // namespace

void run_formats(const RunOptions& options) {
  fs::create_directories(options.work);
  const pipeline::testing::Waves waves{options.quick ? 300 : 1000};
  Table table(options.out / "pipeline_formats.csv");
  for (const pipeline::testing::WaveFile& wave : pipeline::testing::wave_files()) {
    const fs::path file = options.work / wave.name;
    write_file(file, wave.bytes(waves));
    table.row(file);
    fs::remove(file);
  }
  add_real_scans(table);
}

}  // namespace sparsha::bench
