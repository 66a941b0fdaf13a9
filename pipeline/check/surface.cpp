// A search goes down the pyramid, the nearer of four squares first: what is found there rules most of the others out.
#include "pipeline/check/surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace sparsha::pipeline {
namespace {

constexpr int kBlock = 4;  // cells along the side of the smallest squares
constexpr float kEmpty = std::numeric_limits<float>::infinity();

double outside(double value, double low, double high) { return std::max(std::max(low - value, value - high), 0.0); }

}  // namespace

SurfaceIndex::SurfaceIndex(const scene::DepthGrid& grid)
    : grid_(grid), spacing_(grid.lattice.spacing_m), per_spacing_(1 / spacing_) {
  const int nx = grid.lattice.nx, ny = grid.lattice.ny;
  if (nx < 2 || ny < 2) return;
  Level& blocks = levels_.emplace_back();
  blocks.nx = (nx - 2) / kBlock + 1;
  blocks.ny = (ny - 2) / kBlock + 1;
  blocks.side = kBlock;
  blocks.spans.reserve(static_cast<std::size_t>(blocks.nx) * static_cast<std::size_t>(blocks.ny));
  for (int j0 = 0; j0 + 1 < ny; j0 += kBlock)
    for (int i0 = 0; i0 + 1 < nx; i0 += kBlock) blocks.spans.push_back(span_of_block(i0, j0));
  while (levels_.back().spans.size() > 1) levels_.push_back(halved(levels_.back()));
}

SurfaceIndex::Span SurfaceIndex::span_of_block(int i0, int j0) const {
  const int nx = grid_.lattice.nx, ny = grid_.lattice.ny;
  float low = kEmpty, high = -kEmpty;
  for (int j = j0; j < std::min(j0 + kBlock, ny - 1); ++j)
    for (int i = i0; i < std::min(i0 + kBlock, nx - 1); ++i) {
      const float* z = grid_.height_m.data() + grid_.lattice.index(i, j);
      if (std::isnan(z[0] + z[1] + z[nx] + z[nx + 1])) continue;
      low = std::min({low, z[0], z[1], z[nx], z[nx + 1]});
      high = std::max({high, z[0], z[1], z[nx], z[nx + 1]});
    }
  if (low > high) return {kEmpty, -kEmpty};
  // Rounded outwards, so that the box holds what it bounds.
  return {std::nextafter(static_cast<float>(low * per_spacing_), -1e30F),
          std::nextafter(static_cast<float>(high * per_spacing_), 1e30F)};
}

/// Squares of twice the side.
SurfaceIndex::Level SurfaceIndex::halved(const Level& finer) {
  Level level;
  level.nx = (finer.nx + 1) / 2;
  level.ny = (finer.ny + 1) / 2;
  level.side = 2 * finer.side;
  level.spans.reserve(static_cast<std::size_t>(level.nx) * static_cast<std::size_t>(level.ny));
  for (int j = 0; j < level.ny; ++j)
    for (int i = 0; i < level.nx; ++i) {
      Span all{kEmpty, -kEmpty};
      for (int b = 2 * j; b < std::min(2 * j + 2, finer.ny); ++b)
        for (int a = 2 * i; a < std::min(2 * i + 2, finer.nx); ++a) {
          all.low = std::min(all.low, finer.at(a, b).low);
          all.high = std::max(all.high, finer.at(a, b).high);
        }
      level.spans.push_back(all);
    }
  return level;
}

void SurfaceIndex::offer_cell(int i, int j, const Place& p, Best& best, Closest closest) const {
  const int nx = grid_.lattice.nx;
  const float* heights = grid_.height_m.data() + grid_.lattice.index(i, j);
  const Patch patch{heights[0] * per_spacing_, heights[1] * per_spacing_, heights[nx] * per_spacing_,
                    heights[nx + 1] * per_spacing_};
  const double u = p.x - i, v = p.y - j, z = p.z;
  const double low = std::min(std::min(patch.z00, patch.z10), std::min(patch.z01, patch.z11));
  const double high = std::max(std::max(patch.z00, patch.z10), std::max(patch.z01, patch.z11));
  const double dx = outside(u, 0, 1), dy = outside(v, 0, 1), dz = outside(z, low, high);
  if (!(dx * dx + dy * dy + dz * dz < best.squared)) return;
  if (std::isnan(patch.z00 + patch.z10 + patch.z01 + patch.z11)) return;
  const PatchPoint nearest = closest(patch, u, v, z);
  if (nearest.squared_distance < best.squared) best = {nearest.squared_distance, nearest.side};
}

