// Directions from which a cloud nobody has described may be looked at, the likeliest first.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pipeline/orient/front.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/statistics.h"
#include "pipeline/suggest/floors.h"
#include "pipeline/suggest/inner_box.h"

namespace sparsha::pipeline {

/// What the scans show that tells a front.
struct SeenScans {
  std::vector<Eigen::Vector3d> points_m;             ///< an even sample of all scans
  std::vector<Eigen::Vector3d> triangles_m;          ///< places spread evenly over the triangles
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();  ///< sum of triangle area vectors
  double area = 0.0;                                 ///< sum of triangle areas
  Eigen::Vector3d stated = Eigen::Vector3d::Zero();  ///< sum of the points' stated normals, each of length 1
  double records = 0.0;                              ///< points of the scans without faces
  /// Of some points, with the place of the scanner that saw them, of which the points' order is proof.
  struct FromStation {
    Eigen::Vector3d point_m, place_m;
  };
  std::vector<FromStation> from_stations;
  bool z_up_format = false;          ///< formats whose z is up
  bool depth_camera_format = false;  ///< formats that depth cameras write in their own frame
  bool range_images = false;         ///< all scans are images of a camera in the origin
  bool rasters = false;              ///< all scans are grids of heights over x and y
  bool colours = false;              ///< some scan has more than one

  /// The scan of a file, or a sample of it.
  void look_at(const ScanStatistics& file, double metres);
  /// Keeps the points in the box.
  void crop(const scene::CropConfig& box);
  /// Takes away what is around the object.
  void take_away(const FloorsAndWalls& around);

 private:
  bool any_ = false;
};

struct View {
  Eigen::Vector3d look_from = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  std::string reason;
  bool evident = false;  ///< the points' own form tells this side, not custom
  bool above = false;    ///< of what stands: from above, which is seldom meant

  [[nodiscard]] bool oblique() const { return (look_from.array() != 0.0).count() > 1; }
};

/// What is known of the object's sides.
struct Sides {
  std::vector<View> views;                   ///< the guess, then others to try, each once
  std::optional<Standing> standing;          ///< of a solid object; else its sides are the scan's axes
  bool other_side = false;                   ///< what is flat may as well be seen from its other side
  bool open = false;                         ///< another side may as well be the front
  std::shared_ptr<const EvenPoints> object;  ///< where it is open: what pictures of the sides are made of
};

/// The guess, then the axes and both sides of the thinnest direction. `up` is the user's. There must be points.
[[nodiscard]] Sides sides_of(const SeenScans& seen, const std::optional<Eigen::Vector3d>& up);

}  // namespace sparsha::pipeline
