// The configuration's block `register`.
#pragma once

namespace sparsha::scene {

/// How `sparsha register` finds the poses of the scans; a build measures with it and moves nothing.
struct RegisterConfig {
  enum class Method { gicp, point_to_plane, icp };
  enum class Guess { poses, features };
  Method method = Method::gicp;
  Guess guess = Guess::poses;   ///< where alignment begins: the poses as given, or features of the scans alone
  double max_distance_m = 0.0;  ///< how far rough poses may put one place apart; 0 = 15 % of the longest side
  double voxel_m = 0.0;         ///< of the thinned points that are compared; 0 = at most 40 000 points a scan
  double min_overlap = 0.1;     ///< least share of a scan's points that a pair must have in common
};

}  // namespace sparsha::scene
