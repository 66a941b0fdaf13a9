// Rows and columns are cut into runs of nodes of one surface; sums before each node give the mean of any of its nodes.
#include "viewer/surface/layer_blur.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace sparsha::viewer {
namespace {

/// Lines of `length` nodes, `along` apart in storage; neighbouring lines are `across` apart.
struct Axis {
  int lines, length;
  std::size_t along, across;
  std::uint8_t step_bit;
};

Axis rows_of(const scene::Lattice& lattice) {
  return {lattice.ny, lattice.nx, 1, static_cast<std::size_t>(lattice.nx), Joints::kStepX};
}
Axis columns_of(const scene::Lattice& lattice) {
  return {lattice.nx, lattice.ny, static_cast<std::size_t>(lattice.nx), 1, Joints::kStepY};
}

/// A node and the next one along an axis are known, and no depth step lies between them.
bool joined(const ReliefData& relief, std::size_t node, const Axis& axis) {
  return relief.known[node] != 0 && relief.known[node + axis.along] != 0 &&
         (relief.joints.step[node] & axis.step_bit) == 0;
}

/// Calls body(node, count) for each run of `count` joined nodes, of which `node` is the first.
template <typename Body>
void for_runs(const ReliefData& relief, const Axis& axis, const Body& body) {
  for (int line = 0; line < axis.lines; ++line) {
    const std::size_t start = static_cast<std::size_t>(line) * axis.across;
    const auto node = [&](int k) { return start + static_cast<std::size_t>(k) * axis.along; };
    for (int first = 0, end = 0; first < axis.length; first = end) {
      end = first + 1;
      while (end < axis.length && joined(relief, node(end - 1), axis)) ++end;
      if (relief.known[node(first)] != 0) body(node(first), end - first);
    }
  }
}

/// Replaces `values`, `count` of them, by their means; `before` is longer.
void average(std::vector<double>& values, int count, int radius, std::vector<double>& before) {
  const double base = values[0];  // keeps sums small
  for (std::size_t n = 0; n < static_cast<std::size_t>(count); ++n) before[n + 1] = before[n] + (values[n] - base);
  for (int k = 0; k < count; ++k) {
    const int reach = std::min({radius, k, count - 1 - k});
    const double sum = before[static_cast<std::size_t>(k + reach + 1)] - before[static_cast<std::size_t>(k - reach)];
    values[static_cast<std::size_t>(k)] = base + sum / (2 * reach + 1);
  }
}

void average_along(const ReliefData& relief, const Axis& axis, int radius, std::vector<float>& height_m) {
  std::vector<double> run(static_cast<std::size_t>(axis.length)), before(run.size() + 1);
  for_runs(relief, axis, [&](std::size_t first, int count) {
    const auto node = [&](std::size_t n) { return first + n * axis.along; };
    const auto nodes = static_cast<std::size_t>(count);
    for (std::size_t n = 0; n < nodes; ++n) run[n] = static_cast<double>(height_m[node(n)]);
    for (int pass = 0; pass < 2; ++pass) average(run, count, radius, before);
    for (std::size_t n = 0; n < nodes; ++n) height_m[node(n)] = static_cast<float>(run[n]);
  });
}

void add_bends(const ReliefData& relief, const Axis& axis, const std::vector<float>& height_m, int whole,
               std::vector<double>& sum) {
  for_runs(relief, axis, [&](std::size_t first, int count) {
    const int margin = std::min(whole, (count - 1) / 2);
    for (int k = 0; k < count; ++k) {
      const std::size_t own = first + static_cast<std::size_t>(k) * axis.along;
      const std::size_t n = first + static_cast<std::size_t>(std::clamp(k, margin, count - 1 - margin)) * axis.along;
      sum[own] += margin < 1 ? std::numeric_limits<double>::quiet_NaN()
                             : static_cast<double>(height_m[n - axis.along]) - 2.0 * static_cast<double>(height_m[n]) +
                                   static_cast<double>(height_m[n + axis.along]);
    }
  });
}

}  // namespace

std::vector<float> blur_on_layers(const ReliefData& relief, int radius) {
  std::vector<float> height_m = relief.height_m;
  if (radius < 1) return height_m;
  average_along(relief, rows_of(relief.lattice), radius, height_m);
  average_along(relief, columns_of(relief.lattice), radius, height_m);
  return height_m;
}

std::vector<double> laplacian_on_layers(const ReliefData& relief, int radius) {
  const std::vector<float> height_m = blur_on_layers(relief, radius);
  std::vector<double> sum(relief.lattice.count(), 0.0);
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (relief.known[k] == 0) sum[k] = std::numeric_limits<double>::quiet_NaN();
  const int whole = 2 * radius + 1;  // from here on, both neighbours have whole means of whole means
  add_bends(relief, rows_of(relief.lattice), height_m, whole, sum);
  add_bends(relief, columns_of(relief.lattice), height_m, whole, sum);
  return sum;
}

}  // namespace sparsha::viewer
