// Runs one job at a time on a worker thread; the window reads the outcome from status().
#include "app/raw_scans/depth_scans.h"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <cmath>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include <Eigen/LU>

#include "base/error.h"
#include "base/files/files.h"
#include "base/text/text.h"
#include "base/threads/thread_pool.h"
#include "pipeline/build/build.h"
#include "pipeline/orient/face.h"
#include "pipeline/projection/count_scattered.h"
#include "pipeline/scan/units.h"
#include "pipeline/suggest/suggest.h"
#include "scene/folder/folder.h"
#include "scene/scene.h"

namespace sparsha::app {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kFaceSample = 20000;

std::string title_of(const std::vector<scene::ScanConfig>& scans) {
  if (scans.empty()) return {};
  const std::string first = scans.front().file.filename().string();
  return scans.size() == 1 ? first : fmt::format("{} and {} more", first, scans.size() - 1);
}

/// About how many points of the scans lie in space, from those that are shown.
std::uint64_t scattered_in(const viewer::PointView& view) {
  if (view.points.empty()) return 0;
  ThreadPool pool;
  const pipeline::RawPoints shown{view.points.front().data(), 3, view.points.size()};
  const double share = static_cast<double>(pipeline::count_scattered(shown, pool)) / static_cast<double>(shown.count);
  return static_cast<std::uint64_t>(
      std::llround(share * static_cast<double>(std::max<std::uint64_t>(view.total, shown.count))));
}

std::vector<Eigen::Vector3d> sample_of(const viewer::PointView& points, const viewer::ScanSetup& setup) {
  std::vector<Eigen::Vector3d> sample;
  const double share = std::min(1.0, static_cast<double>(kFaceSample) / static_cast<double>(points.points.size()));
  for (const viewer::PointBlock& block : points.blocks) {
    const auto count = static_cast<std::uint32_t>(std::ceil(share * block.count));
    for (std::uint32_t n = block.begin; n < block.begin + std::min(count, block.count); ++n) {
      const Eigen::Vector3d place = points.origin_m + points.points[n].cast<double>();
      if (setup.crop &&
          ((place.array() < setup.crop->min_m.array()).any() || (place.array() > setup.crop->max_m.array()).any()))
        continue;
      sample.push_back(place);
    }
  }
  return sample;
}

viewer::ScanSetup setup_of(const scene::Config& config, const Eigen::Matrix4d& scan_to_grid) {
  viewer::ScanSetup setup;
  setup.scan_to_grid = scan_to_grid;
  for (const scene::FilterConfig& filter : config.filters) {
    const auto* crop = std::get_if<scene::CropConfig>(&filter);
    if (crop == nullptr) continue;
    setup.crop = *crop;
    break;
  }
  return setup;
}

std::shared_ptr<const viewer::SidePictures> pictures_of(const std::vector<pipeline::Thumbnail>& sides) {
  static_assert(viewer::SidePictures::kNothing == pipeline::Thumbnail::kNothing);
  if (sides.empty()) return nullptr;
  auto pictures = std::make_shared<viewer::SidePictures>();
  pictures->side_px = sides.front().side;
  for (const pipeline::Thumbnail& side : sides) {
    std::string name = side.name;
    name.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
    pictures->sides.push_back({std::move(name), side.look_from, side.up, side.grey});
  }
  return pictures;
}

}  // namespace

DepthScans::DepthScans() {
  static std::atomic<std::uint64_t> works{0};
  status_.work = ++works;
}

DepthScans::DepthScans(std::vector<fs::path> scans) : DepthScans() {
  guessed_ = true;
  for (fs::path& scan : scans) {
    scene::ScanConfig config;
    config.file = std::move(scan);
    config_.scans.push_back(std::move(config));
  }
  title_ = title_of(config_.scans);
}

DepthScans::DepthScans(fs::path config) : DepthScans() {
  file_ = std::move(config);
  config_ = scene::load_config(file_);
  base_to_grid_ = config_.orientation.scan_to_grid;
  title_ = title_of(config_.scans);
}

