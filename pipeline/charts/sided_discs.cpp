// Discs and their sides are found in a frame that is turned by odd angles: a disc is told by its slopes, so one whose
// plane holds the frame's z axis would be lost, and faces of things that people make lie along axes.
#include "pipeline/charts/sided_discs.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "base/error.h"
#include "pipeline/charts/uneven_points.h"
#include "pipeline/projection/facing.h"
#include "pipeline/projection/plan.h"
#include "pipeline/projection/points.h"
#include "pipeline/projection/sampling.h"
#include "pipeline/projection/surface_statistics.h"

namespace sparsha::pipeline {
namespace {

constexpr double kLeastUpright = 1e-5;   // z of a disc's normal in the turned frame
constexpr double kSideSamples = 400000;  // points that votes on the sides are counted of
constexpr double kMostUndecided = 0.5;   // of the discs: then nothing tells the sides
constexpr float kOpposite = -0.7F;       // cosine of the normals of the two faces of a wall
constexpr double kBesideSpacings = 1.5;  // between a disc and the nearest of the opposite face, along the wall
constexpr int kAgreeing = 3;             // discs of an opposite face that tell a wall; fewer may be errors of noise
constexpr double kMostSparse = 0.15;     // of places whose points are twice as far apart as the median

Eigen::Matrix3d turned_frame() { return Eigen::Quaterniond(1.0, 0.3713, -0.2291, 0.5417).normalized().matrix(); }

Eigen::Matrix4d rotation(const Eigen::Matrix3d& turn) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = turn;
  return matrix;
}

Extent extent_of(const OrientedPoints& points, ThreadPool& pool) {
  PointTotals totals;
  totals.add(points);
  return supported_extent(
      totals, [&](const auto& use) { use(points); }, pool);
}

// The box of supported points in the grid frame: as seen along z, and along y.
void find_box(const RawPoints& raw, const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, ThreadPool& pool,
              SidedDiscs& result) {
  const Extent along_z = extent_of(orient_points(raw, cloud.origin_m, scan_to_grid, result.origin_m, pool), pool);
  Eigen::Matrix3d z_x_y = Eigen::Matrix3d::Zero();  // z, x, y become x, y, z
  z_x_y(0, 2) = z_x_y(1, 0) = z_x_y(2, 1) = 1.0;
  const Extent along_y = extent_of(
      orient_points(raw, cloud.origin_m, rotation(z_x_y) * scan_to_grid, z_x_y * result.origin_m, pool), pool);
  result.min_m = {along_z.xmin_m, along_z.ymin_m, along_y.xmin_m};
  result.max_m = {along_z.xmax_m, along_z.ymax_m, along_y.xmax_m};
}

DiscRule rule_of(const OrientedPieces& pieces, const Extent& extent, ThreadPool& pool, double& spacing_m) {
  const CloudStatistics sample = sample_cloud(pieces, extent, pool);
  const bool on_lines = sample.on_lines && sample.on_lines->surface_spacing_m > 0.0;
  const double about_m = on_lines ? sample.on_lines->surface_spacing_m : sample.in_space.surface_spacing_m;
  SurfaceStatistics surface;
  if (about_m > 0.0) surface = surface_statistics(pieces, extent, about_m, on_lines, pool);
  if (!(surface.spacing_m > 0.0) || !surface.flat) {
    throw input_error({}, "the points form no surface that can be seen from all sides",
                      "a surface of points, each with others around it, and noise below their distance");
  }
  if (surface.sparse_share > kMostSparse) throw UnevenPoints(surface.spacing_m);
  spacing_m = surface.spacing_m;
  DiscRule rule = disc_rule(surface, on_lines);
  rule.least_nz = kLeastUpright;
  return rule;
}

/// Discs as they were found, with unit normals that point outwards; zero where the side is not known.
struct Normals {
  explicit Normals(const TangentDiscs& discs, std::size_t rows, std::size_t row_length, ThreadPool& pool) {
    const std::size_t size = rows == 0 ? 0 : discs.start[rows * row_length - 1];
    normal.resize(size);
    pool.for_ranges(rows, 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        const std::uint32_t* start = discs.start.get() + row * row_length;
        for (std::uint32_t d = start[0]; d < start[row_length - 1]; ++d) {
          const float* record = discs.records.get() + kDiscRecord * d;
          const float upright = 1.0F / std::sqrt(1.0F + record[3] * record[3] + record[4] * record[4]);
          normal[d] = Eigen::Vector3f(-record[3], -record[4], 1.0F) * (record[7] * upright);
        }
      }
    });
  }
  std::vector<Eigen::Vector3f> normal;
};

