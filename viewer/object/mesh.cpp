// Level 0 comes from the sheets; a coarser level merges the vertices of a cube that face the same way, whatever sheet
// they are of, so that no level has cracks where sheets meet.
#include "viewer/object/mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "viewer/object/sheets.h"

namespace sparsha::viewer {
namespace {

constexpr std::size_t kFewVertices = 3000;
constexpr int kMostLevels = 10;
constexpr double kChunk = 32.0;  // spacings of the level along a chunk's side

std::uint64_t cube_of(const Eigen::Vector3f& place, double side) {
  constexpr std::int64_t kHalf = 1 << 18;
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell = static_cast<std::int64_t>(std::floor(static_cast<double>(place[axis]) / side)) + kHalf;
    key = key << 19U | static_cast<std::uint64_t>(std::clamp<std::int64_t>(cell, 0, 2 * kHalf - 1));
  }
  return key;
}

/// Which of the six axes a normal is nearest to.
std::uint64_t axis_of(const Eigen::Vector3f& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return static_cast<std::uint64_t>(2 * axis + (normal[axis] < 0.0F ? 1 : 0));
}

ObjectMesh finest(const std::vector<DrawnSheet>& sheets) {
  ObjectMesh mesh;
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> vertex;
  for (const DrawnSheet& sheet : sheets) {
    vertex.assign(sheet.node.size(), kNone);
    const auto up = static_cast<std::size_t>(sheet.nx);
    std::size_t drawn = 0;
    for (std::size_t k = 0; k < sheet.cell.size(); ++k) {
      if (sheet.cell[k] < 2) continue;
      for (const std::size_t c : {k, k + 1, k + up, k + up + 1}) vertex[c] = 0;
      ++drawn;
    }
    std::size_t moved = 0;
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i) {
        const std::size_t k = sheet.index(i, j);
        const bool met = sheet.node[k] == DrawnSheet::Node::met;
        if (vertex[k] != kNone) {
          vertex[k] = static_cast<std::uint32_t>(mesh.place.size());
          mesh.place.push_back(met ? sheet.moved[moved] : Eigen::Vector3f(sheet.place(i, j).cast<float>()));
          mesh.normal.emplace_back(sheet.normal(k).cast<float>());
          mesh.measured.push_back(sheet.node[k] == DrawnSheet::Node::measured);
          if (!sheet.texture_m.empty()) mesh.texture_m.push_back(sheet.texture_m[k]);
          if (!sheet.bend_per_m.empty()) mesh.bend_per_m.push_back(sheet.bend_per_m[k]);
          if (!sheet.colour_rgba.empty()) mesh.colour_rgba.push_back(sheet.colour_rgba[k]);
          if (!sheet.intensity.empty()) mesh.intensity.push_back(sheet.intensity[k]);
          if (!sheet.error_m.empty()) mesh.error_m.push_back(sheet.error_m[k]);
        }
        moved += met ? 1 : 0;
      }
    mesh.indices.reserve(mesh.indices.size() + 6 * drawn);
    for (std::size_t k = 0; k < sheet.cell.size(); ++k) {
      if (sheet.cell[k] < 2) continue;
      const std::uint32_t a = vertex[k], b = vertex[k + 1], c = vertex[k + up + 1], d = vertex[k + up];
      mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
    }
  }
  return mesh;
}

/// Sorts triangles by blocks of space.
void cut_into_chunks(ObjectMesh& mesh) {
  const std::size_t triangles = mesh.indices.size() / 3;
  std::unordered_map<std::uint64_t, std::uint32_t> number;
  std::vector<std::uint32_t> of(triangles);
  for (std::size_t t = 0; t < triangles; ++t) {
    const std::uint64_t key = cube_of(mesh.place[mesh.indices[3 * t]], kChunk * mesh.spacing);
    of[t] = number.try_emplace(key, static_cast<std::uint32_t>(number.size())).first->second;
  }
  mesh.chunks.assign(number.size(), {});
  for (const std::uint32_t c : of) mesh.chunks[c].count += 3;
  std::uint32_t first = 0;
  constexpr float kFar = std::numeric_limits<float>::max();
  for (ObjectMesh::Chunk& chunk : mesh.chunks) {
    chunk.first = first;
    first += std::exchange(chunk.count, 0U);
    chunk.low.setConstant(kFar);
    chunk.high.setConstant(-kFar);
  }
  std::vector<std::uint32_t> sorted(mesh.indices.size());
  for (std::size_t t = 0; t < triangles; ++t) {
    ObjectMesh::Chunk& chunk = mesh.chunks[of[t]];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t v = mesh.indices[3 * t + c];
      sorted[chunk.first + chunk.count++] = v;
      chunk.low = chunk.low.cwiseMin(mesh.place[v]);
      chunk.high = chunk.high.cwiseMax(mesh.place[v]);
    }
  }
  mesh.indices = std::move(sorted);
}

