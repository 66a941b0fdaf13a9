#include "pipeline/replica/replica.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/files/files.h"
#include "base/text/lower_case.h"
#include "pipeline/replica/braille.h"
#include "pipeline/replica/legibility.h"
#include "pipeline/replica/solid.h"
#include "scene/folder/heights.h"
#include "scene/ground/window_lattice.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

// Finer than a nozzle prints, coarser than a file can bear.
constexpr double kFinest_mm = 0.2;
constexpr double kCoarsest_mm = 0.45;
constexpr double kFlattest_mm = 3.0, kDeepest_mm = 15.0;  // without a wish
constexpr int kMostNodes = 2000;                          // along a side: 16 million triangles, 800 MB of STL
// Dots and cells as printed signs have them (ISO 17049).
constexpr double kDotHeight_mm = 0.5, kDotRadius_mm = 0.8, kDotGap_mm = 2.5, kCellGap_mm = 6.1, kLineGap_mm = 10.0;
constexpr double kMargin_mm = 6.0;
constexpr double kLongestStrip_mm = 2000.0;  // of Braille: as long as the largest relief

void require(bool good, const char* name, double value, const char* expected) {
  if (!good) throw Error(ErrorKind::usage, {}, fmt::format("{} cannot be {}", name, value), expected);
}

void check(const ReplicaOptions& options) {
  check_replica_size(options.longest_mm);
  if (options.depth_mm)
    require(*options.depth_mm >= 0.1 && *options.depth_mm <= 200.0, "--depth-mm", *options.depth_mm, "0.1 to 200");
  require(options.curve >= 0.1 && options.curve <= 10.0, "--curve", options.curve, "0.1 to 10");
  require(options.base_mm >= kLeastBase_mm && options.base_mm <= 50.0, "--base-mm", options.base_mm,
          "1.5 to 50: thinner plates bend and break");
}

int longer_side(const scene::Lattice& lattice) { return std::max(lattice.nx, lattice.ny); }

/// The finest level that a printer can still show and a file can bear, or the coarsest.
int level_for(const scene::SceneDescription& scene, double mm_per_m) {
  const auto too_fine = [&](const scene::Lattice& lattice) {
    return lattice.spacing_m * mm_per_m < kFinest_mm || longer_side(lattice) > kMostNodes;
  };
  int level = 0;
  const auto count = static_cast<int>(scene.levels.size());
  while (level + 1 < count && scene::has_cell(scene.levels[static_cast<std::size_t>(level) + 1]) &&
         too_fine(scene.levels[static_cast<std::size_t>(level)])) {
    ++level;
  }
  return level;
}

/// Every n-th node of both directions, so that a side has kMostNodes at most.
void thin(scene::DepthGrid& grid) {
  const scene::Lattice from = grid.lattice;
  const int step = (longer_side(from) - 2) / (kMostNodes - 1) + 1;
  if (step == 1) return;
  scene::DepthGrid thinned(
      scene::Lattice{(from.nx - 1) / step + 1, (from.ny - 1) / step + 1, from.spacing_m * step, from.origin_m});
  for (int j = 0; j < thinned.lattice.ny; ++j)
    for (int i = 0; i < thinned.lattice.nx; ++i) {
      const std::size_t to = thinned.lattice.index(i, j), at = from.index(i * step, j * step);
      thinned.height_m[to] = grid.height_m[at];
      thinned.state[to] = grid.state[at];
    }
  grid = std::move(thinned);
}

struct Relief {
  scene::Layers layers;
  double low_m = std::numeric_limits<double>::infinity();
  double high_m = -std::numeric_limits<double>::infinity();
  double unknown = 0.0;
};