DepthScans::DepthScans(scene::ScenePointer scene, fs::path file, scene::Trust trust) : DepthScans() {
  trust_ = trust;
  origin_ = std::move(scene);
  config_ = origin_->description().config;
  file_ = std::move(file);
  base_to_grid_ = config_.orientation.scan_to_grid;
  // As it is written: what is automatic is found anew from another side, and stays automatic when it is saved.
  if (!file_.empty()) config_ = scene::load_config(file_);
  title_ = title_of(config_.scans);
}

DepthScans::~DepthScans() {
  cancel();
  if (work_.valid()) work_.wait();
  refinement_.reset();  // it says what it cannot read
}

std::string DepthScans::unavailable() const {
  const std::lock_guard lock(mutex_);
  if (config_.scans.empty()) return "this scene names no scans";
  if (config_.unroll) return "an unrolled object is turned by the orientation in its configuration";
  std::error_code code;
  for (const scene::ScanConfig& scan : config_.scans)
    if (!fs::is_regular_file(scan.file, code)) return scan.file.filename().string() + " is not there any more";
  return {};
}

void DepthScans::note(const std::string& text, bool problem) {
  const std::lock_guard lock(mutex_);
  status_.note = text;
  status_.problem = problem;
  ++status_.notes;
}

void DepthScans::start(const std::string& stage, std::function<void(Progress&)> work) {
  {
    const std::lock_guard lock(mutex_);
    if (status_.busy) return;
  }
  if (work_.valid()) work_.wait();  // it has ended: busy is the last that it sets
  const std::lock_guard lock(mutex_);
  status_.busy = true;
  status_.stage = stage;
  status_.fraction = 0.0;
  progress_ = std::make_unique<Progress>([this](const ProgressUpdate& update) {
    const std::lock_guard listener_lock(mutex_);
    if (update.kind == ProgressUpdate::Kind::stage) status_.stage = update.text;
    if (update.kind != ProgressUpdate::Kind::warning) status_.fraction = update.fraction;
  });
  work_ = std::async(std::launch::async, [this, work = std::move(work), progress = progress_.get()] {
    try {
      work(*progress);
    } catch (const Cancelled&) {
      note("Stopped; nothing was changed");
    } catch (const Error& error) {
      note(error.what(), true);
    } catch (const std::bad_alloc&) {
      note("Out of memory; a smaller scan or a crop box", true);
    } catch (const std::exception& error) {
      note(error.what(), true);
    }
    const std::lock_guard done_lock(mutex_);
    status_.busy = status_.scanning = false;
  });
}

void DepthScans::cancel() {
  const std::lock_guard lock(mutex_);
  if (progress_) progress_->cancel();
}

viewer::OrientingStatus DepthScans::status() const {
  const std::lock_guard lock(mutex_);
  viewer::OrientingStatus status = status_;
  if (refinement_) {
    status.detail = refinement_->detail();
    status.refining = refinement_->busy();
  }
  return status;
}

void DepthScans::look(const viewer::SplatView& view, const viewer::ScanSetup& setup) {
  const std::lock_guard lock(mutex_);
  if (refinement_) refinement_->look({view, setup.crop});
}

scene::ScenePointer DepthScans::take_scene() {
  const std::lock_guard lock(mutex_);
  return std::exchange(scene_, nullptr);
}

std::vector<std::string> DepthScans::take_warnings() {
  const std::lock_guard lock(mutex_);
  return std::exchange(warnings_, {});
}

// The memory is that of one cloud: what was read of the one before is given up meanwhile, and comes again when reading
// fails.
ReadPoints DepthScans::read_anew(Progress& progress) {
  std::vector<scene::ScanConfig> scans;
  Refinement* before = nullptr;  // only this work replaces it
  {
    const std::lock_guard lock(mutex_);
    scans = config_.scans;
    before = refinement_.get();
  }
  if (before != nullptr) before->rest();  // without the lock, which it may wait for
  try {
    return read_points(scans, title_, progress, most_points_);
  } catch (...) {
    if (before != nullptr) before->resume();
    throw;
  }
}

