// The work behind the raw cloud's window: reading, first view, faces, depth scans, saving. One thing at a time on a
// worker; the window asks and looks how it stands.
#pragma once

#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/raw_scans/point_reader.h"
#include "base/threads/progress.h"
#include "pipeline/build/build.h"
#include "pipeline/scan/cloud.h"
#include "scene/config/config.h"
#include "scene/scene_fwd.h"
#include "viewer/cloud/point_view.h"

namespace sparsha::app {

class DepthScans {
 public:
  /// Of scans for which no configuration exists yet: units, view and spacing are guessed when they are opened.
  explicit DepthScans(std::vector<std::filesystem::path> scans);
  /// Of a configuration that nothing has been built from yet. Throws Error{usage}.
  explicit DepthScans(std::filesystem::path config);
  /// Of a scene; `file` is the configuration it was built from, if any. Its scans are opened when they are asked for.
  DepthScans(scene::ScenePointer scene, std::filesystem::path file, scene::Trust trust);
  ~DepthScans();
  DepthScans(const DepthScans&) = delete;
  DepthScans& operator=(const DepthScans&) = delete;

  /// Empty, or why the scans cannot be looked at; looks at the files.
  [[nodiscard]] std::string unavailable() const;
  /// Before open(): so many points are shown; see kMostPointsShown.
  void set_most_points(std::uint64_t most) { most_points_ = most; }
  void open();
  /// What the picture shows now: its points of COPC files are read, as Refinement does.
  void look(const viewer::SplatView& view, const viewer::ScanSetup& setup);
  void find_face(scene::OrientationConfig::Face face, const viewer::ScanSetup& setup);
  void set_unit(scene::LengthUnit unit);
  void scan(const viewer::ScanSetup& setup);
  /// With the crop box of the last depth scan, else the configuration's, from another side.
  void scan_from(const Eigen::Matrix4d& scan_to_grid);
  void cancel();
  void save(const viewer::ScanSetup& setup);
  /// Keeps the last depth scan as a scene folder, as `sparsha build` writes it: beside the configuration, or in the
  /// working folder, with a name that is not taken; once more, with its present parts, in the same. The note says
  /// where.
  void save_scene();
  /// Parts that were edited on the scene, and the frame that they are written in; the next depth scan and the next
  /// saving have them.
  void set_parts(const std::vector<scene::PartConfig>& parts, const Eigen::Matrix4d& scan_to_grid);
  [[nodiscard]] viewer::OrientingStatus status() const;
  /// A depth scan that has been made, once.
  [[nodiscard]] scene::ScenePointer take_scene();
  /// What builds warned of, once each; for the terminal.
  [[nodiscard]] std::vector<std::string> take_warnings();
  /// What a depth scan with that setup is built from. Parts and sounds stay on the object.
  [[nodiscard]] scene::Config config_of(const viewer::ScanSetup& setup) const;

 private:
  void start(const std::string& stage, std::function<void(Progress&)> work);
  void note(const std::string& text, bool problem = false);
  [[nodiscard]] ReadPoints read_anew(Progress& progress);
  void read(Progress& progress);
  void suggest(Progress& progress);
  void require_trust() const;
  void scale_by(double factor);
  void build(const viewer::ScanSetup& setup, bool proposes);
  [[nodiscard]] viewer::ScanSetup setup_from(const Eigen::Matrix4d& scan_to_grid) const;
  DepthScans();
  [[nodiscard]] std::filesystem::path name_to_save() const;
  [[nodiscard]] std::filesystem::path file_to_save() const;
  void write_scene(Progress& progress);

  scene::Trust trust_ = scene::Trust::own_folder;
  scene::ScenePointer origin_;  ///< the scene that was opened; null for scans
  bool guessed_ = false;
  Eigen::Matrix4d base_to_grid_ = Eigen::Matrix4d::Identity();  ///< the orientation that the configuration means
  std::string title_;
  std::uint64_t most_points_ = kMostPointsShown;
  mutable std::mutex mutex_;  ///< of all below
  scene::Config config_;
  std::optional<Eigen::Matrix4d> parts_to_grid_;  ///< the frame of config_.parts once they were edited
  std::optional<viewer::ScanSetup> scanned_;      ///< that the last depth scan was made with
  std::string yaml_;                              ///< its text, or empty
  std::filesystem::path file_;                    ///< where it is saved; empty: to be chosen
  viewer::OrientingStatus status_;
  std::unique_ptr<Refinement> refinement_;  ///< of status_.points; null: all of them are there
  std::vector<pipeline::Station> stations_;
  std::vector<std::string> warnings_;
  scene::ScenePointer scene_;
  std::optional<pipeline::BuildResult> built_;  ///< of the last depth scan
  std::filesystem::path kept_;                  ///< the folder that it was saved in, or empty
  std::unique_ptr<Progress> progress_;
  std::future<void> work_;
};

/// All of it for the viewer; `scans` names those that are meant at the time of each call.
[[nodiscard]] viewer::Orienting orienting_of(const std::function<DepthScans&()>& scans);

}  // namespace sparsha::app
