// What every renderer in the race is: built from the nodes of one grid, updated with the hand once per tick.
// Local frame of the grid, metres. Forces are per unit of stiffness, so that they are lengths.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include <Eigen/Core>

#include "haptics/surface/monge_surface.h"

namespace sparsha::bench {

/// What one update found.
struct Touched {
  Eigen::Vector3d proxy = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_m = Eigen::Vector3d::Zero();  ///< force over stiffness; zero without contact
  bool contact = false;
};

/// One method at one setting. Making it is its pre-processing.
class Peer {
 public:
  Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  virtual ~Peer() = default;
  /// Puts the proxy at `hand`, which is in free space.
  virtual void place(const Eigen::Vector3d& hand) = 0;
  [[nodiscard]] virtual Touched update(const Eigen::Vector3d& hand) = 0;
  /// Of what pre-processing made, its input included where it is kept.
  [[nodiscard]] virtual std::size_t bytes() const = 0;
};

using PeerPointer = std::unique_ptr<Peer>;

}  // namespace sparsha::bench