void DepthScans::read(Progress& progress) {
  ReadPoints points = read_anew(progress);
  const std::shared_ptr<const viewer::PointView> view = points.view;
  std::unique_ptr<Refinement> refinement;  // the one before ends without the lock, which it may wait for
  if (!points.coarse.empty()) {
    const std::uint64_t shown = view->points.size();
    refinement =
        std::make_unique<Refinement>(std::move(points.coarse), view, most_points_ - std::min(most_points_, shown),
                                     [this](const std::string& problem) { note(problem, true); });
  }
  {
    const std::lock_guard lock(mutex_);
    refinement_.swap(refinement);
    status_.points = std::move(points.view);
    status_.scattered = 0;
    stations_ = std::move(points.stations);
  }
  const std::uint64_t scattered = scattered_in(*view);
  const std::lock_guard lock(mutex_);
  status_.scattered = scattered;
}

// The configuration that `sparsha new` would write; its units may differ from those that the points were read with.
void DepthScans::suggest(Progress& progress) {
  std::vector<fs::path> files;
  std::vector<scene::LengthUnit> units;
  {
    const std::lock_guard lock(mutex_);
    for (const scene::ScanConfig& scan : config_.scans) files.push_back(scan.file);
  }
  std::size_t outdated = progress.warnings().size();
  pipeline::Suggestion suggestion = pipeline::suggest_config(files, {}, progress);
  double before = 0.0;
  {
    const std::lock_guard lock(mutex_);
    before = status_.points->metres_per_unit;
    config_ = suggestion.config;
    yaml_ = suggestion.yaml;
  }
  const auto differs = [&](const scene::ScanConfig& scan) {
    return std::abs(scene::metres_in(scan.units.unit) - before) > 1e-9;
  };
  // The same numbers in metres need no second reading.
  if (std::ranges::any_of(suggestion.config.scans, differs)) {
    read(progress);
  } else {
    outdated = 0;
  }
  // A unit that was doubted and is another one now needs no warning any more.
  std::vector<std::string> warnings = progress.warnings();
  warnings.erase(warnings.begin(), warnings.begin() + static_cast<std::ptrdiff_t>(outdated));
  if (!warnings.empty()) note(warnings.front(), true);
  const std::lock_guard lock(mutex_);
  warnings_.insert(warnings_.end(), warnings.begin(), warnings.end());
  base_to_grid_ = config_.orientation.scan_to_grid;
  status_.proposal = setup_of(config_, base_to_grid_);
  status_.spacing_m = config_.grid.spacing_m;
  status_.sides = pictures_of(suggestion.sides);
  ++status_.proposals;
}

void DepthScans::require_trust() const {
  if (origin_ && trust_ == scene::Trust::own_folder && !origin_->folder().empty())
    scene::require_own_scans(origin_->description(), origin_->folder());
}

void DepthScans::open() {
  {
    const std::lock_guard lock(mutex_);
    if (status_.points) return;
  }
  start("Reading the scans", [this](Progress& progress) {
    require_trust();
    if (!guessed_) {
      const std::lock_guard lock(mutex_);
      status_.proposal = scanned_.value_or(setup_of(config_, base_to_grid_));
      status_.spacing_m = config_.grid.spacing_m;
      ++status_.proposals;
    }
    read(progress);
    if (guessed_) suggest(progress);
  });
}

void DepthScans::find_face(scene::OrientationConfig::Face face, const viewer::ScanSetup& setup) {
  start("Looking for the face", [this, face, setup](Progress&) {
    pipeline::FacePoints points;
    {
      const std::lock_guard lock(mutex_);
      points.sample_m = sample_of(*status_.points, setup);
      points.stations = stations_;
      points.z_up = status_.points->z_up;
    }
    const double scale = std::cbrt(std::abs(setup.scan_to_grid.topLeftCorner<3, 3>().determinant()));
    const pipeline::FoundFace found = pipeline::find_face(points, face, std::nullopt, scale);
    note(found.reason);
    const std::lock_guard lock(mutex_);
    status_.proposal = setup;
    status_.proposal.scan_to_grid = found.scan_to_grid;
    ++status_.proposals;
  });
}

