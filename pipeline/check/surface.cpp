// The tree holds the centres of blocks of cells; a block that spans much height is cut into slices with a centre each,
// so that one radius bounds them all and a search by distance plus that radius misses no cell.
#include "pipeline/check/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sparsha::pipeline {
namespace {

constexpr int kBlock = 4;            // cells along a block's side
constexpr double kFirstReach = 1.0;  // spacings; most points are nearer to the surface than this
constexpr double kShared = 6.0;      // spacings by which a search reaches beyond its point's need, for the next points
constexpr std::size_t kSlicesPerBlock = 4;
constexpr double kRoundings = 4.0;  // epsilons of a coordinate: the tree's point, the asked one and their difference

double outside(double value, double low, double high) { return std::max(std::max(low - value, value - high), 0.0); }

}  // namespace

SurfaceIndex::SurfaceIndex(const scene::DepthGrid& grid)
    : grid_(grid), spacing_(grid.lattice.spacing_m), per_spacing_(1 / spacing_) {
  const int nx = grid.lattice.nx, ny = grid.lattice.ny;
  for (int j0 = 0; j0 + 1 < ny; j0 += kBlock)
    for (int i0 = 0; i0 + 1 < nx; i0 += kBlock) {
      float low = std::numeric_limits<float>::infinity(), high = -low;
      for (int j = j0; j < std::min(j0 + kBlock, ny - 1); ++j)
        for (int i = i0; i < std::min(i0 + kBlock, nx - 1); ++i) {
          const float* z = grid.height_m.data() + grid.lattice.index(i, j);
          if (std::isnan(z[0] + z[1] + z[nx] + z[nx + 1])) continue;
          low = std::min({low, z[0], z[1], z[nx], z[nx + 1]});
          high = std::max({high, z[0], z[1], z[nx], z[nx + 1]});
        }
      if (low > high) continue;
      // Rounded outwards, so that the box holds what it bounds.
      blocks_.push_back({i0, j0, std::nextafter(static_cast<float>(low * per_spacing_), -1e30F),
                         std::nextafter(static_cast<float>(high * per_spacing_), 1e30F)});
    }
  double slice = kBlock;
  const std::size_t limit = (blocks_.size() + 1) * kSlicesPerBlock;
  while (!cut_into_slices(slice, limit)) slice *= 2;
  double farthest = 0;  // spacings
  for (const float coordinate : slice_centres_)
    farthest = std::max(farthest, std::abs(static_cast<double>(coordinate)) * per_spacing_);
  // Half the diagonal of a slice, and the rounding of the tree's floats.
  bound_ = std::sqrt(2.0 * (kBlock / 2.0) * (kBlock / 2.0) + slice * slice / 4) * (1 + 1e-5) + 1e-4 +
           kRoundings * farthest * std::numeric_limits<float>::epsilon();
  tree_ = std::make_unique<PointTree>(slice_centres_);
  slice_centres_ = {};
}

/// Fills the slices' centres and their blocks; false when there would be more than `limit`.
bool SurfaceIndex::cut_into_slices(double slice, std::size_t limit) {
  slice_centres_.clear();
  block_of_slice_.clear();
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Block& block = blocks_[b];
    const double span = static_cast<double>(block.high) - block.low;
    const double slices = std::max(1.0, std::ceil(span / slice));
    if (slices + static_cast<double>(block_of_slice_.size()) > static_cast<double>(limit)) return false;
    for (double k = 0; k < slices; k += 1) {
      slice_centres_.push_back(static_cast<float>((block.i + kBlock / 2.0) * spacing_));
      slice_centres_.push_back(static_cast<float>((block.j + kBlock / 2.0) * spacing_));
      slice_centres_.push_back(static_cast<float>((block.low + (k + 0.5) * span / slices) * spacing_));
      block_of_slice_.push_back(static_cast<std::uint32_t>(b));
    }
  }
  return true;
}

void SurfaceIndex::offer_cell(int i, int j, double x, double y, double z, Best& best, Closest closest) const {
  const int nx = grid_.lattice.nx;
  const float* heights = grid_.height_m.data() + grid_.lattice.index(i, j);
  const Patch patch{heights[0] * per_spacing_, heights[1] * per_spacing_, heights[nx] * per_spacing_,
                    heights[nx + 1] * per_spacing_};
  const double u = x - i, v = y - j;
  const double low = std::min(std::min(patch.z00, patch.z10), std::min(patch.z01, patch.z11));
  const double high = std::max(std::max(patch.z00, patch.z10), std::max(patch.z01, patch.z11));
  const double dx = outside(u, 0, 1), dy = outside(v, 0, 1), dz = outside(z, low, high);
  if (!(dx * dx + dy * dy + dz * dz < best.squared)) return;
  if (std::isnan(patch.z00 + patch.z10 + patch.z01 + patch.z11)) return;
  const PatchPoint nearest = closest(patch, u, v, z);
  if (nearest.squared_distance < best.squared) best = {nearest.squared_distance, nearest.side};
}