Relief read_relief(const scene::Scene& scene, int level) {
  Relief relief;
  relief.layers = scene.read_level(level);
  thin(relief.layers.grid);
  const scene::DepthGrid& grid = relief.layers.grid;
  std::size_t unknown = 0;
  for (std::size_t n = 0; n < grid.height_m.size(); ++n) {
    if (grid.state[n] == scene::NodeState::unknown) {
      ++unknown;
      continue;
    }
    relief.low_m = std::min(relief.low_m, static_cast<double>(grid.height_m[n]));
    relief.high_m = std::max(relief.high_m, static_cast<double>(grid.height_m[n]));
  }
  if (!(relief.low_m <= relief.high_m))
    throw Error(ErrorKind::input, {}, "the scene has no known place", "a scene with measured nodes");
  relief.unknown = static_cast<double>(unknown) / static_cast<double>(grid.height_m.size());
  return relief;
}

/// A cap of a sphere above the plate.
void raise_dot(ReplicaPlate& plate, double x_mm, double y_mm, double base_mm) {
  const double ball = (kDotRadius_mm * kDotRadius_mm + kDotHeight_mm * kDotHeight_mm) / (2.0 * kDotHeight_mm);
  const int reach = static_cast<int>(std::ceil(kDotRadius_mm / plate.spacing_mm));
  const int ci = static_cast<int>(std::lround(x_mm / plate.spacing_mm));
  const int cj = static_cast<int>(std::lround(y_mm / plate.spacing_mm));
  for (int j = std::max(0, cj - reach); j <= std::min(plate.first_row - 1, cj + reach); ++j)
    for (int i = std::max(0, ci - reach); i <= std::min(plate.nx - 1, ci + reach); ++i) {
      const double r = std::hypot(i * plate.spacing_mm - x_mm, j * plate.spacing_mm - y_mm);
      if (r >= kDotRadius_mm) continue;
      const double z = base_mm + std::sqrt(ball * ball - r * r) - (ball - kDotHeight_mm);
      float& node = plate.height_mm[static_cast<std::size_t>(j) * static_cast<std::size_t>(plate.nx) +
                                    static_cast<std::size_t>(i)];
      node = std::max(node, static_cast<float>(z));
    }
}

/// Lines of cells for the parts' names, as wide as the plate.
std::vector<std::vector<BrailleCell>> braille_lines(const scene::SceneDescription& scene, double width_mm,
                                                    ReplicaReport& report) {
  std::vector<std::vector<BrailleCell>> lines;
  const double room_mm = width_mm - 2.0 * kMargin_mm;
  const auto most = room_mm < kCellGap_mm ? std::size_t{0} : static_cast<std::size_t>(room_mm / kCellGap_mm);
  bool incomplete = false;
  for (const scene::PartConfig& part : scene.config.parts) {
    const std::string& text = part.say.empty() ? part.name : part.say;
    const Braille braille = to_braille(text);
    incomplete = incomplete || !braille.complete;
    for (auto& line : wrap_braille(braille.cells, most)) lines.push_back(std::move(line));
    report.lines.push_back(text);
  }
  if (!scene.config.parts.empty() && most == 0)
    report.warnings.push_back("the plate is too narrow for Braille; print it larger");
  if (incomplete)
    report.warnings.push_back("some letters of the parts' names have no Braille here; install liblouis and its tables");
  return lines;
}

void write_braille(ReplicaPlate& plate, const std::vector<std::vector<BrailleCell>>& lines, double base_mm) {
  double y_mm = plate.first_row * plate.spacing_mm - kMargin_mm;  // of a line's upper dots
  for (const std::vector<BrailleCell>& line : lines) {
    double x_mm = kMargin_mm;
    for (const BrailleCell cell : line) {
      for (unsigned dot = 0; dot < 6; ++dot)
        if ((cell >> dot & 1U) != 0)
          raise_dot(plate, x_mm + (dot / 3) * kDotGap_mm, y_mm - (dot % 3) * kDotGap_mm, base_mm);
      x_mm += kCellGap_mm;
    }
    y_mm -= kLineGap_mm;
  }
}

