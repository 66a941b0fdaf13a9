// bench_pipeline: accuracy and speed of the way from scans to heights, CloudCompare beside it when it is installed.
// With --strict the exit code is 1 when a figure breaks its bound; the tables mark such figures in any case.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "bench/pipeline/run.h"

namespace {

constexpr const char* kUsage =
    "usage: bench_pipeline [--out DIR] [--mode quick|full|all] [--strict] [--only "
    "peers|scaling|sites|formats|accuracy|closed|normals|filters|registration|mtf|speed|c2m|huge]\n"
    "                      [--scenes TEXT] [--no-cloudcompare] [--all] [--huge POINTS] [--program PATH]\n";

}  // namespace

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  sparsha::bench::RunOptions options;
  options.program = fs::path(argv[0]).parent_path() / "sparsha";
  std::string only;
  bool strict = false, everything = false;
  const std::vector<std::string> words(argv + 1, argv + argc);
  for (std::size_t k = 0; k < words.size(); ++k) {
    const bool more = k + 1 < words.size();
    if (words[k] == "--mode" && more && (words[k + 1] == "quick" || words[k + 1] == "full" || words[k + 1] == "all")) {
      options.quick = words[++k] == "quick";
      everything = words[k] == "all";
    } else if (words[k] == "--strict") {
      strict = true;
    } else if (words[k] == "--all") {
      options.every = true;
    } else if (words[k] == "--no-cloudcompare") {
      options.cloudcompare = false;
    } else if (words[k] == "--out" && more) {
      options.out = words[++k];
    } else if (words[k] == "--only" && more) {
      only = words[++k];
    } else if (words[k] == "--scenes" && more) {
      options.scenes = words[++k];
    } else if (words[k] == "--huge" && more) {
      options.huge_points = std::strtod(words[++k].c_str(), nullptr);
    } else if (words[k] == "--program" && more) {
      options.program = words[++k];
    } else {
      std::fputs(kUsage, stderr);
      return 2;
    }
  }
  bool kept = true;
  try {
    fs::create_directories(options.out);
    options.work = options.out / ("bench_pipeline-" + std::to_string(getpid()));
    const auto always = [&](const char* part) { return only.empty() || only == part; };
    // The quick mode leaves out what takes longest, and the full mode, which has twenty minutes with all the other
    // programs, what others of its parts show as well; --only has each, --mode all all of them.
    const auto in_full = [&](const char* part) { return only == part || (only.empty() && !options.quick); };
    const auto in_all = [&](const char* part) { return only == part || (only.empty() && everything); };
    if (always("peers")) sparsha::bench::run_peers(options);
    if (always("scaling")) sparsha::bench::run_scaling(options);
    if (always("sites")) sparsha::bench::run_sites(options);
    if (always("formats")) sparsha::bench::run_formats(options);
    if (in_full("accuracy")) kept = sparsha::bench::run_accuracy(options) && kept;
    if (in_full("closed")) kept = sparsha::bench::run_closed(options) && kept;
    if (in_full("normals")) sparsha::bench::run_normals(options);
    if (always("filters")) sparsha::bench::run_filters(options);
    if (in_full("registration")) sparsha::bench::run_registration(options);
    if (in_full("mtf")) sparsha::bench::run_mtf(options);
    if (in_all("c2m")) kept = sparsha::bench::run_cross_check(options) && kept;
    if (in_all("speed")) sparsha::bench::run_speed(options);
    if (only.empty() || only == "huge") kept = sparsha::bench::run_huge(options) && kept;
    fs::remove_all(options.work);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return kept || !strict ? 0 : 1;
}
