// Measured as peak resident sizes, stage by stage, of builds of 1 to 100 million points and of 1 to 64 million nodes,
// and rounded up.
#include "pipeline/outofcore/memory.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "base/error.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint64_t kProgram = 70'000'000;       // code, libraries, buffers
constexpr std::uint64_t kBeforeTiles = 50'000'000;   // of these what is there before points are measured, on disk
constexpr std::uint64_t kLeastProgram = 45'000'000;  // with the buffers of few points
constexpr std::uint64_t kRead = 30'000'000;          // while scans are looked at
constexpr std::uint64_t kLook = 66'000'000;          // while views of scans are tried
constexpr std::uint64_t kBuffered = 120;             // of these buffers, a point
constexpr std::uint64_t kLeastTilePoints = 100'000;
constexpr std::uint64_t kThread = 16'000'000;  // of what is left, so that those of a stage are no large part of it

// Bytes per point of a cloud in memory and what its projection sorts; filters need no more, but for voxels, for what
// sorts points into cells, and for the places of moved points.
constexpr std::uint64_t kPoint = 64;
constexpr std::uint64_t kAttribute = 4;
constexpr std::uint64_t kVoxel = 140;
constexpr std::uint64_t kVoxels = 2 * (kVoxel + kPoint);  // the table of voxels doubles as it grows
constexpr std::uint64_t kCells = 48;
constexpr std::uint64_t kMoved = 12;
constexpr std::uint64_t kFace = 56;
constexpr std::uint64_t kTrialFace = 36;  // more, while views of a mesh are tried

// Bytes a sampled node of which the cross-check keeps the error until the report is written.
constexpr double kNodeError = 12.0;

// Of those of a point in memory that are taken before anything is sorted: as it was read, and oriented.
constexpr std::uint64_t kOriented = 32;

// Bytes an item of a cross-check's sample, while it is drawn or measured.
constexpr std::uint64_t kSampledPoint = 48;
constexpr std::uint64_t kSampledNode = 32;

// Bytes of a place on a whole object's surface while its sides are told apart, more than points have anyway; of one
// that votes on the sides; and of a node of its box, whose layers become sheets.
constexpr double kChartPlace = 40.0;
constexpr double kSampledPlace = 120.0;
constexpr double kVote = 300.0, kMostVotes = 400e3;
constexpr double kBoxNode = 50.0;

// Bytes of a bin's start, which a tile has in memory, and of the points' bytes the part that they may take as well.
constexpr std::uint64_t kBin = 4;
constexpr std::uint64_t kTileNode = 9;  // with height and state of the tile's own node
constexpr std::uint64_t kOfTile = 5;

// Bytes per node.
constexpr double kHeights = 5.0;
constexpr double kColourSums = 40.0;
constexpr double kIntensitySums = 16.0;
constexpr double kFillScratch = 5.0;
constexpr double kCheckScratch = 2.0;
constexpr double kLayer = 4.0;
constexpr double kOpenCvScratch = 14.0;
constexpr double kFrictionScratch = 20.0;
constexpr double kAllLevels = 4.0 / 3.0;
constexpr double kPictures = 1.0;

double errors_per_node(const scene::CheckConfig& check, const scene::Lattice& lattice) {
  const double share = static_cast<double>(check.samples) / static_cast<double>(lattice.count());
  return check.samples > 0 ? kNodeError * std::min(1.0, share) : kNodeError;
}

double texture_scratch(const scene::TextureConfig& texture) {
  return texture.method == scene::TextureConfig::Method::opencv ? kOpenCvScratch : 0.0;
}

// Of meshes nothing less was measured.
std::uint64_t program_bytes(const ScanAmount& scans) {
  if (scans.faces > 0) return kProgram;
  return kLeastProgram + std::min(kProgram - kLeastProgram, kBuffered * scans.points);
}

// Of the nodes' bytes those that must have room in memory: where they lie on disk, what the threads of a stage touch
// before pages are dropped.
std::uint64_t resident_bytes(const MemoryLimit& limit, std::uint64_t node_bytes) {
  constexpr std::uint64_t kTouched = 32'000'000;
  return limit.nodes_on_disk ? std::min(node_bytes, kTouched) : node_bytes;
}

// Of the memory that is left beside the nodes, that for the points of a tile; the rest is for its bins and rows, which
// are no more than those of the whole grid, and spares nodes on disk the way from there.
std::uint64_t of_tiles(const MemoryLimit& limit, std::uint64_t left, const scene::Lattice& lattice) {
  const std::uint64_t rest = left / 10 * 3;
  return left - (limit.nodes_on_disk ? rest : std::min<std::uint64_t>(rest, kTileNode * lattice.count()));
}

