// The raw cloud that is looked at before the depth scan, and what is set there for the scan. The app fills both in and
// carries out what is asked; the viewer knows nothing of how scans are read and built.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "scene/config/filters.h"
#include "scene/config/orientation.h"
#include "scene/config/scans.h"

namespace sparsha::viewer {

/// A run of points that lie together, in random order: each first part of it is an even sample.
struct PointBlock {
  std::uint32_t begin = 0;
  std::uint32_t count = 0;
  Eigen::Vector3f low = Eigen::Vector3f::Zero();
  Eigen::Vector3f high = Eigen::Vector3f::Zero();
};

/// Points of all scans in the scan frame, metres, relative to a double origin.
struct PointView {
  std::string title;
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint32_t> rgba;                        ///< 0xAABBGGRR, empty or one per point
  std::vector<float> intensity;                           ///< empty or one per point
  std::vector<std::uint8_t> station;                      ///< number of the scan; empty or one per point
  std::uint64_t total = 0;                                ///< in the scans; more than are here when a sample is shown
  bool z_up = false;                                      ///< by the custom of the scans' format; else y
  scene::LengthUnit unit = scene::LengthUnit::automatic;  ///< of all scans, when they have one in common
  double metres_per_unit = 1.0;                           ///< 0 when the scans' units differ

  // Filled in by arrange().
  std::vector<PointBlock> blocks;
  Eigen::Vector3f low = Eigen::Vector3f::Zero();  ///< bounds of the object without its strays, as `points`
  Eigen::Vector3f high = Eigen::Vector3f::Zero();
  double spacing_m = 0.0;  ///< typical distance of neighbouring points; 0 for fewer than two
};

/// Sorts the points into blocks and measures bounds and spacing. 10 million points take about 2 s; for a worker.
void arrange(PointView& view);

/// Points that come on top of a PointView where somebody looks closely. What is shown is never changed.
struct PointDetail {
  /// Arranged; origin and attributes are those of the view that they refine.
  std::vector<std::shared_ptr<const PointView>> parts;
  std::uint64_t points = 0;
  double spacing_m = 0.0;  ///< typical distance of all points in the picture that was asked for; 0: the view's own
  bool whole = false;      ///< the memory holds all that this picture asks for, and it is here
};

/// What the next depth scan is made with.
struct ScanSetup {
  Eigen::Matrix4d scan_to_grid = Eigen::Matrix4d::Identity();
  std::optional<scene::CropConfig> crop;
};

/// Small pictures of the object's sides, where its points leave open which of them is the front.
struct SidePictures {
  struct Side {
    std::string name;                                      ///< Front, Back, ...
    Eigen::Vector3d look_from = Eigen::Vector3d::UnitZ();  ///< scan frame
    Eigen::Vector3d up = Eigen::Vector3d::UnitY();
    std::vector<std::uint8_t> grey;  ///< side_px * side_px, rows from the top down; kNothing where nothing is
  };
  static constexpr std::uint8_t kNothing = 255;
  int side_px = 0;
  std::vector<Side> sides;
};

struct SplatView;

/// An Escape that was to stop work on the scans may come so long after its end; it does not leave the program then.
inline constexpr double kLateStop_s = 1.0;

/// How the work on the scans stands. What is numbered counts from 1 and is new when its number is.
struct OrientingStatus {
  std::uint64_t work = 0;                     ///< other scans have another number, and count anew what is numbered
  std::shared_ptr<const PointView> points;    ///< null until they are read
  std::shared_ptr<const PointDetail> detail;  ///< of `points`; null: none
  bool refining = false;                      ///< more detail is being read
  ScanSetup proposal;                         ///< to be taken over: the first view, or a face that was found
  std::uint64_t proposals = 0;
  std::shared_ptr<const SidePictures> sides;  ///< to choose the front from; null where it is not open
  double spacing_m = 0.0;                     ///< of the grid to come; 0: automatic
  std::uint64_t scattered = 0;                ///< points, about, that lie in space and make no surface
  bool busy = false;
  bool scanning = false;        ///< it is a depth scan that is being made
  bool can_save_scene = false;  ///< a depth scan has been made
  std::string stage;            ///< of the work
  double fraction = 0.0;        ///< of the stage, 0 to 1
  std::string note;             ///< for the visitor: what was found, or why something failed
  bool problem = false;         ///< the note says why something failed
  std::uint64_t notes = 0;
};

/// Calls return at once; their results come with status().
struct Orienting {
  std::function<std::string()> unavailable;  ///< empty, or why the scans cannot be looked at
  std::function<void()> open;                ///< reads the scans; once more does nothing
  std::function<OrientingStatus()> status;
  std::function<void(const SplatView&, const ScanSetup&)> look;  ///< what the picture shows now, whenever it changes
  std::function<void(scene::OrientationConfig::Face, const ScanSetup&)> find_face;
  std::function<void(scene::LengthUnit)> set_unit;  ///< of all scans; reads them again
  std::function<void(const ScanSetup&)> scan;       ///< the scene comes to Connections::scene
  std::function<void()> cancel;                     ///< what is being done
  std::function<void(const ScanSetup&)> save;       ///< writes a configuration; the note says where
  std::function<void()> save_scene;                 ///< keeps the last depth scan as a scene; the note says where
};

}  // namespace sparsha::viewer
