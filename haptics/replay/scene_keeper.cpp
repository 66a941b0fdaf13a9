#include "haptics/replay/scene_keeper.h"

#include <system_error>

#include "base/error.h"
#include "scene/folder/folder.h"
#include "scene/scene.h"

namespace sparsha::haptics {
namespace fs = std::filesystem;

namespace {

fs::path target_of(const fs::path& recording) {
  std::error_code code;
  if (recording.empty() || (fs::exists(recording, code) && !fs::is_regular_file(recording, code))) return {};
  return kept_folder_of(recording);
}

/// Kept scenes are never written to, so that two of them can have one file.
void share(const fs::path& from, const fs::path& to) {
  fs::create_directories(to.parent_path());
  std::error_code code;
  fs::create_hard_link(from, to, code);
  if (code) fs::copy_file(from, to);
}

}  // namespace

SceneKeeper::SceneKeeper(const fs::path& recording, scene::ScenePointer first) : target_(target_of(recording)) {
  if (target_.empty()) return;
  if (lies_in_target(*first))
    throw usage_error(
        "the scene " + first->folder().string() + " lies where the recording's scenes are kept, in " + target_.string(),
        "another name for the recording");
  Stamps stamps = stamps_of(*first);
  first_ = {1, std::move(first), std::move(stamps)};
}

SceneKeeper::~SceneKeeper() {
  {
    const std::lock_guard lock(mutex_);
    jobs_.clear();
  }
  end_thread();
}

void SceneKeeper::end_thread() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

bool SceneKeeper::lies_in_target(const scene::Scene& scene) const {
  return !scene.folder().empty() && lies_within(scene.folder(), target_);
}

void SceneKeeper::keep(std::uint64_t number, scene::ScenePointer scene) {
  if (target_.empty()) return;
  Stamps stamps = stamps_of(*scene);
  Job job{number, std::move(scene), std::move(stamps)};
  if (number == 1) {
    first_ = std::move(job);
    return;
  }
  if (first_.scene) add(std::exchange(first_, {}));
  add(std::move(job));
}

SceneKeeper::Stamps SceneKeeper::stamps_of(const scene::Scene& scene) {
  Stamps stamps;
  if (scene.folder().empty()) return stamps;
  for (const fs::path& layer : scene::layer_files(scene.description())) {
    std::error_code code;
    const auto time = fs::last_write_time(scene.folder() / layer, code);
    const auto size = fs::file_size(scene.folder() / layer, code);
    stamps.emplace_back(time, size);
  }
  return stamps;
}

void SceneKeeper::add(Job job) {
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
  }
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  wake_.notify_one();
}

std::string SceneKeeper::failure() const {
  const std::lock_guard lock(mutex_);
  if (failures_.empty()) return {};
  try {
    std::rethrow_exception(failures_.begin()->second);
  } catch (const Error& error) {
    return error.wrong();
  } catch (const std::exception& error) {
    return error.what();
  }
}

void SceneKeeper::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return stopping_ || !jobs_.empty(); });
    if (jobs_.empty()) return;
    const Job job = std::move(jobs_.front());
    jobs_.pop_front();
    lock.unlock();
    std::exception_ptr failure;
    try {
      write(job);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure) failures_[job.number] = failure;
  }
}

// The scene whose layers `fresh` has too: the same ones in memory, or files that nobody has written since.
const SceneKeeper::Written* SceneKeeper::twin_of(const Written& fresh, const scene::Scene& scene) const {
  for (const Written& written : written_) {
    if (written.layers != fresh.layers || written.folder != fresh.folder || written.stamps != fresh.stamps) continue;
    if (!fresh.folder.empty()) return &written;
    const scene::ScenePointer other = written.scene.lock();
    if (other && scene.in_memory(0) != nullptr && scene.in_memory(0) == other->in_memory(0)) return &written;
  }
  return nullptr;
}

void SceneKeeper::write(const Job& job) {
  const scene::Scene& scene = *job.scene;
  if (lies_in_target(scene))
    throw Error(ErrorKind::failure, {target_.string()},
                "the scenes of the recording cannot be kept: one of them lies in this folder",
                "another name for the recording");
  const auto require_untouched = [&] {
    if (stamps_of(scene) == job.stamps) return;
    throw Error(ErrorKind::failure, {target_.string()},
                "the scenes of the recording cannot be kept: " + scene.folder().string() +
                    " was built anew while it was touched",
                "a build to another folder, or after the run");
  };
  require_untouched();
  if (!folder_) folder_ = std::make_unique<AtomicPath>(target_, AtomicPath::Kind::folder);
  const fs::path folder = kept_scene_folder(folder_->temporary(), job.number);
  try {
    folder_->naming_target([&] {
      fs::create_directory(folder);
      write_into(folder, job);
      require_untouched();
      list_.scenes[job.number] = sha256_of_file(folder / "scene.yaml");
    });
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    throw;
  }
  last_ = job.scene;
}

void SceneKeeper::write_into(const fs::path& folder, const Job& job) {
  const scene::Scene& scene = *job.scene;
  Written fresh{job.number, job.scene, scene.folder(), job.stamps, scene::layer_files(scene.description())};
  if (const Written* const twin = twin_of(fresh, scene)) {
    for (const fs::path& layer : fresh.layers)
      share(kept_scene_folder(folder_->temporary(), twin->number) / layer, folder / layer);
    scene::write_description(scene, folder);
    return;
  }
  scene::write_scene(scene, folder);
  written_.push_back(std::move(fresh));
}

// A scene that was given and never touched, e.g. since its layers cannot be read, is missed by nobody.
void SceneKeeper::require_kept(const std::vector<std::uint64_t>& touched) const {
  for (const std::uint64_t number : touched)
    if (const auto failure = failures_.find(number); failure != failures_.end())
      std::rethrow_exception(failure->second);
}

void SceneKeeper::finish(const std::string& recording_sha256, const std::vector<std::uint64_t>& touched) {
  if (target_.empty()) return;
  end_thread();
  std::error_code code;
  const bool present = fs::exists(fs::symlink_status(target_, code));
  const std::string foreign = present ? foreign_in_kept_folder(target_) : std::string();
  try {
    require_kept(touched);
  } catch (...) {
    folder_.reset();
    if (present && foreign.empty()) fs::remove_all(target_, code);  // it is of the recording that was replaced
    throw;
  }
  if (!folder_) {
    if (present && foreign.empty()) fs::remove_all(target_, code);
    return;
  }
  if (!foreign.empty())
    throw Error(ErrorKind::failure, {target_.string()}, "the scenes of the recording cannot be kept: " + foreign,
                "another name for the recording");
  list_.recording_sha256 = recording_sha256;
  folder_->naming_target([&] { write_kept_list(folder_->temporary(), list_); });
  folder_->commit();
  folder_.reset();
}

}  // namespace sparsha::haptics