// The rest beside so many bytes of points.
std::uint64_t beside_points(const MemoryLimit& limit, std::uint64_t bytes, const scene::Lattice& lattice) {
  const std::uint64_t rest = bytes / 7 * 3 + 10;
  return limit.nodes_on_disk ? rest : std::min<std::uint64_t>(rest, kTileNode * lattice.count());
}

bool sorts_into_cells(const scene::FilterConfig& filter) {
  return std::holds_alternative<scene::RadiusOutlierConfig>(filter) ||
         std::holds_alternative<scene::KeepConfig>(filter) || std::holds_alternative<scene::SmoothConfig>(filter) ||
         std::holds_alternative<scene::ThinConfig>(filter);
}

}  // namespace

unsigned threads_within(std::uint64_t bytes, unsigned threads) {
  if (bytes == 0) return threads;
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const std::uint64_t fit = (bytes - std::min(bytes, kProgram)) / kThread;
  const unsigned most = std::min(cores, static_cast<unsigned>(std::clamp<std::uint64_t>(fit, 1, 1024)));
  return threads == 0 ? most : std::min(threads, most);
}

void require_room_for_program(std::uint64_t bytes, bool looks) {
  const std::uint64_t least = looks ? kLook : kRead;
  if (bytes == 0 || bytes >= least) return;
  throw Error(ErrorKind::failure, {},
              fmt::format("a build needs at least about {} MB, more than the limit of {}", least / 1'000'000U,
                          amount_text(bytes)),
              "a higher --memory");
}

std::uint64_t enough_of(const MemoryLimit& limit, std::uint64_t bytes) {
  const std::uint64_t enough = std::max(bytes, limit.floor);
  return limit.in_memory > 0 ? std::min(enough, limit.in_memory) : enough;
}

ScanAmount amount_of(const ScanSet& scans) {
  const std::uint64_t attributes =
      scans.fields().size() + (scans.has_colour() ? 1U : 0U) + (scans.has_intensity() ? 1U : 0U);
  return {scans.points(), scans.faces(), attributes};
}

std::uint64_t bytes_in_memory(const ScanAmount& scans, const std::vector<scene::FilterConfig>& filters) {
  const auto any = [&](const auto& test) { return std::any_of(filters.begin(), filters.end(), test); };
  std::uint64_t a_point = kPoint + scans.attributes * kAttribute;
  const bool smooths = any([](const scene::FilterConfig& f) { return std::holds_alternative<scene::SmoothConfig>(f); });
  if (any([](const scene::FilterConfig& f) { return std::holds_alternative<scene::VoxelConfig>(f); })) {
    a_point += kVoxel;
  } else if (any(sorts_into_cells)) {
    a_point += kCells;
  }
  if (smooths) a_point += kMoved;
  return program_bytes(scans) + a_point * scans.points + kFace * scans.faces;
}

std::string amount_text(std::uint64_t bytes) {
  constexpr std::uint64_t kMegabyte = 1'000'000;
  return bytes < kMegabyte ? fmt::format("{} {}", bytes, bytes == 1 ? "byte" : "bytes")
                           : fmt::format("{} MB", bytes / kMegabyte);
}

std::uint64_t bytes_with_sides(const ScanAmount& scans, std::uint64_t side_bytes) {
  return program_bytes(scans) + (kOriented + scans.attributes * kAttribute) * scans.points + kFace * scans.faces +
         side_bytes;
}

void require_room_for_sides(const MemoryLimit& limit, std::uint64_t side_bytes) {
  if (limit.bytes == 0 || kBeforeTiles + side_bytes <= limit.bytes) return;
  const std::uint64_t needed = enough_of(limit, kBeforeTiles + side_bytes);
  throw Error(ErrorKind::failure, {},
              fmt::format("to tell the sides of this object apart takes about {} MB, more than the limit of {}",
                          needed / 1'000'000U + 1, amount_text(limit.bytes)),
              "a higher --memory or a voxel filter");
}

void require_room_on_disk(const MemoryLimit& limit) {
  if (limit.bytes == 0 || limit.bytes >= kProgram) return;
  throw Error(ErrorKind::failure, {},
              fmt::format("a build of so many points needs at least about {} MB, more than the limit of {}",
                          enough_of(limit, kProgram) / 1'000'000U + 1, amount_text(limit.bytes)),
              "a higher --memory");
}