void SurfaceIndex::offer_block(std::uint32_t index, double x, double y, double z, Best& best) const {
  const Block& block = blocks_[index];
  const double dx = outside(x, block.i, block.i + kBlock), dy = outside(y, block.j, block.j + kBlock),
               dz = outside(z, block.low, block.high);
  if (dx * dx + dy * dy + dz * dz >= best.squared) return;
  // The cell under the point, or nearest to that, decides most of the others.
  const int last_i = std::min(block.i + kBlock, grid_.lattice.nx - 1) - 1;
  const int last_j = std::min(block.j + kBlock, grid_.lattice.ny - 1) - 1;
  const auto within = [](double value, int low, int high) {
    return static_cast<int>(std::clamp(std::floor(value), static_cast<double>(low), static_cast<double>(high)));
  };
  const int ci = within(x, block.i, last_i), cj = within(y, block.j, last_j);
  offer_cell(ci, cj, x, y, z, best);
  const double reach = std::sqrt(best.squared);
  const int i0 = within(x - reach, block.i, last_i), i1 = within(x + reach, block.i, last_i);
  const int j0 = within(y - reach, block.j, last_j), j1 = within(y + reach, block.j, last_j);
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i)
      if (i != ci || j != cj) offer_cell(i, j, x, y, z, best);
}

SurfaceDistance SurfaceIndex::result(const Best& best) const {
  const double distance = std::sqrt(best.squared) * spacing_;
  return {distance, best.side < 0 ? -distance : distance};
}

/// Asks the tree for all blocks with a centre within `radius` spacings.
void SurfaceIndex::find_blocks(double x, double y, double z, double radius, Scratch& scratch) const {
  tree_->within(static_cast<float>(x * spacing_), static_cast<float>(y * spacing_), static_cast<float>(z * spacing_),
                radius * spacing_ * (1 + 1e-6), scratch.answer);
  scratch.blocks.clear();
  for (const int k : scratch.answer.index) scratch.blocks.push_back(block_of_slice_[static_cast<std::size_t>(k)]);
  // A tall block has several centres.
  std::sort(scratch.blocks.begin(), scratch.blocks.end());
  scratch.blocks.erase(std::unique(scratch.blocks.begin(), scratch.blocks.end()), scratch.blocks.end());
  scratch.x = x;
  scratch.y = y;
  scratch.z = z;
  scratch.radius = radius;
}

SurfaceDistance SurfaceIndex::distance(double x_m, double y_m, double z_m, Scratch& scratch) const {
  Best best{std::numeric_limits<double>::infinity(), 0};
  if (blocks_.empty()) return result(best);
  const double x = x_m * per_spacing_, y = y_m * per_spacing_, z = z_m * per_spacing_;
  // How far about this point the blocks at hand are complete.
  const auto complete = [&] { return scratch.radius - std::hypot(x - scratch.x, y - scratch.y, z - scratch.z); };
  if (complete() < bound_ + kFirstReach) find_blocks(x, y, z, bound_ + kFirstReach + kShared, scratch);
  if (scratch.blocks.empty()) {  // far from everything: the nearest centre's block gives a first bound
    PointTree::Answer& answer = scratch.answer;
    if (tree_->nearest(static_cast<float>(x_m), static_cast<float>(y_m), static_cast<float>(z_m), answer))
      offer_block(block_of_slice_[static_cast<std::size_t>(answer.index[0])], x, y, z, best);
  }
  // The block under the point first: it rules most of the others out.
  for (const std::uint32_t block : scratch.blocks)
    if (x >= blocks_[block].i && x < blocks_[block].i + kBlock && y >= blocks_[block].j &&
        y < blocks_[block].j + kBlock)
      offer_block(block, x, y, z, best);
  for (const std::uint32_t block : scratch.blocks) offer_block(block, x, y, z, best);
  if (const double needed = std::sqrt(best.squared) + bound_; needed > complete()) {
    find_blocks(x, y, z, needed, scratch);
    for (const std::uint32_t block : scratch.blocks) offer_block(block, x, y, z, best);
  }
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
        if (i >= 0 && i < cells_x) offer_cell(i, j, x, y, z, best, closest_on_patch_by_search);
    }
  }
  return result({std::numeric_limits<double>::infinity(), 0});
}

}  // namespace sparsha::pipeline