void DepthScans::set_unit(scene::LengthUnit unit) {
  start("Reading the scans", [this, unit](Progress& progress) {
    scene::Config before;
    double factor = 1.0;
    {
      const std::lock_guard lock(mutex_);
      before = config_;
      if (status_.points->metres_per_unit > 0.0) factor = scene::metres_in(unit) / status_.points->metres_per_unit;
      for (scene::ScanConfig& scan : config_.scans) scan.units = {unit, 0.0};
    }
    try {
      read(progress);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      config_.scans = before.scans;
      throw;
    }
    note("The scans are read in " + scene::to_string(unit));
    const std::lock_guard lock(mutex_);
    scale_by(factor);
    status_.spacing_m = config_.grid.spacing_m;
  });
}

// Of the last depth scan, or of the configuration.
viewer::ScanSetup DepthScans::setup_from(const Eigen::Matrix4d& scan_to_grid) const {
  const std::lock_guard lock(mutex_);
  viewer::ScanSetup setup = scanned_.value_or(setup_of(config_, scan_to_grid));
  setup.scan_to_grid = scan_to_grid;
  return setup;
}

void DepthScans::scan(const viewer::ScanSetup& setup) { build(setup, false); }

void DepthScans::scan_from(const Eigen::Matrix4d& scan_to_grid) { build(setup_from(scan_to_grid), true); }

// `proposes`: where the cloud is shown, it is turned to this setup.
void DepthScans::build(const viewer::ScanSetup& setup, bool proposes) {
  const scene::Config config = config_of(setup);
  start("Depth scan", [this, config, setup, proposes](Progress& progress) {
    {
      const std::lock_guard lock(mutex_);
      status_.scanning = true;
    }
    require_trust();
    pipeline::BuildResult result = pipeline::build_scene(config, {}, progress);
    const std::vector<std::string> warnings = progress.warnings();
    const auto count = warnings.size();
    const std::uint64_t scattered = result.report.points.scattered;
    note(fmt::format("Depth scan done: {:.0f} % measured{}{}", 100.0 * result.report.coverage,
                     scattered == 0 ? "" : fmt::format(", {} scattered points left out", count_text(scattered)),
                     count == 0 ? "" : fmt::format(", {} warning{} on the terminal", count, count == 1 ? "" : "s")));
    const std::lock_guard lock(mutex_);
    scene_ = result.scene;
    built_ = std::move(result);
    kept_.clear();
    status_.can_save_scene = true;
    scanned_ = setup;
    if (proposes) {
      status_.proposal = setup;
      ++status_.proposals;
    }
    warnings_.insert(warnings_.end(), warnings.begin(), warnings.end());
  });
}

viewer::Orienting orienting_of(const std::function<DepthScans&()>& scans) {
  viewer::Orienting orienting;
  orienting.unavailable = [scans] { return scans().unavailable(); };
  orienting.open = [scans] { scans().open(); };
  orienting.status = [scans] { return scans().status(); };
  orienting.look = [scans](const viewer::SplatView& view, const viewer::ScanSetup& setup) {
    scans().look(view, setup);
  };
  orienting.find_face = [scans](auto face, const viewer::ScanSetup& setup) { scans().find_face(face, setup); };
  orienting.set_unit = [scans](scene::LengthUnit unit) { scans().set_unit(unit); };
  orienting.scan = [scans](const viewer::ScanSetup& setup) { scans().scan(setup); };
  orienting.cancel = [scans] { scans().cancel(); };
  orienting.save = [scans](const viewer::ScanSetup& setup) { scans().save(setup); };
  orienting.save_scene = [scans] { scans().save_scene(); };
  return orienting;
}

}  // namespace sparsha::app