std::uint64_t bytes_on_disk(const MemoryLimit& limit, std::uint64_t side_bytes, std::uint64_t node_bytes,
                            std::uint64_t bytes_per_point, std::uint64_t sample_bytes, const scene::Lattice& lattice) {
  return std::max({kBeforeTiles + side_bytes, kProgram + resident_bytes(limit, node_bytes) + sample_bytes,
                   bytes_with_tile(limit, kLeastTilePoints, bytes_per_point, lattice)});
}

bool may_fit(const MemoryLimit& limit, const ScanAmount& scans, const std::vector<scene::FilterConfig>& filters) {
  if (limit.points > 0 && scans.points > limit.points) return false;
  return limit.bytes == 0 || bytes_in_memory(scans, filters) <= limit.bytes;
}

Error refusal_of_mesh(const ScanAmount& scans, std::uint64_t bytes, bool with_grid) {
  return Error(ErrorKind::failure, {},
               fmt::format("{} points and {} faces need about {} MB {} the grid in memory, more than the limit, and "
                           "scans with faces are built in memory only",
                           scans.points, scans.faces, bytes / 1'000'000U + 1, with_grid ? "with" : "at least and"),
               "a higher --memory");
}

MeshRefusal mesh_refusal(const MemoryLimit& limit, const std::vector<scene::FilterConfig>& filters, std::size_t fields,
                         bool guessed) {
  if (limit.none()) return {};
  return [limit, filters, fields, guessed](std::uint64_t vertices, std::uint64_t triangles) -> std::optional<Error> {
    const std::uint64_t trials = guessed ? kTrialFace * triangles : 0U;
    const ScanAmount least{vertices, triangles, 0};
    if (may_fit(limit, least, filters) && (limit.bytes == 0 || bytes_in_memory(least, filters) + trials <= limit.bytes))
      return std::nullopt;
    constexpr std::size_t kMostAttributes = 2;  // colour and intensity, of which nobody knows yet
    const ScanAmount most{vertices, triangles, kMostAttributes + fields};
    return refusal_of_mesh(most, bytes_in_memory(most, filters) + trials, false);
  };
}

std::uint64_t points_to_keep(const MemoryLimit& limit, std::uint64_t most) {
  constexpr std::uint64_t kKept = 80;  // bytes, with what is looked for beside them
  if (limit.bytes == 0) return most;
  return std::min(most, (limit.bytes - std::min(limit.bytes, kProgram)) / kKept);
}

std::uint64_t bytes_of_nodes(const scene::Config& config, bool grid_only, bool colour, bool intensity,
                             const scene::Lattice& lattice) {
  double held = kHeights + (colour ? kLayer : 0.0) + (intensity ? kLayer : 0.0);
  double most = held + (colour ? kColourSums : 0.0) + (intensity ? kIntensitySums : 0.0);
  if (!grid_only) {
    if (config.fill) most = std::max(most, held + kFillScratch);
    const double errors = config.check ? errors_per_node(*config.check, lattice) : 0.0;
    if (config.check) most = std::max(most, held + kCheckScratch);
    if (config.texture) {
      held += kLayer;
      most = std::max(most, held + errors + texture_scratch(*config.texture));
      if (config.friction && config.friction->law != scene::FrictionConfig::Law::constant) {
        most = std::max(most, held + errors + kFrictionScratch);
        held += config.friction->law == scene::FrictionConfig::Law::paper ? 3 * kLayer : kLayer;
      }
    }
    most = std::max(most, kAllLevels * held + errors + kPictures);
  }
  return static_cast<std::uint64_t>(most * static_cast<double>(lattice.count()));
}

std::uint64_t bytes_of_charts(double places, double box_nodes, bool mesh) {
  constexpr double kMost = 9e18;
  const double a_place = kChartPlace + (mesh ? kSampledPlace : 0.0);
  return static_cast<std::uint64_t>(
      std::min(kMost, a_place * places + kVote * std::min(places, kMostVotes) + kBoxNode * box_nodes));
}

std::uint64_t bytes_of_sample(const scene::CheckConfig& check, std::uint64_t points, const scene::Lattice& lattice) {
  const std::uint64_t most =
      check.samples > 0 ? static_cast<std::uint64_t>(check.samples) : std::numeric_limits<std::uint64_t>::max();
  const auto nodes = static_cast<std::uint64_t>(lattice.count());
  return std::max(kSampledPoint * std::min(points, most), kSampledNode * std::min(nodes, most));
}

