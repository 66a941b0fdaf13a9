// A scene: what the pipeline makes and everybody else reads. Immutable, in memory or in a folder on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "scene/area/area.h"
#include "scene/charts.h"
#include "scene/check_map.h"
#include "scene/config/config.h"
#include "scene/depth_grid.h"
#include "scene/scene_fwd.h"

namespace sparsha::scene {

/// A scan the scene was made from, told by its bytes.
struct ScanSource {
  std::filesystem::path file;  ///< as configured; need not exist any more
  std::string sha256;
  std::uint64_t points = 0;
};

/// Everything in scene.yaml.
struct SceneDescription {
  Config config;  ///< resolved: automatic values replaced by the ones used
  Eigen::Matrix4d scan_from_grid = Eigen::Matrix4d::Identity();
  /// Of a scene that was scanned again from another side: its parts and sounds are written in another grid frame.
  std::optional<Eigen::Matrix4d> region_from_grid;
  std::vector<Lattice> levels;  ///< level L has spacing 2^L times level 0's; all share origin_m
  std::vector<ScanSource> sources;
  double noise_m = 0.0;       ///< estimated standard deviation of the scan's range noise
  double height_min_m = 0.0;  ///< of known nodes of level 0, grid frame
  double height_max_m = 0.0;
  /// law: curvature: mu_d = clamp(mu_0 + friction_c_m * k, 0, mu_max). 0 without a friction block.
  double friction_c_m = 0.0;
  /// The cross-check's distances; null without a check.
  std::shared_ptr<const CheckMap> check_map{};
  /// The whole object, in the grid frame; null without a block `around`.
  std::shared_ptr<const Charts> charts{};
  /// The label image where parts have labels, and where each part lies, in their order: made ready when a Scene is
  /// made of this description (make_areas() of scene/area/regions.h).
  std::shared_ptr<const LabelMap> label_map{};
  std::shared_ptr<const std::vector<Area>> part_areas{};
  bool has_envelope = false;
  bool has_curvature = false;         ///< k
  bool has_paper_curvatures = false;  ///< H and K
  bool has_colour = false;
  bool has_intensity = false;
};

/// Thread-safe for reading. Nodes outside the level come back unknown.
class Scene {
 public:
  virtual ~Scene() = default;
  [[nodiscard]] virtual const SceneDescription& description() const = 0;
  /// Nodes [i0, i0+nx) x [j0, j0+ny) of a level with all its layers; only the tiles that are needed are read from disk.
  /// The result's lattice origin is the window's. Throws Error{input} on unreadable tiles.
  [[nodiscard]] virtual Layers read(int level, int i0, int j0, int nx, int ny) const = 0;
  /// A whole level of a scene in memory, which costs no copy; null for a scene on disk.
  [[nodiscard]] virtual const Layers* in_memory(int /*level*/) const { return nullptr; }
  /// Folder on disk, empty for a scene in memory.
  [[nodiscard]] virtual std::filesystem::path folder() const = 0;

  [[nodiscard]] Layers read_level(int level) const;
};

/// A scene held in memory; levels[L] must match description.levels[L]. A range of heights of 0 to 0 is taken from level
/// 0. Throws Error{failure} when not, and Error{input} when parts have labels and the label image cannot be read.
[[nodiscard]] ScenePointer make_scene(SceneDescription description, std::vector<Layers> levels);

/// The same layers under another description of the same levels, e.g. with other parts. Throws Error{failure} when the
/// levels are others.
[[nodiscard]] ScenePointer with_description(ScenePointer scene, SceneDescription description);

/// True when both were made from the same scans, byte for byte; never when scans are unknown.
[[nodiscard]] bool same_scans(const SceneDescription& a, const SceneDescription& b);

/// True when both are of the same scans and the same levels: at most their labels differ.
[[nodiscard]] bool same_ground(const SceneDescription& a, const SceneDescription& b);

/// Opens a scene folder. Throws Error{input} with the file and what was expected; for Trust::own_folder also when a
/// clip or a layer lies outside the folder (absolute paths, "..", symbolic links). Scans are looked at when they are
/// read: require_own_scans().
[[nodiscard]] ScenePointer open_scene(const std::filesystem::path& folder, Trust trust = Trust::own_folder);

/// Writes scene.yaml and the layers (docs/formats.md) into an existing folder; audio clips are copied in.
/// The same scene gives the same bytes.
void write_scene(const Scene& scene, const std::filesystem::path& folder);

}  // namespace sparsha::scene
