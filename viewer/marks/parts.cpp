// Parts on the stone, dragged by their corners and middles, and the removal of marks.
#include <cmath>
#include <functional>
#include <utility>

#include "base/error.h"
#include "scene/area/regions.h"
#include "scene/scene.h"
#include "viewer/marks/marking.h"

namespace sparsha::viewer {
namespace {

using Priority = haptics::Announcement::Priority;

constexpr double kNearPixels = 14.0;   // of a corner that is gripped
constexpr double kErasePixels = 40.0;  // of a mark that is removed

/// A part of a scene that was not turned.
PartBox drawn(const scene::Scene& scene, std::size_t part) {
  const scene::PartConfig& config = scene.description().config.parts[part];
  if (config.is_box()) return {config.name, config.box_m};
  const scene::Area area = scene::area_of(scene.description(), part);
  if (area.solid() != nullptr) return {config.name, {}, {}, false};  // its outline would lie on the front
  return {config.name, area.bounds_m().value_or(scene::Area::Box{}), area.borders_m(), false};
}

/// What of a part can be pointed at: of a box its corners and its middle, of others the corners of their borders.
std::vector<Eigen::Vector2d> handles_of(const PartBox& part) {
  std::vector<Eigen::Vector2d> handles;
  if (part.is_box) {
    const auto corners = corners_of(part.box_m);
    for (const Eigen::Vector3d& corner : corners) handles.emplace_back(corner.head<2>());
    handles.emplace_back(0.5 * (corners[0] + corners[2]).head<2>());
  }
  for (const auto& border : part.borders_m) handles.insert(handles.end(), border.begin(), border.end());
  return handles;
}

}  // namespace

void Marking::read_parts() {
  parts_ = scene_->description().config.parts;
  marks_.parts_fixed = scene_->description().region_from_grid.has_value();
  marks_.parts.clear();
  if (!marks_.parts_fixed) {
    for (std::size_t part = 0; part < parts_.size(); ++part) marks_.parts.push_back(drawn(*scene_, part));
    return;
  }
  try {
    for (std::size_t part = 0; part < parts_.size(); ++part)
      if (const auto box = scene::part_box(*scene_, part)) marks_.parts.push_back({parts_[part].name, *box});
  } catch (const Error&) {
    // The picture says what cannot be read of the scene.
  }
}

void Marking::add_part(const Eigen::Vector3d& centre_m, double width_m) {
  if (!save_parts_ || marks_.parts_fixed)
    return tell_(marks_.parts_fixed ? "Parts were drawn in another orientation: turn the object back to edit them"
                                    : "Parts cannot be edited here",
                 Priority::information);
  const double half_m = 0.15 * width_m;
  PartBox part;
  part.box_m = {centre_m.x() - half_m, centre_m.y() - half_m, centre_m.x() + half_m, centre_m.y() + half_m};
  marks_.parts.push_back(part);
  marks_.typing.emplace();
  writing_ = Writing::part;
  tell_("Write the part's name, Enter keeps it", Priority::information);
  changed();
}

std::optional<Marking::Held> Marking::held_at(const Aim& aim) const {
  if (!aim.view || marks_.parts_fixed || !save_parts_) return std::nullopt;
  std::optional<Held> best;
  double nearest = kNearPixels;
  for (std::size_t p = 0; p < marks_.parts.size(); ++p) {
    const std::vector<Eigen::Vector2d> handles = handles_of(marks_.parts[p]);
    for (std::size_t c = 0; c < handles.size(); ++c) {
      const Eigen::Vector3d place(handles[c].x(), handles[c].y(), aim.height_at(handles[c].x(), handles[c].y()));
      const auto pixel = aim.view->to_pixel(aim.stage.to_world(place));
      if (!pixel || !((*pixel - aim.pixel).norm() < nearest)) continue;
      nearest = (*pixel - aim.pixel).norm();
      best = Held{p, marks_.parts[p].is_box ? static_cast<int>(c) : Held::kFixed, handles[c], marks_.parts[p].box_m};
    }
  }
  return best;
}

bool Marking::drag(const Aim& aim) {
  if (!held_) return false;
  if (!aim.at_m || held_->part >= marks_.parts.size()) return true;
  const Eigen::Vector2d by = aim.at_m->head<2>() - held_->from_m;
  std::array<double, 4> box = held_->box_m;
  const int c = held_->corner;
  if (c == 0 || c == 3 || c == 4) box[0] += by.x();
  if (c == 1 || c == 2 || c == 4) box[2] += by.x();
  if (c == 0 || c == 1 || c == 4) box[1] += by.y();
  if (c == 2 || c == 3 || c == 4) box[3] += by.y();
  if (box[0] >= box[2] || box[1] >= box[3]) return true;  // a corner stays on its side of the others
  marks_.parts[held_->part].box_m = box;
  changed();
  return true;
}

void Marking::release() {
  const auto held = std::exchange(held_, std::nullopt);
  if (!held || held->part >= parts_.size()) return;
  const auto& box = marks_.parts[held->part].box_m;
  if (box == parts_[held->part].box_m) return;
  parts_[held->part].box_m = box;
  save_parts();
}

// What lies nearest to the mouse; without the mouse over the stone the newest measure.
void Marking::erase(const Aim& aim, bool shows_parts) {
  auto& notes = marks_.notes;
  double nearest = kErasePixels;
  std::function<void()> remove;
  const auto consider = [&](const Eigen::Vector3d& at_m, std::function<void()> work) {
    if (!aim.view) return;
    const auto pixel = aim.view->to_pixel(aim.stage.to_world(at_m));
    if (!pixel || !((*pixel - aim.pixel).norm() < nearest)) return;
    nearest = (*pixel - aim.pixel).norm();
    remove = std::move(work);
  };
  for (std::size_t k = 0; k < notes.pins.size(); ++k) {
    if (aim.view && looks_away(*aim.view, aim.stage, notes.pins[k].at_m, marks_.pin_normals.at(k))) continue;
    consider(notes.pins[k].at_m, [&, k] {
      notes.pins.erase(notes.pins.begin() + static_cast<std::ptrdiff_t>(k));
      face_pins();
      tell_("Pin removed", Priority::information);
      save();
    });
  }
  for (std::size_t k = 0; k < notes.measures.size(); ++k)
    for (const Eigen::Vector3d& point : notes.measures[k].points_m)
      consider(point, [&, k] {
        notes.measures.erase(notes.measures.begin() + static_cast<std::ptrdiff_t>(k));
        follow_profile();
        tell_("Measure removed", Priority::information);
        save();
      });
  if (const auto held = shows_parts ? held_at(aim) : std::nullopt)
    remove = [this, part = held->part] {
      parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(part));
      marks_.parts.erase(marks_.parts.begin() + static_cast<std::ptrdiff_t>(part));
      tell_("Part removed", Priority::information);
      save_parts();
    };
  if (!remove) return tell_("Point at a pin, a measure or a part's corner to remove it", Priority::information);
  remove();
}

void Marking::save_parts() {
  changed();
  if (save_parts_ && !save_parts_(parts_)) read_parts();
}

}  // namespace sparsha::viewer
