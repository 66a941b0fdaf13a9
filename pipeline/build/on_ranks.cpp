// The errors that tell what several processes do not build together. What must agree goes to the root as text, line by
// line, since the root then can name what differs.
#include "pipeline/build/on_ranks.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "pipeline/filter/streamed.h"
#include "pipeline/scan/repeated.h"
#include "scene/config/config.h"

namespace sparsha::pipeline {
namespace {

Error not_on_ranks(const Place& place, const std::string& what) {
  return {ErrorKind::usage, place, what + " by one process only, and this one was started by a launcher of MPI",
          "`sparsha build` without mpirun"};
}

// A line that ranks have in common is told by what is before its first tab: the rest must agree.
struct Told {
  std::string host;
  std::vector<std::string> lines;
};

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

// What each rank says, to the root; empty elsewhere.
std::vector<Told> gather_text(const Ranks& ranks, const std::string& text) {
  const std::string sent = std::string(ranks.host()) + "\n" + text;
  Ranks::Bytes bytes(sent.size());
  std::memcpy(bytes.data(), sent.data(), sent.size());
  std::vector<Told> told;
  const std::vector<Ranks::Bytes> all = ranks.gather(std::move(bytes));
  if (!ranks.is_root()) return told;
  for (const Ranks::Bytes& got : all) {
    std::vector<std::string> lines = lines_of({reinterpret_cast<const char*>(got.data()), got.size()});
    std::string host = std::move(lines.front());
    lines.erase(lines.begin());
    told.push_back({std::move(host), std::move(lines)});
  }
  return told;
}

std::string rank_text(std::size_t rank, const Told& told) { return fmt::format("rank {} on {}", rank, told.host); }

// A line of a configuration in quotes, unless it is too long for a message: polygons may have thousands of corners.
std::string quoted(const std::string& line) {
  constexpr std::size_t kLongest = 200;
  if (line.size() > kLongest) return "a long line '" + line.substr(0, line.find(':')) + "'";
  const std::size_t begin = line.find_first_not_of(' ');
  return "'" + (begin == std::string::npos ? std::string() : line.substr(begin)) + "'";
}

// Throws where a rank's lines are not those of the root: `differs(rank, theirs, roots)` gives the error; a line that
// one of them does not have is empty.
template <typename Differs>
void require_same_lines(const std::vector<Told>& told, const Differs& differs) {
  for (std::size_t r = 1; r < told.size(); ++r) {
    const std::vector<std::string>& roots = told.front().lines;
    const std::vector<std::string>& theirs = told[r].lines;
    for (std::size_t k = 0; k < std::max(roots.size(), theirs.size()); ++k) {
      const std::string root = k < roots.size() ? roots[k] : std::string();
      const std::string their = k < theirs.size() ? theirs[k] : std::string();
      if (root != their) throw differs(r, their, root);
    }
  }
}

std::string size_and_places(const std::filesystem::path& file) try {
  std::error_code code;
  // Opening a named pipe would wait for somebody who writes to it.
  if (!std::filesystem::is_regular_file(file, code)) return {};
  return fmt::format("{} bytes, {}", std::filesystem::file_size(file), digest_of_places(file));
} catch (const std::exception&) {
  return {};
}

Error other_scan(const std::string& file, const std::string& what) {
  return input_error(file, what, "the same file at this path on every machine");
}

}  // namespace

void require_fit_for_ranks(const scene::Config& config) {
  if (config.around) throw not_on_ranks({}, "around: a whole object is built");
  if (config.unroll) throw not_on_ranks({}, "unroll: an unrolled object is built");
  for (const scene::FilterConfig& filter : config.filters) {
    if (!can_be_streamed(filter))
      throw not_on_ranks(filter.place,
                         "the filter '" + scene::filter_name(filter) + "' looks at many points at once and is applied");
  }
}

void require_points_for_ranks(const scene::Config& config, std::size_t faces) {
  if (faces == 0) return;
  throw not_on_ranks({config.scans.front().file.string(), 0, 0}, "a mesh is built");
}

void require_same_configuration(const scene::Config& config, const BuildOptions& options) {
  const Ranks& ranks = *options.ranks;
  const std::vector<Told> programs = gather_text(ranks, options.program + "\n");
  require_same_lines(programs, [&](std::size_t r, const std::string&, const std::string&) {
    return usage_error(rank_text(r, programs[r]) + " runs another program than rank 0",
                       "the same version of Sparsha on every machine");
  });
  std::string text = fmt::format("--only: {}\n--force: {}\n", options.grid_only ? "grid" : "", options.force);
  const std::vector<Told> configurations = gather_text(ranks, text + scene::to_yaml(config));
  require_same_lines(configurations, [&](std::size_t r, const std::string& theirs, const std::string& roots) {
    return usage_error(fmt::format("{} has another configuration than rank 0: {} where that has {}",
                                   rank_text(r, configurations[r]), quoted(theirs), quoted(roots)),
                       "the same configuration and options on every rank");
  });
  text.clear();
  for (const scene::ScanConfig& scan : config.scans) text += size_and_places(scan.file) + "\n";
  const std::vector<Told> files = gather_text(ranks, text);
  for (std::size_t r = 1; r < files.size(); ++r) {
    for (std::size_t s = 0; s < config.scans.size(); ++s) {
      const std::string &theirs = files[r].lines[s], &roots = files.front().lines[s];
      if (theirs.empty() || roots.empty() || theirs == roots) continue;
      throw other_scan(config.scans[s].file.string(),
                       fmt::format("{} has another file here than rank 0", rank_text(r, files[r])));
    }
  }
}

void require_same_scans(const Ranks& ranks, const std::vector<scene::ScanSource>& sources, std::uint64_t points,
                        std::uint64_t invalid) {
  std::string text;
  for (const scene::ScanSource& source : sources)
    text += fmt::format("{}\t{}\t{}\n", source.file.string(), source.sha256, source.points);
  text += fmt::format("\t{} points, {} invalid ones\n", points, invalid);
  const std::vector<Told> told = gather_text(ranks, text);
  require_same_lines(told, [&](std::size_t r, const std::string& theirs, const std::string& roots) {
    const auto file_of = [](const std::string& line) { return line.substr(0, line.find('\t')); };
    const std::string who = rank_text(r, told[r]);
    if (file_of(theirs) != file_of(roots)) {
      const std::string file = roots.empty() || file_of(roots).empty() ? file_of(theirs) : file_of(roots);
      return other_scan(file, who + " and rank 0 do not both take this scan: it repeats another one for one of them");
    }
    if (!file_of(roots).empty()) return other_scan(file_of(roots), who + " has another file here than rank 0");
    return other_scan(sources.front().file.string(),
                      fmt::format("{} finds other points in the scans than rank 0: {} where that finds {}", who,
                                  theirs.substr(theirs.find('\t') + 1), roots.substr(roots.find('\t') + 1)));
  });
}

}  // namespace sparsha::pipeline
