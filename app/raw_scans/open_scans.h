// The scans that are open, and whether the scene under the hand was made from them.
#pragma once

#include <cstdint>
#include <memory>

#include "app/raw_scans/depth_scans.h"

namespace sparsha::app {

/// Scans dropped into the window are shown while another object is still touched; what is done to the touched scene
/// (a new depth scan, parts) concerns the open scans only where touched() says so.
class OpenScans {
 public:
  [[nodiscard]] DepthScans& shown() const { return *shown_; }
  [[nodiscard]] bool touched() const { return shown_->status().work == touched_; }

  /// Of all scans from now on: so many points are shown.
  void set_most_points(std::uint64_t most) { most_points_ = most; }
  /// Other scans to look at; the touched scene stays.
  void show(std::unique_ptr<DepthScans> scans);
  /// The touched scene is now one of the shown scans.
  void touch();
  /// Another scene is touched, and these are its scans.
  void touch(std::unique_ptr<DepthScans> scans);
  /// The scene of the last touch() is refused: the one before is touched again, and its scans are shown again unless
  /// the refused scene was a depth scan.
  void go_back();
  /// Once a round of the window, which shows or refuses a new scene in the same round: lets go of the scans before.
  void settle();

 private:
  std::unique_ptr<DepthScans> shown_, before_;
  std::uint64_t touched_ = 0, touched_before_ = 0;  ///< DepthScans::status().work
  std::uint64_t most_points_ = kMostPointsShown;
  int rounds_ = 0;  ///< since `before_` was left
};

}  // namespace sparsha::app