void require_room_for_sample(const MemoryLimit& limit, const scene::CheckConfig& check, std::uint64_t points,
                             std::uint64_t node_bytes, const scene::Lattice& lattice) {
  const std::uint64_t needed = kProgram + resident_bytes(limit, node_bytes) + bytes_of_sample(check, points, lattice);
  if (limit.bytes == 0 || needed <= limit.bytes) return;
  throw Error(ErrorKind::failure, {},
              fmt::format("the sample of the cross-check needs about {} MB with the grid, more than the limit of {}",
                          enough_of(limit, needed) / 1'000'000U + 1, amount_text(limit.bytes)),
              "fewer check.samples or a higher --memory");
}

std::uint64_t most_voxels(const MemoryLimit& limit) {
  std::uint64_t voxels = std::numeric_limits<std::uint32_t>::max();
  if (limit.bytes > 0) voxels = limit.bytes > kProgram ? (limit.bytes - kProgram) / kVoxels : 0;
  return limit.points > 0 ? std::min(voxels, limit.points) : voxels;
}

std::uint64_t bytes_of_voxels(std::uint64_t voxels) { return kProgram + kVoxels * voxels; }

bool nodes_fit(const MemoryLimit& limit, std::uint64_t node_bytes, std::uint64_t bytes_per_point,
               std::uint64_t sample_bytes, const scene::Lattice& lattice) {
  return limit.bytes == 0 || bytes_on_disk(limit, 0, node_bytes, bytes_per_point, sample_bytes, lattice) <= limit.bytes;
}

std::uint64_t bytes_with_tile(const MemoryLimit& limit, std::uint64_t points, std::uint64_t bytes_per_point,
                              const scene::Lattice& lattice) {
  const double heights = kHeights * static_cast<double>(lattice.count());
  return std::max(kProgram, kBeforeTiles + limit.beside) + resident_bytes(limit, static_cast<std::uint64_t>(heights)) +
         points * bytes_per_point +
         (points > kLeastTilePoints ? beside_points(limit, points * bytes_per_point, lattice) : 0U);
}

std::uint64_t points_of_a_tile(const MemoryLimit& limit, std::uint64_t node_bytes, std::uint64_t bytes_per_point,
                               std::uint64_t sample_bytes, const scene::Lattice& lattice) {
  std::uint64_t points = std::numeric_limits<std::uint32_t>::max();
  if (limit.bytes > 0) {
    const std::uint64_t nodes = resident_bytes(limit, node_bytes);
    const std::uint64_t least =
        std::max(kProgram + nodes, bytes_with_tile(limit, kLeastTilePoints, bytes_per_point, lattice));
    if (least > limit.bytes) {
      const std::uint64_t enough = enough_of(limit, std::max(least, kProgram + nodes + sample_bytes));
      throw Error(ErrorKind::failure, {},
                  fmt::format("the grid of {} x {} nodes and its layers need about {} MB, more than the limit of {}",
                              lattice.nx, lattice.ny, enough / 1'000'000U + 1, amount_text(limit.bytes)),
                  "a smaller grid.size, a larger grid.spacing_mm or a higher --memory");
    }
    const std::uint64_t all = limit.bytes - bytes_with_tile(limit, 0, bytes_per_point, lattice);
    const std::uint64_t left = std::max(of_tiles(limit, all, lattice), kLeastTilePoints * bytes_per_point);
    points = std::min(points, left / bytes_per_point);
  }
  return limit.points > 0 ? std::min(points, limit.points) : points;
}

std::uint64_t bins_beside(const MemoryLimit& limit, std::uint64_t points, std::uint64_t bytes_per_point) {
  if (limit.bytes == 0) return std::numeric_limits<std::uint64_t>::max();
  return points * bytes_per_point / kOfTile / kBin;
}

void require_room_likely(const MemoryLimit& limit, const scene::CheckConfig* check, std::uint64_t points,
                         std::uint64_t node_bytes, std::uint64_t bytes_per_point, const scene::Lattice& lattice) {
  constexpr std::uint64_t kMissing = 20;
  const std::uint64_t sample_bytes = check != nullptr ? bytes_of_sample(*check, points, lattice) : 0;
  const auto require_room = [&](std::uint64_t bytes) {
    (void)points_of_a_tile(limit, bytes, bytes_per_point, sample_bytes, lattice);
    if (check != nullptr) require_room_for_sample(limit, *check, points, bytes, lattice);
  };
  try {
    require_room(node_bytes - node_bytes / kMissing);
  } catch (const Error&) {
    require_room(node_bytes);  // names what is enough for all of them
  }
}

}  // namespace sparsha::pipeline
