#include "pipeline/outofcore/crowding.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "pipeline/projection/projector.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {
namespace {

// Ends a projection once its lattice is known.
struct Known {};

Cloud cloud_of(const std::vector<Eigen::Vector3d>& sample_m) {
  Cloud cloud;
  cloud.origin_m = sample_m.front();
  cloud.resize_points(sample_m.size());
  for (std::size_t n = 0; n < sample_m.size(); ++n) {
    const Eigen::Vector3f p = (sample_m[n] - cloud.origin_m).cast<float>();
    std::copy_n(p.data(), 3, cloud.xyz1() + 4 * n);
  }
  return cloud;
}

/// Sampled points in the cells of a lattice, each about its node.
class Counts {
 public:
  Counts(const scene::Lattice& lattice, const std::vector<Eigen::Vector3d>& sample_m, const Eigen::Matrix4d& to_grid)
      : nx_(lattice.nx), ny_(lattice.ny), counts_(lattice.count(), 0) {
    for (const Eigen::Vector3d& p : sample_m) {
      const Eigen::Vector3d grid = (to_grid * p.homogeneous()).head<3>();
      const double u = std::round((grid.x() - lattice.origin_m.x()) / lattice.spacing_m);
      const double v = std::round((grid.y() - lattice.origin_m.y()) / lattice.spacing_m);
      if (!(u >= 0.0 && v >= 0.0 && u < nx_ && v < ny_)) continue;
      ++counts_[lattice.index(static_cast<int>(u), static_cast<int>(v))];
    }
  }

  /// The most in `beyond` cells to all sides of one.
  [[nodiscard]] std::uint64_t most(int beyond) const {
    std::vector<std::uint64_t> rows = sums(counts_, 1, static_cast<std::size_t>(nx_), nx_, ny_, beyond);
    rows = sums(rows, static_cast<std::size_t>(nx_), 1, ny_, nx_, beyond);
    return *std::max_element(rows.begin(), rows.end());
  }

 private:
  /// Sums of up to 2 * beyond + 1 neighbours along lines of `length`, `step` apart.
  static std::vector<std::uint64_t> sums(const std::vector<std::uint64_t>& values, std::size_t step,
                                         std::size_t next_line, int length, int lines, int beyond) {
    std::vector<std::uint64_t> result(values.size());
    for (int line = 0; line < lines; ++line) {
      const auto at = [&](int k) {
        return static_cast<std::size_t>(line) * next_line + static_cast<std::size_t>(k) * step;
      };
      std::uint64_t sum = 0;
      for (int k = 0; k < std::min(beyond, length); ++k) sum += values[at(k)];
      for (int k = 0; k < length; ++k) {
        if (k + beyond < length) sum += values[at(k + beyond)];
        if (k - beyond - 1 >= 0) sum -= values[at(k - beyond - 1)];
        result[at(k)] = sum;
      }
    }
    return result;
  }

  int nx_, ny_;
  std::vector<std::uint64_t> counts_;
};

}  // namespace

std::optional<SampledGrid> sampled_grid(const std::vector<Eigen::Vector3d>& sample_m,
                                        const Eigen::Matrix4d& scan_to_grid, const scene::GridConfig& config,
                                        double resolution_m, const Context& context) {
  if (!(config.size > 0 || config.spacing_m > 0.0) || sample_m.size() < 2) return std::nullopt;
  const Cloud cloud = cloud_of(sample_m);
  SampledGrid grid;
  try {
    (void)Projector(cloud, context.pool, false)
        .project(scan_to_grid, config, resolution_m, context,
                 {{}, [&](const scene::Lattice& lattice, const ProjectionNeeds& needs) {
                    grid = {lattice, needs};
                    throw Known();
                  }});
  } catch (const Known&) {
    return grid;
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {
    return std::nullopt;
  }
  return std::nullopt;
}

void require_room_about_nodes(const MemoryLimit& limit, const std::vector<Eigen::Vector3d>& sample_m,
                              std::uint64_t points, const Eigen::Matrix4d& scan_to_grid, const SampledGrid& grid) {
  // Cells that discs look beyond a node, at least, and at most where points are denser than nodes.
  constexpr int kNear = 4, kFar = 7;
  constexpr double kSigmas = 3.0;
  constexpr std::uint64_t kOfWindows = 56;  // bytes a point: crowded places are thinned
  if (limit.bytes == 0 || limit.points > 0 || grid.needs.bytes_per_point <= kOfWindows) return;
  const Counts counts(grid.lattice, sample_m, scan_to_grid);
  const auto of_all = [&](std::uint64_t sampled, double sigmas) {
    const double count = static_cast<double>(sampled) + sigmas * std::sqrt(static_cast<double>(sampled) + 1.0);
    const double share = std::clamp(count / static_cast<double>(sample_m.size()), 0.0, 1.0);
    return static_cast<std::uint64_t>(share * static_cast<double>(points));
  };
  const auto bytes_for = [&](std::uint64_t about) {
    return bytes_with_tile(limit, about, grid.needs.bytes_per_point, grid.lattice);
  };
  const std::uint64_t surely = of_all(counts.most(kNear), -kSigmas);
  if (bytes_for(surely) <= limit.bytes) return;
  const auto megabytes = [&](std::uint64_t about) { return enough_of(limit, bytes_for(about)) / 1'000'000U + 1; };
  const std::uint64_t least = megabytes(of_all(counts.most(kNear), 0.0));
  const std::uint64_t enough = megabytes(of_all(counts.most(kFar), kSigmas));
  throw Error(
      ErrorKind::failure, {},
      fmt::format("{} points and more lie about a single node of the grid, which need about {} MB at most and {} MB at "
                  "the least, more than the limit of {}",
                  surely, enough, least, amount_text(limit.bytes)),
      fmt::format("--memory {}MB, a finer grid or a voxel filter", enough));
}

}  // namespace sparsha::pipeline