/// What is opposite of a disc, nearer than a wall has to be thick.
enum Opposite : std::uint8_t { kNone, kSome, kAgreed };

// Discs of walls that are too thin: the opposite face lies so near behind them that neighbourhoods of points hold both
// faces. Where kAgreeing discs say so, it is agreed.
std::vector<std::uint8_t> thin_walls(const TangentDiscs& discs, const Normals& normals, double spacing_m,
                                     ThreadPool& pool) {
  const auto thin = static_cast<float>(SidedDiscs::kThinSpacings * spacing_m);
  const auto beside = static_cast<float>(kBesideSpacings * spacing_m);
  const auto columns = static_cast<std::size_t>(discs.columns.bins_x());
  const auto rows = static_cast<std::size_t>(discs.columns.bins_y());
  std::vector<std::uint8_t> flags(normals.normal.size(), 0);
  const auto place = [&](std::uint32_t d) {
    const float* record = discs.records.get() + kDiscRecord * d;
    return Eigen::Vector3f(record[0], record[1], record[2]);
  };
  pool.for_ranges(rows, 2, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      for (std::size_t column = 0; column < columns; ++column) {
        const std::uint32_t* start = discs.start.get() + row * (columns + 1) + column;
        for (std::uint32_t d = start[0]; d < start[1]; ++d) {
          const Eigen::Vector3f& normal = normals.normal[d];
          const Eigen::Vector3f foot = place(d);
          int opposite = 0;
          for (std::size_t j = row > 0 ? row - 1 : 0; j <= std::min(rows - 1, row + 1) && opposite < kAgreeing; ++j) {
            const std::uint32_t* other = discs.start.get() + j * (columns + 1);
            const std::uint32_t last = other[std::min(columns - 1, column + 1) + 1];
            for (std::uint32_t k = other[column > 0 ? column - 1 : 0]; k < last; ++k) {
              if (normal.dot(normals.normal[k]) > kOpposite) continue;
              const Eigen::Vector3f apart = place(k) - foot;
              const float behind = -normal.dot(apart);
              if (std::abs(behind) >= thin || (apart + behind * normal).squaredNorm() >= beside * beside) continue;
              if (++opposite == kAgreeing) break;
            }
          }
          flags[d] = opposite == 0 ? kNone : opposite < kAgreeing ? kSome : kAgreed;
        }
      }
    }
  });
  return flags;
}

/// What becomes of the discs of a row of columns.
struct RowCount {
  std::uint64_t kept = 0, outside = 0, undecided = 0, thin = 0, thin_agreed = 0;
};

// Discs whose sides are known, in the grid frame and inside the box, in the order of the columns.
void keep_sided(const TangentDiscs& found, const Eigen::Matrix3d& to_grid, ThreadPool& pool, SidedDiscs& result) {
  const Eigen::Matrix3f turn = to_grid.cast<float>();
  const double margin_m = DiscRule::kReach * result.rule.spacing_m;
  const Eigen::Array3f low = (result.min_m.array() - margin_m).cast<float>();
  const Eigen::Array3f high = (result.max_m.array() + margin_m).cast<float>();
  const auto row_length = static_cast<std::size_t>(found.columns.bins_x()) + 1;
  const auto rows = static_cast<std::size_t>(found.columns.bins_y());
  const Normals normals(found, rows, row_length, pool);
  const std::vector<std::uint8_t> thin = thin_walls(found, normals, result.point_spacing_m, pool);
  const auto foot_of = [&](std::uint32_t d) -> Eigen::Vector3f {
    const float* record = found.records.get() + kDiscRecord * d;
    return turn * Eigen::Vector3f(record[0], record[1], record[2]);
  };
  // The count that a disc belongs to.
  const auto count_of = [&](std::uint32_t d) -> std::uint64_t RowCount::* {
    const Eigen::Vector3f foot = foot_of(d);
    if (!((foot.array() >= low).all() && (foot.array() <= high).all())) return &RowCount::outside;
    if (found.records[kDiscRecord * d + 7] == 0.0F) return &RowCount::undecided;
    return thin[d] == kNone ? &RowCount::kept : thin[d] == kSome ? &RowCount::thin : &RowCount::thin_agreed;
  };
  std::vector<RowCount> counts(rows);
  pool.for_ranges(rows, 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const std::uint32_t* start = found.start.get() + row * row_length;
      for (std::uint32_t d = start[0]; d < start[row_length - 1]; ++d) ++(counts[row].*count_of(d));
    }
  });
  std::vector<std::size_t> first(rows + 1, 0);
  for (std::size_t row = 0; row < rows; ++row) {
    const RowCount& count = counts[row];
    first[row + 1] = first[row] + count.kept;
    result.outside += count.outside;
    result.undecided += count.undecided;
    result.thin += count.thin + count.thin_agreed;
    result.thin_agreed += count.thin_agreed;
  }
  result.count = first[rows];
  result.found = result.count + result.outside + result.undecided + result.thin;
  result.discs = make_buffer<SidedDisc>(result.count);
  pool.for_ranges(rows, 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      std::size_t to = first[row];
      const std::uint32_t* start = found.start.get() + row * row_length;
      for (std::uint32_t d = start[0]; d < start[row_length - 1]; ++d) {
        if (count_of(d) != &RowCount::kept) continue;
        const float* record = found.records.get() + kDiscRecord * d;
        const float upright = 1.0F / std::sqrt(1.0F + record[3] * record[3] + record[4] * record[4]);
        const Eigen::Vector3f foot = foot_of(d);
        const Eigen::Vector3f normal = turn * normals.normal[d];
        result.discs[to++] = {{foot.x(), foot.y(), foot.z()},
                              {normal.x(), normal.y(), normal.z()},
                              record[5] * upright * record[7],
                              record[6]};
      }
    }
  });
}

}  // namespace

