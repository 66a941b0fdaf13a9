// The scenes that a run touches: its first one, another folder, or a new depth scan.
#include <algorithm>
#include <utility>

#include "app/exploration/edited_parts.h"
#include "app/exploration/exploration.h"
#include "app/inputs.h"
#include "base/error.h"
#include "scene/folder/folder.h"
#include "scene/scene.h"

namespace sparsha::app {
namespace fs = std::filesystem;

namespace {

// Whether a live stream is asked for at all.
bool sounds(const scene::Config& config) { return config.audio.has_value() || config.cues.has_value(); }

// Whether places of parts are places of sounds.
bool has_sounding_parts(const scene::Scene& scene) {
  const scene::Config& config = scene.description().config;
  return config.audio && config.audio->material && std::ranges::any_of(config.parts, [](const scene::PartConfig& part) {
           return part.touch.material.has_value();
         });
}

}  // namespace

std::unique_ptr<haptics::Session> Exploration::session_of(const scene::ScenePointer& scene) {
  const scene::Config& config = scene->description().config;
  haptics::SessionOptions options;
  options.language = speech().language;
  options.speaks = speaks(scene);
  options.by_keys = chosen_.keys != nullptr;
  options.grip = chosen_.keys == nullptr && chosen_.pointer == nullptr;
  options.haptics = config.haptics;
  options.effects = {!arguments_.no_texture, !arguments_.no_friction};
  options.record = arguments_.record;
  if (chosen_.recording)
    return std::make_unique<haptics::Session>(kept_.value_or(haptics::RecordedScenes(scene)), chosen_.recording,
                                              options);
  if (chosen_.simulated) chosen_.device = simulated_hand(scene->description(), arguments_.duration_s);
  return std::make_unique<haptics::Session>(scene, std::move(chosen_.device), options);
}

// `needs_sound`: a scene whose sounds cannot be read is an error; else it is touched without them.
void Exploration::make_session_of(scene::ScenePointer scene, bool needs_sound) {
  scene_ = std::move(scene);
  scans_.touch();
  session_ = session_of(scene_);
  contacts_ = session_->add_contact_consumer();  // also where only a later scene sounds
  if (!sounds(scene_->description().config) && arguments_.audio_out.empty()) return;
  try {
    sound_.use(sound_of(scene_));
  } catch (const Error& error) {
    if (needs_sound || !arguments_.audio_out.empty()) throw;
    warn("no_sound", {{"reason", error.wrong()}});
  }
}

std::unique_ptr<audio::Engine> Exploration::sound_of(const scene::ScenePointer& scene) {
  audio::EngineOptions options;
  options.wav = arguments_.audio_out;
  options.live = sounds(scene->description().config);
  options.device = arguments_.audio_device;
  return std::make_unique<audio::Engine>(scene, contacts_, session_->state(), options);
}

// The first scene, while the window is open.
void Exploration::begin_with(const scene::ScenePointer& scene) {
  make_session_of(scene, false);
  speaker_->use(speech(), speaks(scene_));
  start();
  connect_session();
}

// Another scene under the same hand. Its sounds take the place of the present ones; a sound file goes on with those
// that it began with.
void Exploration::change_scene(const scene::ScenePointer& scene) {
  const bool changes_sound = arguments_.audio_out.empty();
  std::unique_ptr<audio::Engine> sound;
  if (changes_sound && sounds(scene->description().config)) sound = sound_of(scene);  // or nothing changes
  session_->set_scene(scene);
  before_ = std::exchange(scene_, scene);
  change_speech(before_);
  const double stiffness = scene->description().config.haptics.stiffness_n_per_m;
  if (stiffness != before_->description().config.haptics.stiffness_n_per_m)
    session_->requests().post({haptics::Request::Kind::set_stiffness, stiffness});
  if (changes_sound) change_sound(std::move(sound));
}

void Exploration::change_sound(std::unique_ptr<audio::Engine> sound) {
  sound_.use(nullptr);
  haptics::ContactEvent earlier;
  while (contacts_->pop(earlier)) {
    // What was touched before is not heard now.
  }
  sound_.use(std::move(sound));
  sound_.start();
}

// Speech that a visitor has turned on or off stays so between scenes that ask for the same.
void Exploration::change_speech(const scene::ScenePointer& before) {
  const bool on = speaks(before) == speaks(scene_) ? speaker_->on() : speaks(scene_);
  session_->set_speech(speech().language, on, speaks(scene_));
  speaker_->use(speech(), on, speaks(scene_));
}

// The recording that is played has come to another of its scenes: what is heard follows, as it did in the run. What is
// seen asks the session.
void Exploration::follow_recording() {
  if (!session_->plays_recording() || session_->scene() == scene_) return;
  const scene::ScenePointer before = std::exchange(scene_, session_->scene());
  change_speech(before);
  if (scene::same_scans(before->description(), scene_->description())) return sound_.set_scene(scene_);
  if (!arguments_.audio_out.empty()) return;
  try {
    change_sound(sounds(scene_->description().config) ? sound_of(scene_) : nullptr);
  } catch (const Error& error) {
    change_sound(nullptr);
    warn("no_sound", {{"reason", error.wrong()}});
  }
}

// The window cannot show the new scene: the one before comes back, unless a recording is played, which goes on.
void Exploration::refuse(const std::string& why) {
  try {
    if (const scene::ScenePointer before = std::exchange(before_, nullptr)) {
      change_scene(before);
      scans_.go_back();
    }
  } catch (const Error&) {
    // Its sounds cannot be read any more: the new scene is touched and the old picture shown.
  }
  before_ = nullptr;  // it is not refused in its turn
  warn("cannot_open", {{"reason", why}});
}

void Exploration::next_scene(int step) {
  const fs::path& folder = exhibits_.go(step);
  try {
    change_scene(scene::open_scene(folder, trust_));
    session_->announcements().say(folder.filename().string());
  } catch (const Error& error) {
    announce("cannot_open", {{"reason", error.wrong()}}, haptics::Announcement::Priority::warning);
  }
}

// A finished depth scan goes to the session, the first one begins it.
void Exploration::take_scan() {
  const scene::ScenePointer scene = scans_.shown().take_scene();
  if (!scene) return;
  try {
    if (!session_) {
      begin_with(scene);
    } else if (!scans_.touched()) {
      change_scene(scene);
      scans_.touch();
    } else {
      session_->set_scene(scene);
      before_ = std::exchange(scene_, scene);
      sound_.set_scene(scene);
      scans_.touch();
    }
  } catch (const Error& error) {
    if (!session_) throw;
    warn("cannot_open", {{"reason", error.wrong()}});
  }
}

// A scene is opened, a configuration or scans are shown to be turned.
void Exploration::drop(const std::vector<fs::path>& files) {
  std::error_code code;
  if (files.empty()) return;
  if (session_ && session_->plays_recording()) return warn("not_while_played");
  fs::path first = files.front();
  if (first.filename() == "scene.yaml") first = first.parent_path();
  try {
    const auto is_one = [&](const fs::path& file) { return fs::is_directory(file, code) || is_config(file); };
    if (files.size() > 1 && std::ranges::any_of(files, is_one)) return warn("one_at_once");
    if (fs::is_directory(first, code)) return drop_scene(first);
    scans_.show(is_config(first) ? std::make_unique<DepthScans>(first) : std::make_unique<DepthScans>(files));
    to_scans_ = true;
  } catch (const Error& error) {
    warn("cannot_open", {{"reason", error.what()}});
  }
}

void Exploration::drop_scene(const fs::path& folder) {
  scene::ScenePointer scene = scene::open_scene(folder, trust_);
  auto scans = std::make_unique<DepthScans>(scene, fs::path(), trust_);
  if (session_) {
    change_scene(scene);  // or nothing changes
    scans_.touch(std::move(scans));
    return;
  }
  scans_.show(std::move(scans));
  begin_with(scene);
}

// The depth scan under the hand; scans of another object that are open have no part in it.
void Exploration::save_scene() {
  using Priority = haptics::Announcement::Priority;
  if (session_->plays_recording()) return announce("not_while_played");
  if (scans_.shown().status().busy) return announce("scan_running");
  if (!scans_.touched()) return announce("not_written", {{"reason", "other scans are open"}}, Priority::warning);
  scans_.shown().save_scene();
}

// A new depth scan from the side that is looked at.
void Exploration::rescan(const Eigen::Matrix4d& scan_to_grid) {
  using Priority = haptics::Announcement::Priority;
  if (session_->plays_recording()) return announce("no_scan_while_played");
  if (scans_.shown().status().busy) return announce("scan_running");
  if (const std::string why = scans_.shown().unavailable(); !why.empty())
    return announce("no_new_scan", {{"reason", why}}, Priority::warning);
  if (!scans_.touched()) return announce("no_new_scan", {{"reason", "other scans are open"}}, Priority::warning);
  announce("new_scan");
  scans_.shown().scan_from(scan_to_grid);
}

// Parts drawn or moved on the stone: felt and spoken at once, and kept in the scene's folder. Scans of another object
// that are open have no part in it.
bool Exploration::edit_parts(const std::vector<scene::PartConfig>& parts) {
  try {
    scene::ScenePointer edited = with_parts(scene_, parts);
    const bool other_sound =
        arguments_.audio_out.empty() && (has_sounding_parts(*scene_) || has_sounding_parts(*edited));
    std::unique_ptr<audio::Engine> sound = other_sound ? sound_of(edited) : nullptr;
    session_->set_scene(edited);
    scene_ = std::move(edited);  // the window can show it: its layers are those of the one before
    if (other_sound)
      change_sound(std::move(sound));
    else
      sound_.set_scene(scene_);
    if (scans_.touched()) scans_.shown().set_parts(parts, parts_frame(scene_->description()));
    return true;
  } catch (const Error& error) {
    warn("not_written", {{"reason", error.wrong()}});
    return false;
  }
}

}  // namespace sparsha::app
