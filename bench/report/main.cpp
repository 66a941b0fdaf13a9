// bench_report: build/bench/report.html from what the other programs left in the same folder.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "base/system.h"
#include "base/text/html.h"
#include "bench/report/chapters.h"
#include "bench/report/html.h"

namespace sparsha::bench {
namespace {

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

std::string compiler() {
#ifdef __clang__
  return __VERSION__;
#else
  return std::string("GCC ") + __VERSION__;
#endif
}

bool write_page(const std::filesystem::path& folder, const std::string& mode, double seconds) {
  const double memory_gb = 1e-9 * static_cast<double>(system::physical_memory_bytes());
  std::string introduction = "<p>Machine: " + escape_html(processor()) + ", " +
                             std::to_string(std::thread::hardware_concurrency()) + " threads, " +
                             text_of("%.0f GB", memory_gb) + " of memory. Compiler: " + escape_html(compiler()) +
                             ", " SPARSHA_BUILD_TYPE "; PCL " SPARSHA_PCL_VERSION ". Mode: " + escape_html(mode) + ".";
  if (seconds > 0.0) introduction += " Measuring took " + text_of("%.0f s", seconds) + ".";
  if (mode == "quick")
    introduction +=
        " The quick mode leaves out the slow parts: scenes of known accuracy, more closed objects, normals, "
        "registration, transfer, builds, stability, and most settings of the rest.";
  introduction +=
      " Where a table has times over ours, its methods took turns in this run, each round another one first; least and "
      "greatest are the range of the ratios in the same round, which holds the true median with a probability of 1 - "
      "2<sup>1 - rounds</sup> (94 % for five). A time of a method stands beside the error that it bought; times of "
      "stages, "
      "of sound and of the loop have none. CloudCompare runs as a process of its own after the others. This page needs "
      "no "
      "other file; the CSV files beside it hold every figure.</p>\n" +
      findings_html(folder);
  const std::string body = file_text(folder / "race.part.html") + effects_html(folder) + objects_html(folder) +
                           pipeline_html(folder) + scaling_html(folder) + paper_html(folder) + real_time_html(folder) +
                           files_html(folder);
  std::ofstream page(folder / "report.html");
  page << html_page("Sparsha: speed against error", introduction, body);
  return static_cast<bool>(page.flush());
}

}  // namespace
}  // namespace sparsha::bench

int main(int argc, char** argv) {
  std::filesystem::path out = ".";
  std::string mode = "quick";
  double seconds = 0.0;
  for (int k = 1; k < argc; k += 2) {
    if (k + 1 < argc && std::strcmp(argv[k], "--mode") == 0) {
      mode = argv[k + 1];
    } else if (k + 1 < argc && std::strcmp(argv[k], "--out") == 0) {
      out = argv[k + 1];
    } else if (k + 1 < argc && std::strcmp(argv[k], "--seconds") == 0) {
      seconds = std::atof(argv[k + 1]);
    } else {
      std::fputs("usage: bench_report [--mode NAME] [--out DIR] [--seconds S]\n", stderr);
      return 2;
    }
  }
  try {
    if (sparsha::bench::write_page(out, mode, seconds)) return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  std::fprintf(stderr, "%s: error: cannot be written\n", (out / "report.html").c_str());
  return 1;
}