/// The integral of the bilinear heights: half weights at the borders.
double volume_of(const ReplicaPlate& plate) {
  double sum = 0.0;
  for (int j = 0; j < plate.ny; ++j) {
    double row = 0.0;
    for (int i = 0; i < plate.nx; ++i)
      row += static_cast<double>(plate.at(i, j)) * (i == 0 || i == plate.nx - 1 ? 0.5 : 1.0);
    sum += row * (j == 0 || j == plate.ny - 1 ? 0.5 : 1.0);
  }
  return sum * plate.spacing_mm * plate.spacing_mm;
}

/// Bilinear heights between nodes, `fine` steps a cell, above the Braille.
void lay_relief(ReplicaPlate& plate, const scene::Lattice& lattice, int fine, const std::vector<float>& node_mm) {
  const auto node = [&](int i, int j) { return static_cast<double>(node_mm[lattice.index(i, j)]); };
  for (int y = 0; y < (lattice.ny - 1) * fine + 1; ++y) {
    const int j = std::min(y / fine, lattice.ny - 2);
    const double v = static_cast<double>(y - j * fine) / fine;
    for (int x = 0; x < plate.nx; ++x) {
      const int i = std::min(x / fine, lattice.nx - 2);
      const double u = static_cast<double>(x - i * fine) / fine;
      const double low = (1.0 - u) * node(i, j) + u * node(i + 1, j);
      const double high = (1.0 - u) * node(i, j + 1) + u * node(i + 1, j + 1);
      plate.height_mm[static_cast<std::size_t>(y + plate.first_row) * static_cast<std::size_t>(plate.nx) +
                      static_cast<std::size_t>(x)] = static_cast<float>((1.0 - v) * low + v * high);
    }
  }
}

}  // namespace

void check_replica_size(double longest_mm) {
  require(longest_mm >= 20.0 && longest_mm <= 2000.0, "--size-mm", longest_mm, "20 to 2000");
}

bool is_replica(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  return ending == ".stl" || ending == ".3mf";
}

std::filesystem::path legibility_file_of(const std::filesystem::path& file) {
  std::filesystem::path beside = file;
  return beside.replace_extension(".legibility.png");
}

