// Each node is asked which way it faces as a disc is. Regions that face away count only where they lie behind their
// rim: on one sheet a doubt about sides costs no node.
#include "pipeline/projection/turned_away.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "pipeline/projection/simd/kernels.h"

namespace sparsha::pipeline {
namespace {

enum Facing : std::int8_t { kNothing, kTowards, kUnsure, kAway };

// dz per node to the neighbours on either side along one axis, of those that are on the same surface.
float slope_of(float before, float here, float after, float most_m) {
  float sum = 0.0F;
  int count = 0;
  for (const float rise : {here - before, after - here}) {
    if (!(std::abs(rise) <= most_m)) continue;  // unknown heights are NaN
    sum += rise;
    ++count;
  }
  return count == 0 ? 0.0F : sum / static_cast<float>(count);
}

// Which way the nodes of row j face.
void ask_row(const ProjectionPlan& plan, FacingField::Word word, const scene::DepthGrid& grid, std::size_t j,
             float most_m, Facing* facing) {
  const auto nx = static_cast<std::size_t>(grid.lattice.nx);
  const auto ny = static_cast<std::size_t>(grid.lattice.ny);
  const auto per_m = static_cast<float>(1.0 / plan.bins.spacing_m);
  std::vector<float> x(nx), y(nx), records(kDiscRecord * nx, 0.0F);
  const float* row = grid.height_m.data() + j * nx;
  const float* row_below = j > 0 ? row - nx : nullptr;
  const float* row_above = j + 1 < ny ? row + nx : nullptr;
  for (std::size_t i = 0; i < nx; ++i) {
    x[i] = static_cast<float>(plan.bins.x0_m + static_cast<double>(i) * plan.bins.spacing_m);
    y[i] = static_cast<float>(plan.bins.y0_m + static_cast<double>(j) * plan.bins.spacing_m);
    float* record = records.data() + kDiscRecord * i;
    record[2] = row[i];
    const float left = i > 0 ? row[i - 1] : scene::kUnknownHeight;
    const float right = i + 1 < nx ? row[i + 1] : scene::kUnknownHeight;
    const float below = row_below != nullptr ? row_below[i] : scene::kUnknownHeight;
    const float above = row_above != nullptr ? row_above[i] : scene::kUnknownHeight;
    record[3] = slope_of(left, row[i], right, most_m) * per_m;
    record[4] = slope_of(below, row[i], above, most_m) * per_m;
  }
  plan.facing->set_facing(word, x.data(), y.data(), records.data(), nx);
  for (std::size_t i = 0; i < nx; ++i) {
    const float faces = records[kDiscRecord * i + 7];
    facing[i] = grid.state[j * nx + i] != scene::NodeState::measured ? kNothing
                : faces > 0.0F                                       ? kTowards
                : faces < 0.0F                                       ? kAway
                                                                     : kUnsure;
  }
}

Facing side_of(std::uint8_t verdict) {
  constexpr unsigned kTurned = DiscNodeKernel::kAway | DiscNodeKernel::kEdge;
  if ((verdict & kTurned) != 0) return kAway;
  return (verdict & DiscNodeKernel::kUnsure) != 0 ? kUnsure : kTowards;
}

using Labels = std::vector<std::uint32_t>;  // of each node; 0 where there is nothing

// Labels, from 1 on, of pieces of nodes that touch and are linked(one, other).
template <typename Linked>
Labels label_pieces(const std::vector<Facing>& facing, std::size_t nx, const Linked& linked) {
  Labels labels(facing.size(), 0);
  std::uint32_t last = 0;
  std::vector<std::size_t> open;
  for (std::size_t first = 0; first < facing.size(); ++first) {
    if (facing[first] == kNothing || labels[first] != 0) continue;
    labels[first] = ++last;
    open.push_back(first);
    while (!open.empty()) {
      const std::size_t node = open.back();
      open.pop_back();
      const auto offer = [&](std::size_t beside) {
        if (facing[beside] == kNothing || labels[beside] != 0 || !linked(node, beside)) return;
        labels[beside] = last;
        open.push_back(beside);
      };
      if (node % nx > 0) offer(node - 1);
      if (node % nx + 1 < nx) offer(node + 1);
      if (node >= nx) offer(node - nx);
      if (node + nx < facing.size()) offer(node + nx);
    }
  }
  return labels;
}

// Of each node: in how many of the four directions the nearest node of another label is higher by more than a step,
// less in how many it is not. Where there is none, `none` is added.
std::vector<std::int8_t> look_around(const scene::DepthGrid& grid, const Labels& labels, float step_m, int none) {
  struct Line {
    std::uint32_t label = 0;
    float last_m = scene::kUnknownHeight,
          other_m = scene::kUnknownHeight;  // heights of the last node and of the last other label's
    void step(std::uint32_t to, float height_m) {
      if (to != label) other_m = last_m;
      label = to;
      last_m = height_m;
    }
  };
  const auto nx = static_cast<std::size_t>(grid.lattice.nx);
  std::vector<std::int8_t> behind(labels.size(), 0);
  for (const bool forward : {true, false}) {
    std::vector<Line> columns(nx);
    Line row;
    for (std::size_t k = 0; k < labels.size(); ++k) {
      const std::size_t node = forward ? k : labels.size() - 1 - k;
      if (k % nx == 0) row = {};
      if (labels[node] == 0) continue;
      for (Line* line : {&row, &columns[node % nx]}) {
        line->step(labels[node], grid.height_m[node]);
        const int vote = std::isnan(line->other_m) ? none : line->other_m - grid.height_m[node] > step_m ? 1 : -1;
        behind[node] = static_cast<std::int8_t>(behind[node] + vote);
      }
    }
  }
  return behind;
}

// Which pieces lie behind what is around them.
std::vector<bool> pieces_behind(const Labels& pieces, const std::vector<std::int8_t>& behind) {
  std::vector<std::int64_t> sum(*std::max_element(pieces.begin(), pieces.end()) + std::size_t{1}, 0);
  for (std::size_t node = 0; node < pieces.size(); ++node) sum[pieces[node]] += behind[node];
  std::vector<bool> result;
  for (const std::int64_t votes : sum) result.push_back(votes > 0);
  return result;
}

// Of each region, along rows and columns, whether most of its rim lies below what is next to it: the first known node
// beyond, a few unknown ones between them. A front that is taken for a back goes on into what faces the viewer.
std::vector<bool> regions_with_steps(const scene::DepthGrid& grid, const Labels& regions, const Labels& sides,
                                     float step_m) {
  constexpr std::ptrdiff_t kBetween = 4;     // nodes
  constexpr std::size_t kOf = 3, kMost = 2;  // two thirds
  struct Rim {
    std::size_t nodes = 0, below = 0;
  };
  std::vector<Rim> rims(*std::max_element(regions.begin(), regions.end()) + std::size_t{1});
  const auto nx = static_cast<std::ptrdiff_t>(grid.lattice.nx);
  const auto ny = static_cast<std::ptrdiff_t>(grid.lattice.ny);
  const auto walk = [&](std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t di, std::ptrdiff_t dj) {
    const auto node = static_cast<std::size_t>(j * nx + i);
    for (std::ptrdiff_t m = 1; m <= kBetween; ++m) {
      const std::ptrdiff_t a = i + m * di;
      const std::ptrdiff_t b = j + m * dj;
      if (a < 0 || b < 0 || a >= nx || b >= ny) return;
      const auto beside = static_cast<std::size_t>(b * nx + a);
      if (sides[beside] == 0) continue;
      if (sides[beside] == sides[node]) return;
      Rim& rim = rims[regions[node]];
      ++rim.nodes;
      rim.below += grid.height_m[beside] - grid.height_m[node] > step_m ? 1 : 0;
      return;
    }
  };
  for (std::ptrdiff_t j = 0; j < ny; ++j) {
    for (std::ptrdiff_t i = 0; i < nx; ++i) {
      if (sides[static_cast<std::size_t>(j * nx + i)] != 1) continue;
      walk(i, j, 1, 0);
      walk(i, j, -1, 0);
      walk(i, j, 0, 1);
      walk(i, j, 0, -1);
    }
  }
  std::vector<bool> result;
  for (const Rim& rim : rims) result.push_back(kOf * rim.below >= kMost * rim.nodes);
  return result;
}

// Who says that a node faces away, the surest last.
enum class Proof : std::uint8_t { views, closed_surface, stations };

// The regions of nodes that face away most of whose nodes pass a test.
template <typename Test>
std::vector<bool> regions_of_most(const Labels& regions, const std::vector<Facing>& facing, const Test& test) {
  std::vector<std::int64_t> sum(*std::max_element(regions.begin(), regions.end()) + std::size_t{1}, 0);
  for (std::size_t node = 0; node < facing.size(); ++node) {
    if (facing[node] == kAway) sum[regions[node]] += test(node) ? 1 : -1;
  }
  std::vector<bool> result;
  for (const std::int64_t votes : sum) result.push_back(votes > 0);
  return result;
}

// A region has to lie behind what is around it, unless stations know its side; if nothing but views say so, its rim
// must show steps. What is no more than an edge is left out in any case.
void leave_out_regions(float gap_m, const std::vector<Facing>& facing, const std::vector<std::uint8_t>& verdicts,
                       const std::vector<Proof>& proofs, Projection& projection) {
  scene::DepthGrid& grid = projection.grid;
  Labels sides(facing.size());
  for (std::size_t node = 0; node < facing.size(); ++node) {
    sides[node] = facing[node] == kNothing ? 0 : facing[node] == kAway ? 1 : 2;
  }
  const Labels regions = label_pieces(facing, static_cast<std::size_t>(grid.lattice.nx),
                                      [&](std::size_t a, std::size_t b) { return sides[a] == sides[b]; });
  const std::vector<bool> behind = pieces_behind(regions, look_around(grid, sides, gap_m, 0));
  const auto is_edge = [&](std::size_t node) {
    return !verdicts.empty() && (verdicts[node] & DiscNodeKernel::kEdge) != 0;
  };
  const std::vector<bool> edges = regions_of_most(regions, facing, is_edge);
  const auto of_proof = [&](Proof least) {
    return regions_of_most(regions, facing, [&](std::size_t node) { return proofs[node] >= least; });
  };
  const std::vector<bool> closed = of_proof(Proof::closed_surface);
  const std::vector<bool> told = of_proof(Proof::stations);
  const std::vector<bool> steps = regions_with_steps(grid, regions, sides, gap_m);
  for (std::size_t node = 0; node < facing.size(); ++node) {
    if (facing[node] != kAway) continue;
    const std::uint32_t region = regions[node];
    const bool from_behind = behind[region] && (closed[region] || steps[region]);
    if (!from_behind && !told[region] && !(edges[region] && is_edge(node))) continue;
    grid.height_m[node] = scene::kUnknownHeight;
    grid.state[node] = scene::NodeState::unknown;
    projection.nodes_turned_away += is_edge(node) ? 0 : 1;
  }
}

// Nodes of unknown side on smooth pieces of the surface that lie behind what surrounds them, as a back seen through a
// hole does.
std::uint64_t count_unsure(const ProjectionPlan& plan, const std::vector<Facing>& facing,
                           const scene::DepthGrid& grid) {
  const auto gap_m = static_cast<float>(plan.gap_m);
  const Labels pieces = label_pieces(
      facing, static_cast<std::size_t>(grid.lattice.nx),
      [&](std::size_t a, std::size_t b) { return std::abs(grid.height_m[a] - grid.height_m[b]) <= gap_m; });
  const float step_m = std::max(gap_m, static_cast<float>(0.5 * plan.layers_apart_m));
  const std::vector<bool> behind = pieces_behind(pieces, look_around(grid, pieces, step_m, -1));
  std::uint64_t count = 0;
  for (std::size_t node = 0; node < facing.size(); ++node) {
    count += facing[node] == kUnsure && behind[pieces[node]] ? 1 : 0;
  }
  return count;
}

}  // namespace

void leave_out_turned_away(const ProjectionPlan& plan, const std::vector<std::uint8_t>& verdicts, ThreadPool& pool,
                           Projection& projection) {
  if (!plan.facing) return;
  const scene::DepthGrid& grid = projection.grid;
  const auto nx = static_cast<std::size_t>(grid.lattice.nx);
  const auto ny = static_cast<std::size_t>(grid.lattice.ny);
  const auto gap_m = static_cast<float>(plan.gap_m);
  const float most_m = std::max(gap_m, static_cast<float>(2.0 * plan.bins.spacing_m));
  std::vector<Facing> facing(grid.height_m.size(), kNothing);
  const auto any = [&](Facing which) { return std::find(facing.begin(), facing.end(), which) != facing.end(); };
  const auto ask = [&](FacingField::Word word, std::vector<Facing>& answers) {
    pool.for_ranges(ny, 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) ask_row(plan, word, grid, j, most_m, answers.data() + j * nx);
    });
  };
  if (plan.discs) {
    for (std::size_t node = 0; node < facing.size(); ++node) {
      if (grid.state[node] == scene::NodeState::measured) facing[node] = side_of(verdicts[node]);
    }
    if (!any(kAway)) return;
    std::vector<Proof> proofs(facing.size(), Proof::views);
    std::vector<Facing> told(facing.size());
    for (const auto& [word, proof] : {std::pair{FacingField::Word::of_closed_surfaces, Proof::closed_surface},
                                      std::pair{FacingField::Word::of_stations, Proof::stations}}) {
      if (!plan.facing->has(word)) continue;
      ask(word, told);
      for (std::size_t node = 0; node < told.size(); ++node) {
        if (told[node] == kAway) proofs[node] = proof;
      }
    }
    leave_out_regions(gap_m, facing, verdicts, proofs, projection);
    return;
  }
  if (plan.facing->has(FacingField::Word::of_all)) {
    ask(FacingField::Word::of_all, facing);
  } else {
    for (std::size_t node = 0; node < facing.size(); ++node) {
      if (grid.state[node] == scene::NodeState::measured) facing[node] = kUnsure;
    }
  }
  if (any(kUnsure)) projection.nodes_unsure = count_unsure(plan, facing, grid);
  if (any(kAway)) leave_out_regions(gap_m, facing, {}, std::vector(facing.size(), Proof::closed_surface), projection);
}

}  // namespace sparsha::pipeline
