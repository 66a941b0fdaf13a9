// Which way discs face, by the samples of a FacingField around them. Included once for each instruction set.
#pragma once

#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/simd/vectors.h"

namespace {

using sparsha::pipeline::FacingKernel;

/// A place on a surface and the surface's normal there.
struct Facet {
  float x, y, z, normal_x, normal_y, normal_z;
};

/// Samples [begin, begin + 8) against a facet: squared distances, cosines of the normals, and which lanes are near, on
/// the same sheet and nearly parallel.
struct Beside {
  Floats distance2, cosine;
  Ints same;
};

SPARSHA_INLINE Beside beside(const FacingKernel& k, const Facet& f, std::size_t begin, std::size_t end) {
  const Floats dx = load(k.x + begin) - f.x;
  const Floats dy = load(k.y + begin) - f.y;
  const Floats dz = load(k.z + begin) - f.z;
  const Floats across = f.normal_x * dx + f.normal_y * dy + f.normal_z * dz;
  Beside b;
  b.distance2 = dx * dx + dy * dy + dz * dz;
  b.cosine = load(k.normal_x + begin) * f.normal_x + load(k.normal_y + begin) * f.normal_y +
             load(k.normal_z + begin) * f.normal_z;
  const auto lane_number = Ints{0, 1, 2, 3, 4, 5, 6, 7};
  b.same = (lane_number < static_cast<std::int32_t>(end - begin < kLanes ? end - begin : kLanes)) &
           (b.distance2 <= k.reach2) & (absolute(across) <= k.sheet_m) & (absolute(b.cosine) >= k.aligned);
  return b;
}

/// The rows of columns around a column, and the columns of each.
struct Around {
  std::size_t first_row, last_row, first_column, last_column;
};

SPARSHA_INLINE Around around(const FacingKernel& k, std::size_t row, std::size_t column) {
  return {row > 0 ? row - 1 : 0, row + 1 < k.rows ? row + 1 : k.rows - 1, column > 0 ? column - 1 : 0,
          column + 1 < k.columns ? column + 1 : k.columns - 1};
}

SPARSHA_APART std::size_t list_aligned(const FacingKernel& k, std::size_t row, std::size_t column, std::size_t sample,
                                       std::uint32_t* aligned, float* cosine) {
  const Facet f{k.x[sample], k.y[sample], k.z[sample], k.normal_x[sample], k.normal_y[sample], k.normal_z[sample]};
  const Around places = around(k, row, column);
  std::size_t count = 0;
  for (std::size_t j = places.first_row; j <= places.last_row; ++j) {
    const std::uint32_t* start = k.start + j * (k.columns + 1);
    const std::size_t end = start[places.last_column + 1];
    for (std::size_t p = start[places.first_column]; p < end; p += kLanes) {
      const Beside b = beside(k, f, p, end);
      const std::size_t more = write_lanes(lanes_of(b.same), static_cast<std::uint32_t>(p), aligned + count);
      float cosines[kLanes];
      store(cosines, b.cosine);
      for (std::size_t n = 0; n < more; ++n) cosine[count + n] = cosines[aligned[count + n] - p];
      count += more;
    }
  }
  return count;
}

// 1 towards the viewer, -1 away, 0 unsure: the mean vote of the samples beside the facet, the nearer the heavier.
SPARSHA_INLINE float facing_of(const FacingKernel& k, const Facet& f, std::size_t row, std::size_t column) {
  const Around places = around(k, row, column);
  Floats sum{};
  Floats weights{};
  for (std::size_t j = places.first_row; j <= places.last_row; ++j) {
    const std::uint32_t* start = k.start + j * (k.columns + 1);
    const std::size_t end = start[places.last_column + 1];
    for (std::size_t p = start[places.first_column]; p < end; p += kLanes) {
      const Beside b = beside(k, f, p, end);
      const Floats weight = masked(b.same, (1.0F - b.distance2 * (1.0F / k.reach2)) * b.cosine);
      sum += weight * load(k.votes + p);
      weights += absolute(weight);
    }
  }
  const float vote = total(sum);
  const float weight = total(weights);
  if (!(weight > 0.0F)) return 0.0F;
  return vote > k.sure * weight ? 1.0F : vote < -k.sure * weight ? -1.0F : 0.0F;
}

SPARSHA_APART void find_facing(const FacingKernel& k, const float* x, const float* y, float* records, std::size_t begin,
                               std::size_t end) {
  for (std::size_t d = begin; d < end; ++d) {
    const float u = (x[d] - k.x_shift_m) * k.per_m;
    const float v = (y[d] - k.y_shift_m) * k.per_m;
    if (!(u >= 0.0F && v >= 0.0F && u < static_cast<float>(k.columns) && v < static_cast<float>(k.rows))) continue;
    const auto column = static_cast<std::size_t>(u);
    const auto row = static_cast<std::size_t>(v);
    float* record = records + sparsha::pipeline::kDiscRecord * d;
    float facing = 1.0F;
    if (!(record[2] > k.away_top_m[row * k.columns + column])) {
      const float normal_z = 1.0F / __builtin_sqrtf(1.0F + record[3] * record[3] + record[4] * record[4]);
      const Facet facet{x[d], y[d], record[2], -record[3] * normal_z, -record[4] * normal_z, normal_z};
      facing = facing_of(k, facet, row, column);
    }
    record[7] = facing;
  }
}

}  // namespace