ReplicaPlate make_replica(const scene::Scene& scene, const ReplicaOptions& options, ReplicaReport& report) {
  check(options);
  const scene::SceneDescription& description = scene.description();
  const scene::Lattice& finest = description.levels.at(0);
  const double longest_m = finest.spacing_m * (std::max(finest.nx, finest.ny) - 1);
  const double mm_per_m = options.longest_mm / longest_m;
  const int level = level_for(description, mm_per_m);
  const Relief relief = read_relief(scene, level);
  if (std::string doubt = scene::doubt_of_heights(relief.layers, level); !doubt.empty())
    report.warnings.push_back(std::move(doubt));
  const scene::Lattice& lattice = relief.layers.grid.lattice;
  if (!scene::has_cell(lattice)) {
    const double across_mm = mm_per_m * finest.spacing_m * (std::min(finest.nx, finest.ny) - 1);
    throw Error(ErrorKind::input, {},
                fmt::format("the strip is too narrow to print: {:.3g} mm wide where it is {:.0f} mm long", across_mm,
                            options.longest_mm),
                fmt::format("a scene whose sides differ less than {} times", kMostNodes));
  }

  const double true_mm = (relief.high_m - relief.low_m) * mm_per_m;
  const double depth_mm = options.depth_mm.value_or(std::clamp(true_mm, kFlattest_mm, kDeepest_mm));
  const double span_m = relief.high_m - relief.low_m;
  std::vector<float> node_mm(relief.layers.grid.height_m.size());
  for (std::size_t n = 0; n < node_mm.size(); ++n) {
    const bool known = relief.layers.grid.state[n] != scene::NodeState::unknown;
    const double share =
        known && span_m > 0.0 ? (static_cast<double>(relief.layers.grid.height_m[n]) - relief.low_m) / span_m : 0.0;
    node_mm[n] = static_cast<float>(options.base_mm + depth_mm * std::pow(std::clamp(share, 0.0, 1.0), options.curve));
  }

  const double spacing_mm = lattice.spacing_m * mm_per_m;
  const int most_fine = std::max(1, kMostNodes / longer_side(lattice));
  const int fine = std::clamp(static_cast<int>(std::ceil(spacing_mm / kCoarsest_mm - 1e-9)), 1, most_fine);
  ReplicaPlate plate;
  plate.spacing_mm = spacing_mm / fine;
  plate.nx = (lattice.nx - 1) * fine + 1;
  const auto lines =
      options.braille ? braille_lines(description, plate.width_mm(), report) : std::vector<std::vector<BrailleCell>>{};
  const double strip_mm =
      lines.empty() ? 0.0
                    : 2.0 * kMargin_mm + 2.0 * kDotGap_mm + (static_cast<double>(lines.size()) - 1.0) * kLineGap_mm;
  const std::string strip = fmt::format("the parts' names take {:.0f} mm of Braille below the relief", strip_mm);
  if (strip_mm > kLongestStrip_mm)
    throw Error(ErrorKind::usage, {}, strip, "a `say` of a few words for each part, a larger print, or --no-braille");
  if (strip_mm > options.longest_mm)
    report.warnings.push_back(strip + "; print it larger, or give each part a `say` of a few words");
  plate.first_row = static_cast<int>(std::ceil(strip_mm / plate.spacing_mm));
  plate.ny = plate.first_row + (lattice.ny - 1) * fine + 1;
  plate.height_mm.assign(static_cast<std::size_t>(plate.nx) * static_cast<std::size_t>(plate.ny),
                         static_cast<float>(options.base_mm));
  lay_relief(plate, lattice, fine, node_mm);
  write_braille(plate, lines, options.base_mm);

  report.width_mm = plate.width_mm();
  report.length_mm = plate.length_mm();
  report.thickness_mm = static_cast<double>(*std::max_element(plate.height_mm.begin(), plate.height_mm.end()));
  report.scale = 1e-3 * mm_per_m;
  report.raised = true_mm > 0.0 ? depth_mm / true_mm : 1.0;
  report.volume_mm3 = volume_of(plate);
  report.triangles = Solid(plate).triangles();
  report.unknown = relief.unknown;
  if (relief.unknown > 0.02)
    report.warnings.push_back(fmt::format("{:.0f} % of the relief was not measured and lies at the base; set `fill`",
                                          100.0 * relief.unknown));
  if (longer_side(finest) > kMostNodes && spacing_mm > kCoarsest_mm)
    report.warnings.push_back(fmt::format(
        "the print has nodes {:.2g} mm apart, the scene's would be {:.2g} mm apart: a replica has at most {} "
        "along a side; print it smaller, or in pieces",
        plate.spacing_mm, finest.spacing_m * mm_per_m, kMostNodes));
  else if (plate.spacing_mm > 2.0 * kCoarsest_mm)
    report.warnings.push_back("the scene is coarser than the print; Braille dots may not be legible");
  return plate;
}

ReplicaReport export_replica(const scene::Scene& scene, const std::filesystem::path& file,
                             const ReplicaOptions& options, Progress& progress) {
  ReplicaReport report;
  progress.begin("replica");
  const ReplicaPlate plate = make_replica(scene, options, report);
  AtomicPath target(file);
  const Solid solid(plate);
  const std::string shown = file.string();
  write_print_file(solid, target.temporary(), shown, progress);
  const std::filesystem::path picture = legibility_file_of(file);
  AtomicPath map(picture);
  write_legibility(plate, map.temporary(), report);
  if (report.crowded > 0.1)
    report.warnings.push_back(fmt::format(
        "{:.0f} % has grooves or ridges narrower than {:.0f} mm, which fingers run together; print it larger",
        100.0 * report.crowded, kLeastGap_mm));
  if (report.felt < 0.2)
    report.warnings.push_back(
        "most of it is smoother than fingers notice (0.5 mm); raise it with --depth-mm or --curve");
  target.commit();
  map.commit();
  progress.finish();
  return report;
}

}  // namespace sparsha::pipeline
