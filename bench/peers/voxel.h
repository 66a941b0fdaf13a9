// `voxel`: a signed distance field, trilinear between voxels; force = depth times gradient, without a proxy. W. A.
// McNeely, K. D. Puterbaugh, J. J. Troy, "Six degree-of-freedom haptic rendering using voxel sampling", SIGGRAPH 1999,
// with exact distances to the mesh in place of layers.
#pragma once

#include <cstddef>

#include "bench/peers/peer.h"

namespace sparsha::bench {

struct VoxelOptions {
  double band_m = 0.025;              ///< deeper than this there is no force
  std::size_t most_voxels = 1000000;  ///< voxels get larger than the grid's cells when there would be more
};

[[nodiscard]] PeerPointer make_voxel(const haptics::MongeSurface& surface, const VoxelOptions& options);

}  // namespace sparsha::bench
