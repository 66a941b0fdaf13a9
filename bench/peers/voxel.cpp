#include "bench/peers/voxel.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "bench/peers/triangle_tree.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

class Voxel : public Peer {
 public:
  Voxel(const haptics::MongeSurface& surface, const VoxelOptions& options) : band_m_(options.band_m) {
    const auto [low, high] = std::minmax_element(surface.height_m.begin(), surface.height_m.end());
    const double thick = static_cast<double>(*high) - static_cast<double>(*low) + 2.0 * band_m_;
    low_m_ = static_cast<double>(*low) - band_m_;
    const double volume = surface.width_m() * surface.depth_m() * thick;
    voxel_m_ = std::max(surface.lattice.spacing_m, std::cbrt(volume / static_cast<double>(options.most_voxels)));
    n_[0] = static_cast<int>(std::ceil(surface.width_m() / voxel_m_)) + 1;
    n_[1] = static_cast<int>(std::ceil(surface.depth_m() / voxel_m_)) + 1;
    n_[2] = static_cast<int>(std::ceil(thick / voxel_m_)) + 1;
    distance_m_.resize(static_cast<std::size_t>(n_[0]) * static_cast<std::size_t>(n_[1]) *
                       static_cast<std::size_t>(n_[2]));
    const TriangleTree tree(surface);
    for (int j = 0; j < n_[1]; ++j)
      for (int i = 0; i < n_[0]; ++i) fill_column(surface, tree, i, j);
  }
  void place(const Vector3d&) override {}
  Touched update(const Vector3d& hand) override {
    Touched touched;
    touched.proxy = hand;
    const Vector3d at = (hand - Vector3d(0.0, 0.0, low_m_)) / voxel_m_;
    int cell[3];
    double share[3];
    for (int axis = 0; axis < 3; ++axis) {
      if (!(at[axis] >= 0.0 && at[axis] <= n_[axis] - 1)) return touched;
      cell[axis] = std::min(static_cast<int>(at[axis]), n_[axis] - 2);
      share[axis] = at[axis] - cell[axis];
    }
    double distance = 0.0;
    Vector3d gradient = Vector3d::Zero();
    for (int corner = 0; corner < 8; ++corner) {
      double weight[3];
      double slope[3];
      for (int axis = 0; axis < 3; ++axis) {
        const bool upper = ((corner >> axis) & 1) != 0;
        weight[axis] = upper ? share[axis] : 1.0 - share[axis];
        slope[axis] = upper ? 1.0 : -1.0;
      }
      const double value =
          distance_m_[index(cell[0] + (corner & 1), cell[1] + ((corner >> 1) & 1), cell[2] + ((corner >> 2) & 1))];
      distance += value * weight[0] * weight[1] * weight[2];
      gradient += value * Vector3d(slope[0] * weight[1] * weight[2], weight[0] * slope[1] * weight[2],
                                   weight[0] * weight[1] * slope[2]);
    }
    const double steep = gradient.norm();
    touched.contact = distance < 0.0 && distance > -0.99 * band_m_ && steep > 0.0;
    if (touched.contact) {
      touched.force_m = gradient * (-distance / steep);
      touched.proxy += touched.force_m;
    }
    return touched;
  }
  [[nodiscard]] std::size_t bytes() const override { return distance_m_.size() * sizeof(float); }

 private:
  [[nodiscard]] std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(j) * static_cast<std::size_t>(n_[0]) + static_cast<std::size_t>(i)) *
               static_cast<std::size_t>(n_[2]) +
           static_cast<std::size_t>(k);
  }
  /// From below to above; a voxel is at most one voxel farther away than the one before.
  void fill_column(const haptics::MongeSurface& surface, const TriangleTree& tree, int i, int j) {
    const double x = std::min(i * voxel_m_, surface.width_m());
    const double y = std::min(j * voxel_m_, surface.depth_m());
    const double height = surface.height(x, y);
    double bound = band_m_;
    for (int k = 0; k < n_[2]; ++k) {
      const double z = low_m_ + k * voxel_m_;
      const double vertical = std::abs(z - height);
      const Eigen::Vector3d place(x, y, z);
      const double most = std::min({band_m_, vertical, bound});
      const auto nearest = tree.nearest(place, most);
      const double distance = nearest ? (*nearest - place).norm() : most;
      distance_m_[index(i, j, k)] = static_cast<float>(z < height ? -distance : distance);
      bound = distance + voxel_m_;
    }
  }

  double band_m_;
  double low_m_ = 0.0;
  double voxel_m_ = 0.0;
  int n_[3] = {};
  std::vector<float> distance_m_;
};

}  // namespace

PeerPointer make_voxel(const haptics::MongeSurface& surface, const VoxelOptions& options) {
  return std::make_unique<Voxel>(surface, options);
}

}  // namespace sparsha::bench
