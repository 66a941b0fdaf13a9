// Orientation: one affine in double, one rounding to float.
#include "pipeline/projection/points.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <mutex>

#include "base/numbers/statistics.h"
#include "pipeline/projection/simd/kernels.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kChunk = 1U << 13U;
constexpr std::size_t kSample = 4096;
constexpr float kLargest_m = 1e18F;  // squares still fit a float

// Row-major 3x4 affine: grid - origin = rows * (p, 1), p relative to the cloud's origin.
struct Affine {
  std::array<double, 12> rows;

  Affine(const Eigen::Matrix4d& a, const Eigen::Vector3d& cloud_origin, const Eigen::Vector3d& origin) {
    const Eigen::Vector3d moved = (a.topLeftCorner<3, 3>() * cloud_origin + a.topRightCorner<3, 1>()) - origin;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        rows[static_cast<std::size_t>(4 * row + column)] = a(row, column);
      }
      rows[static_cast<std::size_t>(4 * row + 3)] = moved[row];
    }
  }

  [[nodiscard]] std::array<double, 3> operator()(const float* p) const {
    std::array<double, 3> g{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double* row = rows.data() + 4 * axis;
      g[axis] = row[0] * static_cast<double>(p[0]) + row[1] * static_cast<double>(p[1]) +
                row[2] * static_cast<double>(p[2]) + row[3];
    }
    return g;
  }
};

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Box {
  std::array<float, 3> low{kInfinity, kInfinity, kInfinity};
  std::array<float, 3> high{-kInfinity, -kInfinity, -kInfinity};
};

// Moves points that do not fit far away; the box of the others.
Box put_aside(OrientedPoints& points, std::size_t begin, std::size_t end) {
  Box box;
  for (std::size_t k = begin; k < end; ++k) {
    const std::array<float, 3> p{points.x[k], points.y[k], points.z[k]};
    if (std::abs(p[0]) < kLargest_m && std::abs(p[1]) < kLargest_m && std::abs(p[2]) < kLargest_m) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] = std::min(box.low[axis], p[axis]);
        box.high[axis] = std::max(box.high[axis], p[axis]);
      }
    } else {
      points.x[k] = points.y[k] = points.z[k] = OrientedPoints::kFarAway;
    }
  }
  return box;
}

// The cloud's origin as the grid frame has it.
Eigen::Vector3d moved_origin(const Eigen::Vector3d& cloud_origin_m, const Eigen::Matrix4d& scan_to_grid) {
  return scan_to_grid.topLeftCorner<3, 3>() * cloud_origin_m + scan_to_grid.topRightCorner<3, 1>();
}

}  // namespace

std::vector<float> origin_sample(std::uint64_t count, const RawPieces& pieces, ThreadPool& pool) {
  std::vector<float> sample;
  for (std::uint64_t every = std::bit_floor(std::max<std::uint64_t>(1, count / kSample));; every /= 8) {
    const auto limit = static_cast<std::uint32_t>(0xffffffffULL / std::max<std::uint64_t>(1, every));
    std::mutex mutex;
    pieces([&](const RawPoints& raw) {
      pool.for_ranges(raw.count, kChunk, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t> drawn(end - begin);
        const float* piece = raw.xyz + begin * raw.stride;
        drawn.resize(fastest_kernels().draw(piece, raw.stride, end - begin, limit, drawn.data()));
        const std::lock_guard lock(mutex);
        for (const std::uint32_t k : drawn) {
          const float* point = piece + k * raw.stride;
          sample.insert(sample.end(), point, point + 3);
        }
      });
    });
    pieces.join(sample);
    // A cloud of few distinct points may leave a thin sample or none: take more of it.
    if (sample.size() / 3 >= std::min<std::uint64_t>(count, kSample / 8) || every <= 1) return sample;
    sample.clear();
  }
}

Eigen::Vector3d origin_of_sample(const std::vector<float>& sample, const Eigen::Vector3d& cloud_origin_m,
                                 const Eigen::Matrix4d& scan_to_grid) {
  Eigen::Vector3d scene = moved_origin(cloud_origin_m, scan_to_grid);
  if (sample.empty()) return scene;
  const Affine affine(scan_to_grid, cloud_origin_m, scene);
  std::array<std::vector<double>, 3> values;
  for (std::size_t k = 0; k < sample.size(); k += 3) {
    const std::array<double, 3> g = affine(sample.data() + k);
    for (std::size_t axis = 0; axis < 3; ++axis) values[axis].push_back(g[axis]);
  }
  return scene + Eigen::Vector3d(median(values[0]), median(values[1]), median(values[2]));
}

Eigen::Vector3d robust_origin(std::uint64_t count, const RawPieces& pieces, const Eigen::Vector3d& cloud_origin_m,
                              const Eigen::Matrix4d& scan_to_grid, ThreadPool& pool) {
  return origin_of_sample(origin_sample(count, pieces, pool), cloud_origin_m, scan_to_grid);
}

OrientedPoints orient_points(const RawPoints& raw, const Eigen::Vector3d& cloud_origin_m,
                             const Eigen::Matrix4d& scan_to_grid, const Eigen::Vector3d& origin_m, ThreadPool& pool,
                             MemoryStore* store) {
  OrientedPoints points;
  points.count = raw.count;
  points.origin_m = origin_m;
  const Affine affine(scan_to_grid, cloud_origin_m, points.origin_m);

  points.x = make_buffer<float>(raw.count, store);
  points.y = make_buffer<float>(raw.count, store);
  points.z = make_buffer<float>(raw.count, store);
  std::vector<Box> boxes((raw.count + kChunk - 1) / kChunk);
  pool.for_ranges(raw.count, kChunk, [&](std::size_t begin, std::size_t end) {
    Box box;
    fastest_kernels().orient(raw.xyz + begin * raw.stride, raw.stride, end - begin, affine.rows.data(),
                             points.x.get() + begin, points.y.get() + begin, points.z.get() + begin, box.low.data(),
                             box.high.data());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (box.low[axis] <= -kLargest_m || box.high[axis] >= kLargest_m) {
        box = put_aside(points, begin, end);
        break;
      }
    }
    boxes[begin / kChunk] = box;
  });
  Box all;
  for (const Box& box : boxes) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      all.low[axis] = std::min(all.low[axis], box.low[axis]);
      all.high[axis] = std::max(all.high[axis], box.high[axis]);
    }
  }
  points.min_m = Eigen::Array3f(all.low[0], all.low[1], all.low[2]);
  points.max_m = Eigen::Array3f(all.high[0], all.high[1], all.high[2]);
  return points;
}

}  // namespace sparsha::pipeline
