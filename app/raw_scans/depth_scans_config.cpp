// The configuration behind raw scans: what a depth scan is built from, and what is saved.
#include <algorithm>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "app/raw_scans/depth_scans.h"
#include "base/error.h"
#include "base/files/files.h"
#include "scene/config/setup_text.h"
#include "scene/folder/folder.h"
#include "scene/scene.h"

namespace sparsha::app {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostText = 1U << 20U;

/// The name with an ending, and a number where there is one already.
fs::path unused_name(const fs::path& name, const char* ending = ".yaml") {
  std::error_code code;
  for (int k = 1; k < 1000; ++k) {
    fs::path file = name;
    file += k == 1 ? std::string(ending) : fmt::format("-{}{}", k, ending);
    if (!fs::exists(fs::symlink_status(file, code))) return file;
  }
  throw Error(ErrorKind::failure, {}, fmt::format("there are too many files called {} here", name.filename().string()),
              "another folder");
}

void set_crop(scene::Config& config, const std::optional<scene::CropConfig>& crop) {
  const auto old = std::ranges::find_if(
      config.filters, [](const auto& filter) { return std::holds_alternative<scene::CropConfig>(filter); });
  if (old != config.filters.end()) {
    if (crop)
      *old = *crop;
    else
      config.filters.erase(old);
  } else if (crop) {
    config.filters.insert(config.filters.begin(), *crop);
  }
}

}  // namespace

void DepthScans::set_parts(const std::vector<scene::PartConfig>& parts, const Eigen::Matrix4d& scan_to_grid) {
  const std::lock_guard lock(mutex_);
  config_.parts = parts;
  parts_to_grid_ = scan_to_grid;
}

// What was guessed and drawn in the old unit stays on the object.
void DepthScans::scale_by(double factor) {
  if (guessed_) {
    scene::scale_lengths(config_, factor);
  } else if (parts_to_grid_) {
    scene::scale_parts(config_, factor);
  }
  if (parts_to_grid_) parts_to_grid_->topRightCorner<3, 1>() *= factor;
  if (!scanned_ || !scanned_->crop) return;
  scanned_->crop->min_m *= factor;
  scanned_->crop->max_m *= factor;
}

scene::Config DepthScans::config_of(const viewer::ScanSetup& setup) const {
  const std::lock_guard lock(mutex_);
  scene::Config config = config_;
  scene::OrientationConfig& orientation = config.orientation;
  set_crop(config, setup.crop);
  // What is written of places on the object stays there, in the frame that it was written in.
  const bool places = !config.parts.empty() || config.audio;
  const Eigen::Matrix4d& places_to_grid = parts_to_grid_ ? *parts_to_grid_ : base_to_grid_;
  if (places && !orientation.regions_scan_to_grid && places_to_grid != setup.scan_to_grid)
    orientation.regions_scan_to_grid = places_to_grid;
  if (base_to_grid_ == setup.scan_to_grid) return config;
  // The label image lies over the grid that it was drawn for, not over the new one.
  if (origin_ && config.audio && config.audio->labels && !config.audio->labels->bounds_m) {
    const auto& built = origin_->description().config.audio;
    if (built && built->labels) config.audio->labels->bounds_m = built->labels->bounds_m;
  }
  orientation.face.reset();
  orientation.face_up.reset();
  orientation.scan_to_grid = setup.scan_to_grid;
  config.grid.bounds_m.reset();
  return config;
}

// After the scene that was opened, else the first scan.
fs::path DepthScans::name_to_save() const {
  if (!origin_ || origin_->folder().empty()) return config_.scans.front().file.stem();
  const fs::path folder = origin_->folder().lexically_normal();
  return folder.filename().empty() ? folder.parent_path().filename() : folder.filename();
}

fs::path DepthScans::file_to_save() const { return file_.empty() ? unused_name(name_to_save()) : file_; }

void DepthScans::save_scene() {
  start("Saving the scene", [this](Progress& progress) { write_scene(progress); });
}

void DepthScans::write_scene(Progress& progress) {
  std::optional<pipeline::BuildResult> built;
  fs::path folder;
  bool again = false;
  {
    const std::lock_guard lock(mutex_);
    built = built_;
    again = !kept_.empty();
    folder = kept_;
    if (built && !again)
      folder = unused_name(file_.empty() ? name_to_save() : file_.parent_path() / file_.stem(), ".scene");
    if (built && parts_to_grid_) {
      scene::SceneDescription description = built->scene->description();
      description.config.parts = config_.parts;
      built->scene = scene::with_description(built->scene, std::move(description));
    }
  }
  if (!built) {
    const bool kept = origin_ && !origin_->folder().empty();
    return note(kept ? fmt::format("This scene is kept in {}", origin_->folder().string())
                     : "There is no depth scan to keep yet",
                !kept);
  }
  if (again)
    scene::write_description(*built->scene, folder);
  else
    pipeline::write_scene_folder(*built, folder, progress);
  note(fmt::format("Saved the scene as {}", folder.string()));
  const std::lock_guard lock(mutex_);
  kept_ = folder;
}

void DepthScans::save(const viewer::ScanSetup& setup) {
  const scene::Config wanted = config_of(setup);
  start("Saving", [this, wanted](Progress&) {
    fs::path file;
    std::string text;
    {
      const std::lock_guard lock(mutex_);
      file = file_to_save();
      text = yaml_;
    }
    std::error_code code;
    if (text.empty() && fs::is_regular_file(file, code)) text = read_file(file, kMostText);
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path();
    const scene::SetupText result = scene::text_with_setup(text, wanted, folder);
    // Comments that cannot be kept are not written over.
    const fs::path commented = file;
    const bool beside = !result.kept && fs::is_regular_file(file, code) && text.find('#') != std::string::npos;
    if (beside) file = unused_name(folder / file.stem());
    write_file(file, result.text);
    note(beside ? fmt::format("Saved as {}; {} stays as it was, since its comments could not be kept", file.string(),
                              commented.string())
                : fmt::format("Saved as {}", file.string()),
         beside);
    const std::lock_guard lock(mutex_);
    file_ = file;
    yaml_.clear();
  });
}

}  // namespace sparsha::app