void SurfaceIndex::offer_block(int bi, int bj, const Place& p, Best& best) const {
  // The cell under the point, or nearest to that, decides most of the others.
  const int first_i = bi * kBlock, last_i = std::min(first_i + kBlock, grid_.lattice.nx - 1) - 1;
  const int first_j = bj * kBlock, last_j = std::min(first_j + kBlock, grid_.lattice.ny - 1) - 1;
  const auto within = [](double value, int low, int high) {
    return static_cast<int>(std::clamp(std::floor(value), static_cast<double>(low), static_cast<double>(high)));
  };
  const int ci = within(p.x, first_i, last_i), cj = within(p.y, first_j, last_j);
  offer_cell(ci, cj, p, best);
  const double reach = std::sqrt(best.squared);
  const int i0 = within(p.x - reach, first_i, last_i), i1 = within(p.x + reach, first_i, last_i);
  const int j0 = within(p.y - reach, first_j, last_j), j1 = within(p.y + reach, first_j, last_j);
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i)
      if (i != ci || j != cj) offer_cell(i, j, p, best);
}

/// Of the distance to a square's box; infinite where it is empty.
double SurfaceIndex::squared_to(const Level& level, int i, int j, const Place& p) {
  const Span& span = level.at(i, j);
  if (span.low > span.high) return std::numeric_limits<double>::infinity();
  const double dx = outside(p.x, i * level.side, (i + 1) * level.side),
               dy = outside(p.y, j * level.side, (j + 1) * level.side), dz = outside(p.z, span.low, span.high);
  return dx * dx + dy * dy + dz * dz;
}

void SurfaceIndex::offer_square(std::size_t level, int i, int j, const Place& p, Best& best) const {
  if (level == 0) return offer_block(i, j, p, best);
  const Level& finer = levels_[level - 1];
  struct Child {
    double squared;
    int i, j;
  };
  std::array<Child, 4> children{};
  std::size_t count = 0;
  for (int b = 2 * j; b < std::min(2 * j + 2, finer.ny); ++b)
    for (int a = 2 * i; a < std::min(2 * i + 2, finer.nx); ++a) {
      const Child child{squared_to(finer, a, b, p), a, b};
      if (!(child.squared < best.squared)) continue;
      std::size_t place = count++;
      for (; place > 0 && child.squared < children[place - 1].squared; --place) children[place] = children[place - 1];
      children[place] = child;
    }
  for (std::size_t k = 0; k < count && children[k].squared < best.squared; ++k)
    offer_square(level - 1, children[k].i, children[k].j, p, best);
}

SurfaceDistance SurfaceIndex::result(const Best& best) const {
  const double distance = std::sqrt(best.squared) * spacing_;
  return {distance, best.side < 0 ? -distance : distance};
}

SurfaceDistance SurfaceIndex::distance(double x_m, double y_m, double z_m) const {
  Best best{std::numeric_limits<double>::infinity(), 0};
  const Place p{x_m * per_spacing_, y_m * per_spacing_, z_m * per_spacing_};
  if (!levels_.empty() && std::isfinite(squared_to(levels_.back(), 0, 0, p)))
    offer_square(levels_.size() - 1, 0, 0, p, best);
  return result(best);
}

SurfaceDistance SurfaceIndex::distance_by_walking(double x_m, double y_m, double z_m, int max_rings) const {
  Best best{std::numeric_limits<double>::infinity(), 0};
  const int cells_x = grid_.lattice.nx - 1, cells_y = grid_.lattice.ny - 1;
  const double x = x_m * per_spacing_, y = y_m * per_spacing_, z = z_m * per_spacing_;
  if (cells_x < 1 || cells_y < 1) return result(best);
  const int ci = static_cast<int>(std::clamp(x, 0.0, cells_x - 1.0)),
            cj = static_cast<int>(std::clamp(y, 0.0, cells_y - 1.0));
  for (int ring = 0; ring <= max_rings; ++ring) {
    const double nearest = std::max(0, ring - 1);
    if (nearest * nearest >= best.squared) return result(best);
    for (int j = std::max(0, cj - ring); j <= std::min(cells_y - 1, cj + ring); ++j) {
      const bool whole_row = j == cj - ring || j == cj + ring;
      for (int i = ci - ring; i <= ci + ring; i += whole_row || ring == 0 ? 1 : 2 * ring)
        if (i >= 0 && i < cells_x) offer_cell(i, j, {x, y, z}, best, closest_on_patch_by_search);
    }
  }
  return result({std::numeric_limits<double>::infinity(), 0});
}

}  // namespace sparsha::pipeline
