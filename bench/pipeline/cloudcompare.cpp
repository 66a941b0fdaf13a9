// Command lines of CloudCompare 2.11, and readers of what it leaves beside its input.
#include "bench/pipeline/cloudcompare.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>

namespace sparsha::bench {
namespace {

namespace fs = std::filesystem;
constexpr const char* kProgram = "CloudCompare";

/// x y z of the binary float PLY that CloudCompare writes.
std::vector<Sample> read_raster_cloud(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  const std::size_t body = bytes.find("end_header\n");
  const std::size_t vertex = bytes.find("element vertex ");
  if (body == std::string::npos || vertex == std::string::npos) return {};
  const std::size_t count = std::stoul(bytes.substr(vertex + 15));
  std::size_t stride = 0;
  std::istringstream header(bytes.substr(0, body));
  for (std::string line; std::getline(header, line);) {
    if (line.rfind("property float ", 0) == 0) stride += 4;
    if (line.rfind("property double ", 0) == 0) return {};
    if (line.rfind("property uchar ", 0) == 0) stride += 1;
  }
  std::vector<Sample> samples;
  for (std::size_t k = 0; k < count; ++k) {
    float xyz[3];
    const std::size_t at = body + 11 + k * stride;
    if (at + sizeof(xyz) > bytes.size()) return {};
    std::memcpy(xyz, &bytes[at], sizeof(xyz));
    samples.push_back({static_cast<double>(xyz[0]), static_cast<double>(xyz[1]), static_cast<double>(xyz[2])});
  }
  return samples;
}

}  // namespace

std::optional<PeerRaster> cloudcompare_raster(const fs::path& scan, double spacing_m, const std::string& projection,
                                              bool clean) {
  if (!on_path(kProgram)) return std::nullopt;
  fs::path result = scan.parent_path() / (scan.stem().string() + (clean ? "_SOR_RASTER.ply" : "_RASTER.ply"));
  fs::remove(result);
  std::vector<std::string> command{kProgram,          "-SILENT",   "-C_EXPORT_FMT", "PLY",
                                   "-PLY_EXPORT_FMT", "BINARY_LE", "-NO_TIMESTAMP"};
  // Saving the cleaned cloud is not part of the work.
  if (clean) command.insert(command.end(), {"-AUTO_SAVE", "OFF"});
  command.insert(command.end(), {"-O", scan.string()});
  if (clean) command.insert(command.end(), {"-SOR", "30", "1.0", "-AUTO_SAVE", "ON"});
  command.insert(command.end(), {"-RASTERIZE", "-GRID_STEP", fmt::format("{}", spacing_m), "-VERT_DIR", "2", "-PROJ",
                                 projection, "-OUTPUT_CLOUD"});
  PeerRaster raster;
  raster.process = run_process(command);
  raster.samples = read_raster_cloud(result);
  fs::remove(result);
  if (raster.process.exit_code != 0 || raster.samples.empty()) return std::nullopt;
  return raster;
}

std::optional<PeerDistances> cloudcompare_distances(const fs::path& scan, const fs::path& mesh) {
  if (!on_path(kProgram)) return std::nullopt;
  const fs::path result = scan.parent_path() / (scan.stem().string() + "_C2M_DIST.asc");
  fs::remove(result);
  const ProcessResult process = run_process({kProgram, "-SILENT", "-C_EXPORT_FMT", "ASC", "-PREC", "9", "-NO_TIMESTAMP",
                                             "-O", scan.string(), "-O", mesh.string(), "-C2M_DIST"});
  std::ifstream stream(result);
  PeerDistances distances;
  double sum = 0.0, squares = 0.0;
  for (std::string line; std::getline(stream, line);) {
    // The distance is the last column.
    const double d = std::fabs(std::strtod(line.c_str() + line.find_last_of(' ') + 1, nullptr));
    sum += d;
    squares += d * d;
    ++distances.points;
  }
  fs::remove(result);
  if (process.exit_code != 0 || distances.points == 0) return std::nullopt;
  distances.mean_m = sum / static_cast<double>(distances.points);
  distances.rms_m = std::sqrt(squares / static_cast<double>(distances.points));
  return distances;
}

}  // namespace sparsha::bench
