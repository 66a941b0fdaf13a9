// Pillars in order, outlines, notes.
#include "pipeline/build/pillar_regions.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace sparsha::pipeline {
namespace {

constexpr double kMajor = 4.0 / 3.0;  // thicker than the middle one of all
struct Note {
  const char* name;
  double ratio;  // to sa, just intonation
};
constexpr std::array<Note, 7> kScale = {{{"sa", 1.0},
                                         {"re", 9.0 / 8.0},
                                         {"ga", 5.0 / 4.0},
                                         {"ma", 4.0 / 3.0},
                                         {"pa", 3.0 / 2.0},
                                         {"dha", 5.0 / 3.0},
                                         {"ni", 15.0 / 8.0}}};
constexpr double kSa_hz = 240.0;
constexpr double kDecay_s = 1.2;

struct Seen {
  Eigen::Vector2d from_m, to_m;
  double radius_m = 0.0;
  [[nodiscard]] double x_m() const { return 0.5 * (from_m.x() + to_m.x()); }
};

/// Four corners around the axis and its ends; a square for a pillar that is looked at along its axis.
std::vector<std::array<double, 2>> outline(const Seen& pillar) {
  Eigen::Vector2d along = pillar.to_m - pillar.from_m;
  Eigen::Vector2d from = pillar.from_m;
  Eigen::Vector2d to = pillar.to_m;
  if (along.norm() < pillar.radius_m) {
    const Eigen::Vector2d middle = 0.5 * (from + to);
    along = Eigen::Vector2d(0.0, pillar.radius_m);
    from = middle - along;
    to = middle + along;
  }
  const Eigen::Vector2d side = pillar.radius_m * Eigen::Vector2d(-along.y(), along.x()).normalized();
  std::vector<std::array<double, 2>> corners;
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(from + side), Eigen::Vector2d(from - side),
                                        Eigen::Vector2d(to - side), Eigen::Vector2d(to + side)})
    corners.push_back({corner.x(), corner.y()});
  return corners;
}

std::vector<Seen> in_order(const std::vector<Pillar>& pillars, const Eigen::Matrix4d& scan_to_grid, bool& has_major) {
  const double scale = std::cbrt(std::abs(scan_to_grid.topLeftCorner<3, 3>().determinant()));
  const auto in_view = [&](const Eigen::Vector3d& scan_m) {
    return Eigen::Vector2d(scan_to_grid.topLeftCorner<2, 3>() * scan_m + scan_to_grid.topRightCorner<2, 1>());
  };
  std::vector<Seen> seen;
  for (const Pillar& pillar : pillars)
    seen.push_back({in_view(pillar.from_m), in_view(pillar.to_m), scale * pillar.radius_m});
  has_major = false;
  if (seen.empty()) return seen;
  std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.radius_m > b.radius_m; });
  has_major = seen.size() > 1 && seen.front().radius_m > kMajor * seen[(seen.size() + 1) / 2].radius_m;
  std::sort(seen.begin() + (has_major ? 1 : 0), seen.end(),
            [](const Seen& a, const Seen& b) { return a.x_m() < b.x_m(); });
  return seen;
}

std::vector<scene::AudioRegionConfig> scale_for(std::size_t count, bool has_major) {
  std::vector<scene::AudioRegionConfig> notes;
  for (std::size_t k = 0; k < count; ++k) {
    scene::AudioRegionConfig region;
    const bool major = has_major && k == 0;
    const std::size_t step = k - (has_major ? 1 : 0);
    const Note& note = kScale[major ? 0 : step % kScale.size()];
    const double octave = major ? 0.5 : std::exp2(static_cast<double>(step / kScale.size()));
    region.name = major ? "major" : note.name;
    region.sound =
        scene::ModalConfig{std::min(octave * kSa_hz * note.ratio, 4000.0), major ? 2.0 * kDecay_s : kDecay_s, {}};
    notes.push_back(region);
  }
  return notes;
}

}  // namespace

void place_on_pillars(scene::AudioConfig& audio, const std::vector<Pillar>& pillars,
                      const Eigen::Matrix4d& scan_to_grid, Progress& progress) {
  audio.find_pillars = false;
  bool has_major = false;
  const std::vector<Seen> seen = in_order(pillars, scan_to_grid, has_major);
  const auto homeless = [](const scene::AudioRegionConfig& region) { return !region.has_place(); };
  const auto wanted = static_cast<std::size_t>(std::count_if(audio.regions.begin(), audio.regions.end(), homeless));
  if (wanted == 0) {
    const std::vector<scene::AudioRegionConfig> notes = scale_for(seen.size(), has_major);
    audio.regions.insert(audio.regions.end(), notes.begin(), notes.end());
  }
  std::size_t next = 0;
  for (scene::AudioRegionConfig& region : audio.regions)
    if (homeless(region) && next < seen.size()) region.polygon_m = outline(seen[next++]);
  for (const scene::AudioRegionConfig& region : audio.regions)
    if (homeless(region))
      progress.warn(fmt::format("audio region '{}' has no pillar: {} were found", region.name, seen.size()));
  std::erase_if(audio.regions, homeless);
  if (wanted == 0 && seen.empty()) progress.warn("audio: no pillars were found");
  if (wanted > 0 && next < seen.size())
    progress.warn(fmt::format("{} pillars were found, and {} regions to sound for them", seen.size(), wanted));
}

}  // namespace sparsha::pipeline
