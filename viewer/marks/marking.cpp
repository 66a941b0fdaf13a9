// Notes follow the object: they are kept in the scans' frame and shown in the grid's.
#include "viewer/marks/marking.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <Eigen/LU>

#include "base/error.h"
#include "scene/folder/folder.h"
#include "scene/frame/length_unit.h"
#include "scene/scene.h"
#include "viewer/frame.h"

namespace sparsha::viewer {
namespace {

using Priority = haptics::Announcement::Priority;

constexpr std::size_t kLongestWords = 200;  // bytes

void append_utf8(std::string& words, char32_t c) {
  const auto add = [&](char32_t byte) { words += static_cast<char>(static_cast<unsigned char>(byte)); };
  if (c < 0x80) {
    add(c);
  } else if (c < 0x800) {
    add(0xC0U | (c >> 6U));
    add(0x80U | (c & 0x3FU));
  } else if (c < 0x10000) {
    add(0xE0U | (c >> 12U));
    add(0x80U | ((c >> 6U) & 0x3FU));
    add(0x80U | (c & 0x3FU));
  } else {
    add(0xF0U | (c >> 18U));
    add(0x80U | ((c >> 12U) & 0x3FU));
    add(0x80U | ((c >> 6U) & 0x3FU));
    add(0x80U | (c & 0x3FU));
  }
}

const char* name_of(Tool tool) {
  switch (tool) {
    case Tool::distance:
      return "Measure a distance: click two points";
    case Tool::angle:
      return "Measure an angle: click three points, the middle one is its vertex";
    case Tool::profile:
      return "Depth profile: click both ends of the line";
    default:
      return "Measuring off";
  }
}

// Metres of a scene for each metre of the same scans as `other` reads them.
double unit_ratio(const scene::SceneDescription& scene, const scene::SceneDescription& other) {
  const auto metres = [](const scene::SceneDescription& description) {
    const auto& scans = description.config.scans;
    const bool known = !scans.empty() && scans.front().units.unit != scene::LengthUnit::longest_side;
    return known ? scene::metres_in(scans.front().units.unit) : 0.0;
  };
  const double own = metres(scene), others = metres(other);
  return own > 0.0 && others > 0.0 ? own / others : 1.0;
}

// From the grid of a scene to the scans' frame of `home`, which may read them in another unit.
Eigen::Matrix4d home_from_grid(const scene::SceneDescription& scene, const scene::SceneDescription& home) {
  Eigen::Matrix4d matrix = scene.scan_from_grid;
  matrix.topRows<3>() *= unit_ratio(home, scene);
  return matrix;
}

}  // namespace

void Marking::set_scene(scene::ScenePointer scene) {
  const scene::ScenePointer before = std::exchange(scene_, std::move(scene));
  const scene::SceneDescription& now = scene_->description();
  const bool same = before && (before == scene_ || scene::same_scans(before->description(), now));
  // In the scans' frame, to come back in the new grid's.
  Notes kept = same ? moved(marks_.notes, before->description().scan_from_grid) : Notes{};
  Eigen::Matrix4d scan_from_grid = same ? home_from_grid(now, before->description()) : now.scan_from_grid;
  Marks fresh;
  fresh.version = marks_.version;
  if (same) fresh.tool = marks_.tool;
  marks_ = std::move(fresh);
  held_.reset();
  if (!same || !scene_->folder().empty()) {
    home_ = scene_->folder().empty() ? nullptr : scene_;
    unreadable_ = told_ = false;
  }
  if (!scene_->folder().empty()) {
    scan_from_grid = now.scan_from_grid;
    try {
      kept = read_notes(scene_->folder() / scene::kNotesFile);
    } catch (const Error& error) {
      unreadable_ = true;
      kept = {};
      tell_(std::string("The notes cannot be read: ") + error.what(), Priority::warning);
    }
  }
  marks_.notes = moved(kept, scan_from_grid.inverse());
  read_parts();
  follow_profile();
  face_pins();
  changed();
}

const scene::Sight* Marking::sight() {
  const std::shared_ptr<const scene::Charts> charts = scene_ ? scene_->description().charts : nullptr;
  if (charts != seen_) {
    sight_ = charts ? std::make_unique<const scene::Sight>(*charts) : nullptr;
    seen_ = charts;
  }
  return sight_.get();
}

void Marking::face_pins() {
  marks_.pin_normals.clear();
  if (marks_.notes.pins.empty()) return;
  const scene::Sight* const sight = this->sight();
  for (const Pin& pin : marks_.notes.pins) {
    const auto place = sight != nullptr ? sight->nearest(pin.at_m) : std::nullopt;
    marks_.pin_normals.push_back(place ? place->normal : Eigen::Vector3d(Eigen::Vector3d::Zero()));
  }
}

// A profile is read from the finest level when it becomes the newest measure.
void Marking::follow_profile() {
  marks_.profile.clear();
  const auto& measures = marks_.notes.measures;
  if (measures.empty() || measures.back().kind != Measure::Kind::profile) return;
  try {
    marks_.profile = profile_along(*scene_, measures.back().points_m[0], measures.back().points_m[1]);
  } catch (const Error& error) {
    tell_("The profile cannot be read: " + error.wrong(), Priority::warning);
  }
}

void Marking::next_tool() {
  marks_.tool = static_cast<Tool>((static_cast<int>(marks_.tool) + 1) % 4);
  // A profile is a line over one view.
  if (marks_.tool == Tool::profile && scene_ && is_whole(scene_->description())) marks_.tool = Tool::none;
  marks_.pending_m.clear();
  tell_(name_of(marks_.tool), Priority::information);
  changed();
}

void Marking::add_point(const Eigen::Vector3d& at_m) {
  Eigen::Vector3d place = at_m;
  try {
    if (!is_whole(scene_->description())) place.z() = surface_height_m(*scene_, at_m.x(), at_m.y());
  } catch (const Error&) {
    place.z() = std::numeric_limits<double>::quiet_NaN();
  }
  if (!place.allFinite()) return tell_("Nothing was measured there", Priority::information);
  marks_.pending_m.push_back(place);
  changed();
  Measure measure;
  measure.kind = static_cast<Measure::Kind>(static_cast<int>(marks_.tool) - 1);
  if (marks_.pending_m.size() < points_of(measure.kind)) return;
  measure.points_m = std::exchange(marks_.pending_m, {});
  std::string words = value_text(measure);
  marks_.notes.measures.push_back(std::move(measure));
  follow_profile();
  words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
  tell_(words, Priority::information);
  save();
}

void Marking::add_pin(const Eigen::Vector3d& at_m) {
  marks_.notes.pins.push_back({at_m, {}});
  face_pins();
  marks_.typing.emplace();
  writing_ = Writing::pin;
  tell_("Write a note, Enter keeps it", Priority::information);
  changed();
}

void Marking::finish_words(bool keep) {
  const std::string words = marks_.typing.value_or("");
  marks_.typing.reset();
  changed();
  if (writing_ == Writing::pin) {
    auto& pins = marks_.notes.pins;
    if (!keep || words.empty()) {
      pins.pop_back();
      face_pins();
      return;
    }
    pins.back().text = words;
    return save();
  }
  if (!keep || words.empty()) {
    marks_.parts.pop_back();
    return;
  }
  scene::PartConfig part;
  part.name = part.say = words;
  part.box_m = marks_.parts.back().box_m;
  marks_.parts.back().name = words;
  parts_.push_back(std::move(part));
  save_parts();
}

bool Marking::press(const KeyPress& press) {
  if (!marks_.typing) return false;
  if (press.key == key::kEnter) finish_words(true);
  if (press.key == key::kEscape) finish_words(false);
  if (press.key == key::kBackspace) {
    std::string& words = *marks_.typing;
    while (!words.empty() && (static_cast<unsigned char>(words.back()) & 0xC0U) == 0x80U) words.pop_back();
    if (!words.empty()) words.pop_back();
    changed();
  }
  return true;
}

void Marking::type(char32_t character) {
  if (!marks_.typing || character < 0x20 || character == 0x7F || character > 0x10FFFF) return;
  if (marks_.typing->size() + 4 > kLongestWords) return;
  append_utf8(*marks_.typing, character);
  changed();
}

bool Marking::escape() {
  if (marks_.typing) {
    finish_words(false);
    return true;
  }
  if (marks_.tool == Tool::none) return false;
  if (marks_.pending_m.empty()) marks_.tool = Tool::none;
  marks_.pending_m.clear();
  changed();
  return true;
}

void Marking::set_parallel(bool on) {
  if (marks_.notes.parallel == on) return;
  marks_.notes.parallel = on;
  save();
}

bool Marking::act(Action action, const Aim& aim, const std::optional<Eigen::Vector3d>& touched_m,
                  const Eigen::Vector3d& centre_m, double width_m, bool shows_parts) {
  switch (action) {
    case Action::measure:
      next_tool();
      return true;
    case Action::measure_save:
      save_files();
      return true;
    case Action::pin:
      if (aim.at_m || touched_m)
        add_pin(aim.at_m ? *aim.at_m : *touched_m);
      else
        tell_("Point at the stone to set a pin", Priority::information);
      return true;
    case Action::add_part:
      add_part(aim.at_m.value_or(centre_m), width_m);
      return true;
    case Action::erase:
      erase(aim, shows_parts);
      return true;
    case Action::section:
      switch_section(centre_m);
      return true;
    case Action::section_turn:
    case Action::section_near:
    case Action::section_far:
      return move_section(action, width_m);
    default:
      return false;
  }
}

bool Marking::grip(const Aim& aim, bool shows_parts) {
  if (!scene_) return false;
  if (shows_parts) held_ = held_at(aim);
  if (held_ && held_->corner == Held::kFixed) {
    const bool is_label = parts_[held_->part].label.has_value();
    held_.reset();
    if (marks_.tool == Tool::none) {
      tell_(is_label ? "This part is drawn in the label image: it is changed there"
                     : "This part is a polygon: its corners are changed in the configuration",
            Priority::information);
      return true;
    }
  }
  if (held_) return true;
  if (marks_.tool == Tool::none) return false;
  if (aim.at_m)
    add_point(*aim.at_m);
  else
    tell_("Nothing was measured there", Priority::information);
  return true;
}

void Marking::save() {
  changed();
  if (unreadable_) return;
  if (!home_) {
    if (!std::exchange(told_, true))
      tell_("This scene lies in no folder: notes are lost when the window closes", Priority::information);
    return;
  }
  try {
    write_notes(moved(marks_.notes, home_from_grid(scene_->description(), home_->description())),
                home_->folder() / scene::kNotesFile);
  } catch (const Error& error) {
    if (!std::exchange(told_, true)) tell_("The notes are not kept: " + error.wrong(), Priority::warning);
  }
}

// The newest profile, and all measures, each as a table.
void Marking::save_files() {
  if (marks_.notes.measures.empty()) return tell_("Nothing has been measured", Priority::information);
  try {
    const std::string table = dated_name("sparsha-measures", ".csv");
    write_measures(marks_.notes.measures, table);
    std::string words = "Saved " + table;
    if (!marks_.profile.empty()) {
      const std::string profile = dated_name("sparsha-profile", ".csv");
      write_profile(marks_.profile, profile);
      words += " and " + profile;
    }
    tell_(words, Priority::information);
  } catch (const Error& error) {
    tell_("Not saved: " + error.wrong(), Priority::warning);
  }
}

}  // namespace sparsha::viewer