/// Merges vertices; the values of the light come later, with average().
ObjectMesh coarser_of(ObjectMesh& fine) {
  ObjectMesh coarse;
  coarse.spacing = 2.0 * fine.spacing;
  const std::size_t count = fine.place.size();
  fine.coarser.resize(count);
  std::unordered_map<std::uint64_t, std::uint32_t> number;
  number.reserve(count / 3);
  std::vector<float> members;
  for (std::size_t v = 0; v < count; ++v) {
    const std::uint64_t key = cube_of(fine.place[v], coarse.spacing) * 6 + axis_of(fine.normal[v]);
    const auto [found, added] = number.try_emplace(key, static_cast<std::uint32_t>(coarse.place.size()));
    const std::uint32_t w = fine.coarser[v] = found->second;
    if (added) {
      coarse.place.emplace_back(Eigen::Vector3f::Zero());
      coarse.normal.emplace_back(Eigen::Vector3f::Zero());
      members.push_back(0.0F);
    }
    coarse.place[w] += fine.place[v];
    coarse.normal[w] += fine.normal[v];
    members[w] += 1.0F;
  }
  for (std::size_t w = 0; w < coarse.place.size(); ++w) {
    coarse.place[w] /= members[w];
    coarse.normal[w].normalize();  // not zero: all members are within 55 degrees of one axis
  }
  coarse.indices.reserve(fine.indices.size() / 3);
  for (std::size_t t = 0; t + 2 < fine.indices.size(); t += 3) {
    const std::uint32_t a = fine.coarser[fine.indices[t]], b = fine.coarser[fine.indices[t + 1]],
                        c = fine.coarser[fine.indices[t + 2]];
    if (a != b && b != c && c != a) coarse.indices.insert(coarse.indices.end(), {a, b, c});
  }
  return coarse;
}

/// The mean of what `fine`'s vertices have, for the vertices that stand for them.
std::vector<float> average(const ObjectMesh& fine, const std::vector<float>& values, std::size_t count) {
  std::vector<float> sum(count, 0.0F), members(count, 0.0F);
  for (std::size_t v = 0; v < values.size(); ++v) {
    sum[fine.coarser[v]] += values[v];
    members[fine.coarser[v]] += 1.0F;
  }
  for (std::size_t w = 0; w < count; ++w) sum[w] /= std::max(members[w], 1.0F);
  return sum;
}

/// Calls use(a, b) for both ends of each triangle's sides.
template <typename Use>
void sides(const ObjectMesh& mesh, const Use& use) {
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3)
    for (std::size_t c = 0; c < 3; ++c) use(mesh.indices[t + c], mesh.indices[t + (c + 1) % 3]);
}

/// Each value becomes the mean of it and its neighbours', `times` times.
void smooth(const ObjectMesh& mesh, std::vector<float>& values, int times) {
  std::vector<float> weight(values.size(), 1.0F), sum;
  sides(mesh, [&](std::uint32_t a, std::uint32_t b) {
    weight[a] += 1.0F;
    weight[b] += 1.0F;
  });
  for (int round = 0; round < times; ++round) {
    sum = values;
    sides(mesh, [&](std::uint32_t a, std::uint32_t b) {
      sum[a] += values[b];
      sum[b] += values[a];
    });
    for (std::size_t v = 0; v < values.size(); ++v) values[v] = sum[v] / weight[v];
  }
}

/// The mean over a vertex's sides of the change of the normal along them.
std::vector<float> curvatures(const ObjectMesh& mesh) {
  std::vector<float> sum(mesh.place.size(), 0.0F), count(mesh.place.size(), 0.0F);
  sides(mesh, [&](std::uint32_t a, std::uint32_t b) {
    const Eigen::Vector3f way = mesh.place[b] - mesh.place[a];
    const float length2 = way.squaredNorm();
    if (!(length2 > 0.01F)) return;
    const float bend = (mesh.normal[b] - mesh.normal[a]).dot(way) / length2;
    for (const std::uint32_t v : {a, b}) {
      sum[v] += bend;
      count[v] += 1.0F;
    }
  });
  for (std::size_t v = 0; v < sum.size(); ++v) sum[v] /= std::max(count[v], 1.0F);
  return sum;
}

}  // namespace

std::vector<ObjectMesh> make_object_meshes(const scene::Charts& charts, ThreadPool& pool) {
  std::vector<ObjectMesh> levels;
  levels.push_back(finest(drawn_sheets(charts, pool)));
  if (levels.front().indices.empty()) return {};
  while (levels.back().place.size() > kFewVertices && static_cast<int>(levels.size()) < kMostLevels) {
    ObjectMesh next = coarser_of(levels.back());
    if (next.indices.empty()) {
      levels.back().coarser.clear();
      break;
    }
    levels.push_back(std::move(next));
  }
  pool.for_ranges(levels.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t l = begin; l < end; ++l) cut_into_chunks(levels[l]);
  });
  constexpr std::size_t kBlockers = 250'000;
  std::size_t blockers = 0;
  while (blockers + 1 < levels.size() && levels[blockers].place.size() > kBlockers) ++blockers;
  ObjectMesh& first = levels.front();
  first.sky = sky_over(first, levels[blockers], pool);
  smooth(first, first.sky, 4);
  // From the level where the vertices of all sheets are one, so that no border of a sheet stands out.
  if (levels.size() > 1) {
    std::vector<float> merged = curvatures(levels[1]);
    smooth(levels[1], merged, 1);
    first.curvature.resize(first.place.size());
    for (std::size_t v = 0; v < first.place.size(); ++v) first.curvature[v] = merged[first.coarser[v]];
  } else {
    first.curvature = curvatures(first);
  }
  smooth(first, first.curvature, 4);
  for (std::size_t l = 1; l < levels.size(); ++l) {
    levels[l].sky = average(levels[l - 1], levels[l - 1].sky, levels[l].place.size());
    levels[l].curvature = average(levels[l - 1], levels[l - 1].curvature, levels[l].place.size());
  }
  return levels;
}

}  // namespace sparsha::viewer