SidedDiscs find_sided_discs(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const Context& context) {
  ThreadPool& pool = context.pool;
  const RawPoints raw = raw_points(cloud);
  if (raw.count == 0) throw input_error({}, "no points", "a surface of points");
  SidedDiscs result;
  result.origin_m = robust_origin(
      raw.count, [&](const auto& use) { use(raw); }, cloud.origin_m, scan_to_grid, pool);
  find_box(raw, cloud, scan_to_grid, pool, result);
  context.progress.throw_if_cancelled();

  const Eigen::Matrix3d turn = turned_frame();
  const Eigen::Matrix4d scan_to_turned = rotation(turn) * scan_to_grid;
  const Eigen::Vector3d turned_origin_m = turn * result.origin_m;
  const OrientedPoints points = orient_points(raw, cloud.origin_m, scan_to_turned, turned_origin_m, pool);
  const OrientedPieces pieces = [&](const auto& use) { use(points); };
  PointTotals totals;
  totals.add(points);
  const Extent extent = supported_extent(totals, pieces, pool);
  result.rule = rule_of(pieces, extent, pool, result.point_spacing_m);
  context.progress.throw_if_cancelled();

  BinLattice nodes;
  nodes.spacing_m = disc_column_m(result.rule);
  nodes.x0_m = extent.xmin_m;
  nodes.y0_m = extent.ymin_m;
  nodes.nx = static_cast<int>(extent.width_m() / nodes.spacing_m) + 2;
  nodes.ny = static_cast<int>(extent.height_m() / nodes.spacing_m) + 2;
  const BinLattice columns = disc_columns(nodes, result.rule);
  TangentDiscs found = find_discs(points, {}, columns, BinWindow::all(columns), result.rule, true, pool);
  context.progress.throw_if_cancelled();
  const FacingField sides(pieces, totals, extent, result.point_spacing_m, kSideSamples,
                          station_views({cloud.stations, scan_to_turned, turned_origin_m}, SideEvidence::whole),
                          SideEvidence::whole, pool);
  sides.set_facing(found, pool);
  result.mixed = find_mixed_faces(found, points, result.point_spacing_m, pool);
  context.progress.throw_if_cancelled();
  keep_sided(found, turn.transpose(), pool, result);
  if (static_cast<double>(result.undecided + result.thin) > kMostUndecided * static_cast<double>(result.found) &&
      result.thin > result.undecided) {
    throw input_error({}, "most of the object is a wall thinner than 2.3 point spacings: its sides are undecided",
                      "points nearer to each other than a third of the wall's thickness");
  }
  if (static_cast<double>(result.undecided) > kMostUndecided * static_cast<double>(result.found)) {
    throw input_error({}, "nothing tells which side of the surface is outside",
                      "a closed object, or scans that say where they were made from");
  }
  return result;
}

}  // namespace sparsha::pipeline
