// Turns keys and mouse into orientation, crop and requests.
#include "viewer/cloud/controller.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace sparsha::viewer {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kStep_rad = 5.0 * kDegree;
constexpr double kFineStep_rad = 0.5 * kDegree;
constexpr double kRadPerPixel = 0.008;
constexpr double kPreview_s = 0.05;  // between previews while the object turns
constexpr double kGesture_s = 0.5;
constexpr double kRest_s = 0.30;        // then one of all points
constexpr std::size_t kQuick = 60000;   // points of a preview while the object turns
constexpr std::size_t kFull = 1500000;  // and at rest
constexpr double kFitShare = 0.82;      // of the picture
constexpr double kHandle_px = 14.0;
constexpr std::size_t kMostUndo = 200;

}  // namespace

const char* name_of(CloudColour colour) {
  constexpr std::array<const char*, 4> kNames{"Scan", "Intensity", "Height", "Stations"};
  return kNames[static_cast<std::size_t>(colour)];
}

bool has_colour(const PointView& points, CloudColour colour) {
  switch (colour) {
    case CloudColour::scan:
      return !points.rgba.empty();
    case CloudColour::intensity:
      return !points.intensity.empty();
    case CloudColour::stations:
      return !points.station.empty();
    case CloudColour::height:
      break;
  }
  return true;
}

CloudController::CloudController(Orienting orienting) : orienting_(std::move(orienting)) {}

void CloudController::press(const KeyPress& press) {
  if (const auto action = cloud_action_of(press)) act(*action);
}

void CloudController::turn(const Eigen::Matrix4d& scan_to_grid, bool keep_fit) {
  // The steps of one gesture are undone at once.
  const bool goes_on = keep_fit && !before_.empty() && frame_.time_s - turned_s_ < kGesture_s;
  if (!goes_on) before_.push_back(frame_.setup.scan_to_grid);
  if (before_.size() > kMostUndo) before_.erase(before_.begin());
  frame_.setup.scan_to_grid = scan_to_grid;
  touched_ = preview_due_ = true;
  preview_full_ = false;
  turned_s_ = frame_.time_s;
  if (!keep_fit) fits_ = true;
}

UpAxis CloudController::up() const {
  return frame_.up.value_or(UpAxis(frame_.status.points && frame_.status.points->z_up));
}

void CloudController::set_up(UpAxis up) {
  frame_.up = up;
  turn(seen_from(Face::front, up, frame_.setup.scan_to_grid), false);
  words_.push_back(fmt::format("Up axis: {}", up.name()));
}

void CloudController::turn_by(double about_x, double about_y, double about_z) {
  const Eigen::Matrix4d& now = frame_.setup.scan_to_grid;
  Eigen::Matrix4d next = frame_.free_ball ? rolled(now, about_x, about_y, 0.0) : turned(now, up(), about_y, about_x);
  if (about_z != 0.0) next = rolled(next, 0.0, 0.0, about_z);
  // The middle of the picture stays: the target is a place on the object.
  turn(next, true);
}

bool CloudController::set_side(CloudAction action) {
  const Eigen::Matrix4d& now = frame_.setup.scan_to_grid;
  switch (action) {
    case CloudAction::front:
    case CloudAction::rear:
    case CloudAction::left:
    case CloudAction::right:
    case CloudAction::top:
    case CloudAction::bottom: {
      const auto face = static_cast<Face>(static_cast<int>(action) - static_cast<int>(CloudAction::front));
      turn(seen_from(face, up(), now), false);
      words_.emplace_back(info_of(action).label);
      return true;
    }
    case CloudAction::flat_face:
    case CloudAction::broad_side:
      if (orienting_.find_face && !frame_.status.busy)
        orienting_.find_face(action == CloudAction::flat_face ? scene::OrientationConfig::Face::plane
                                                              : scene::OrientationConfig::Face::principal,
                             frame_.setup);
      return true;
    case CloudAction::as_scanned:
      turn(sparsha::viewer::as_scanned(now), false);
      words_.emplace_back("As scanned");
      return true;
    case CloudAction::upright:
      turn(sparsha::viewer::upright(now, up()), false);
      words_.emplace_back("Upright");
      return true;
    case CloudAction::up_axis: {
      const std::span<const UpAxis> axes = all_up_axes();
      const auto next = std::ranges::find(axes, up()) + 1;
      set_up(next == axes.end() ? axes.front() : *next);
      return true;
    }
    case CloudAction::undo:
      if (before_.empty()) return true;
      frame_.setup.scan_to_grid = before_.back();
      before_.pop_back();
      preview_due_ = true;
      preview_full_ = false;
      turned_s_ = frame_.time_s;
      return true;
    default:
      return false;
  }
}

bool CloudController::turn_step(CloudAction action) {
  switch (action) {
    case CloudAction::turn_left:
      turn_by(0.0, -kStep_rad, 0.0);
      return true;
    case CloudAction::turn_right:
      turn_by(0.0, kStep_rad, 0.0);
      return true;
    case CloudAction::tilt_up:
      turn_by(-kStep_rad, 0.0, 0.0);
      return true;
    case CloudAction::tilt_down:
      turn_by(kStep_rad, 0.0, 0.0);
      return true;
    case CloudAction::roll_left:
      turn_by(0.0, 0.0, kStep_rad);
      return true;
    case CloudAction::roll_right:
      turn_by(0.0, 0.0, -kStep_rad);
      return true;
    case CloudAction::fine_left:
      turn_by(0.0, -kFineStep_rad, 0.0);
      return true;
    case CloudAction::fine_right:
      turn_by(0.0, kFineStep_rad, 0.0);
      return true;
    case CloudAction::fine_up:
      turn_by(-kFineStep_rad, 0.0, 0.0);
      return true;
    case CloudAction::fine_down:
      turn_by(kFineStep_rad, 0.0, 0.0);
      return true;
    default:
      return false;
  }
}

void CloudController::act(CloudAction action) {
  if (set_side(action) || turn_step(action)) return;
  switch (action) {
    case CloudAction::scan:
      return start_scan();
    case CloudAction::save:
    case CloudAction::save_scene:
      return save(action == CloudAction::save_scene);
    case CloudAction::back:
      if (frame_.help) {
        frame_.help = false;
      } else if (frame_.status.busy) {
        cancel();
      } else if (frame_.can_go_back) {
        wishes_.push_back(Wish::back);
      } else if (frame_.time_s - ended_s_ >= kLateStop_s) {
        wishes_.push_back(Wish::quit);
      }
      return;
    case CloudAction::closer:
    case CloudAction::farther:
      return mouse_wheel(action == CloudAction::closer ? 1.0 : -1.0);
    case CloudAction::fit:
      fits_ = true;
      return;
    case CloudAction::free_ball:
      frame_.free_ball = !frame_.free_ball;
      words_.emplace_back(frame_.free_ball ? "Free ball" : "Turntable");
      return;
    case CloudAction::colour: {
      if (!frame_.status.points) return;
      int next = static_cast<int>(frame_.colour);
      do next = (next + 1) % 4;
      while (!has_colour(*frame_.status.points, static_cast<CloudColour>(next)));
      frame_.colour = static_cast<CloudColour>(next);
      words_.push_back(fmt::format("Colour: {}", name_of(frame_.colour)));
      return;
    }
    case CloudAction::crop:
      if (!frame_.status.points) return;
      frame_.edits_crop = !frame_.edits_crop;
      if (!frame_.edits_crop || frame_.setup.crop) return;
      set_crop(scene::CropConfig{frame_.status.points->origin_m + frame_.status.points->low.cast<double>(),
                                 frame_.status.points->origin_m + frame_.status.points->high.cast<double>()});
      return;
    case CloudAction::help:
      frame_.help = !frame_.help;
      return;
    case CloudAction::contrast:
      wishes_.push_back(Wish::contrast);
      return;
    case CloudAction::large_type:
      wishes_.push_back(Wish::large_type);
      return;
    case CloudAction::quit:
      wishes_.push_back(Wish::quit);
      return;
    default:
      return;
  }
}

void CloudController::set_euler(const Eigen::Vector3d& angles_deg) {
  if (angles_deg.allFinite()) turn(with_euler(angles_deg, frame_.setup.scan_to_grid), true);
}

void CloudController::set_crop(const std::optional<scene::CropConfig>& crop) {
  if (crop && (!crop->min_m.allFinite() || !crop->max_m.allFinite())) return;
  frame_.setup.crop = crop;
  if (frame_.setup.crop) {
    const Eigen::Vector3d low = crop->min_m.cwiseMin(crop->max_m), high = crop->min_m.cwiseMax(crop->max_m);
    frame_.setup.crop = scene::CropConfig{low, high};
  } else {
    frame_.edits_crop = false;
  }
  touched_ = preview_due_ = true;
  preview_full_ = false;
  turned_s_ = frame_.time_s;
}

void CloudController::set_unit(scene::LengthUnit unit) {
  if (orienting_.set_unit && !frame_.status.busy) orienting_.set_unit(unit);
}

std::optional<Eigen::Vector2d> CloudController::crop_handle(int handle) const {
  if (!frame_.status.points || !frame_.setup.crop) return std::nullopt;
  const scene::CropConfig& crop = *frame_.setup.crop;
  Eigen::Vector3d place = 0.5 * (crop.min_m + crop.max_m);
  const int axis = handle / 2;
  place[axis] = handle % 2 == 0 ? crop.min_m[axis] : crop.max_m[axis];
  constexpr double kSeen = 0.15;  // sine of the angle between axis and view
  const Eigen::Vector3d direction = frame_.view.scan_to_view.col(axis).normalized();
  if (direction.head<2>().norm() < kSeen) return std::nullopt;
  return frame_.view.to_pixel(place - frame_.status.points->origin_m).head<2>();
}

void CloudController::drag_crop(const Eigen::Vector2d& moved) {
  const int axis = frame_.held / 2;
  const Eigen::Vector3d column = frame_.view.scan_to_view.col(axis);
  const Eigen::Vector2d along(column.x() * frame_.view.pixels_per_m, -column.y() * frame_.view.pixels_per_m);
  if (!(along.squaredNorm() > 0.0)) return;
  const double by_m = moved.dot(along) / along.squaredNorm();
  scene::CropConfig crop = *frame_.setup.crop;
  const double thinnest_m = 1e-6;
  if (frame_.held % 2 == 0) {
    crop.min_m[axis] = std::min(crop.min_m[axis] + by_m, crop.max_m[axis] - thinnest_m);
  } else {
    crop.max_m[axis] = std::max(crop.max_m[axis] + by_m, crop.min_m[axis] + thinnest_m);
  }
  set_crop(crop);
}

void CloudController::mouse_move(double x, double y) {
  const Eigen::Vector2d now(x, y), moved = now - mouse_;
  mouse_ = now;
  if (frame_.held >= 0) return drag_crop(moved);
  if (left_down_ && right_down_) return turn_by(0.0, 0.0, -kRadPerPixel * moved.x());
  if (left_down_) return turn_by(kRadPerPixel * moved.y(), kRadPerPixel * moved.x(), 0.0);
  if (!right_down_ && !middle_down_) return;
  fits_ = false;
  const Eigen::Vector3d in_view(moved.x() / frame_.view.pixels_per_m, -moved.y() / frame_.view.pixels_per_m, 0.0);
  frame_.view.target_m -= frame_.view.scan_to_view.inverse() * in_view;
}

void CloudController::mouse_button(int button, bool down, int /*modifiers*/) {
  if (button == 1) right_down_ = down;
  if (button == 2) middle_down_ = down;
  if (button != 0) return;
  left_down_ = down;
  frame_.held = -1;
  if (!down || !frame_.edits_crop) return;
  double nearest = kHandle_px * kHandle_px;
  for (int handle = 0; handle < 6; ++handle) {
    const auto at = crop_handle(handle);
    if (!at || (*at - mouse_).squaredNorm() > nearest) continue;
    nearest = (*at - mouse_).squaredNorm();
    frame_.held = handle;
  }
}

void CloudController::mouse_wheel(double steps) {
  fits_ = false;
  constexpr double kFarthest = 1e-9, kNearest = 1e12;
  frame_.view.pixels_per_m = std::clamp(frame_.view.pixels_per_m * std::pow(1.12, steps), kFarthest, kNearest);
}

void CloudController::take_status() {
  const bool worked = frame_.status.busy;
  if (orienting_.status) frame_.status = orienting_.status();
  if (worked && !frame_.status.busy) ended_s_ = frame_.time_s;
  const OrientingStatus& status = frame_.status;
  if (status.work != work_) {
    work_ = status.work;
    proposals_ = notes_ = 0;
    touched_ = frame_.edits_crop = false;
    frame_.setup = {};
    before_.clear();
    metres_per_unit_ = 0.0;  // of the other scans
    frame_.preview = {};
    ++frame_.previews;
  }
  if (status.notes != notes_) {
    notes_ = status.notes;
    words_.push_back(status.note);
  }
  if (status.points.get() == shown_) return;
  shown_ = status.points.get();
  if (shown_ != nullptr) {
    // The same scans in another unit: the box stays on the object.
    const double before = metres_per_unit_;
    metres_per_unit_ = shown_->metres_per_unit;
    if (frame_.setup.crop && before > 0.0 && metres_per_unit_ > 0.0 && before != metres_per_unit_) {
      frame_.setup.crop->min_m *= metres_per_unit_ / before;
      frame_.setup.crop->max_m *= metres_per_unit_ / before;
    }
  }
  fits_ = preview_due_ = true;
  preview_full_ = false;
  if (shown_ == nullptr) return;
  if (!has_colour(*shown_, frame_.colour))
    frame_.colour = has_colour(*shown_, CloudColour::intensity) ? CloudColour::intensity : CloudColour::height;
}

void CloudController::take_proposal() {
  const OrientingStatus& status = frame_.status;
  if (status.proposals == proposals_) return;
  const bool first = proposals_ == 0;
  proposals_ = status.proposals;
  // A first view that comes late does not undo what was turned meanwhile.
  if (first && touched_) return;
  turn(status.proposal.scan_to_grid, false);
  if (!first) return;
  frame_.setup.crop = status.proposal.crop;
  before_.clear();
  touched_ = false;
}

void CloudController::fit() {
  const DepthPreview& preview = frame_.preview;
  if (!preview.any) return;
  const Eigen::Vector3d size = preview.size_m().cwiseMax(1e-9);
  SplatView& view = frame_.view;
  view.pixels_per_m = kFitShare * std::min(view.width / size.x(), view.height / size.y());
  const Eigen::Vector3d origin = (frame_.setup.scan_to_grid * frame_.status.points->origin_m.homogeneous()).head<3>();
  const Eigen::Vector3d middle = 0.5 * (preview.low_m + preview.high_m) - origin;
  view.target_m = view.scan_to_view.inverse() * middle;
}

void CloudController::update(double time_s, int width, int height, bool can_go_back) {
  frame_.time_s = time_s;
  frame_.can_go_back = can_go_back;
  take_status();
  take_proposal();
  SplatView& view = frame_.view;
  const bool resized = view.width != width || view.height != height;
  if (resized && !fits_) view.pixels_per_m *= static_cast<double>(height) / view.height;
  view.width = std::max(width, 1);
  view.height = std::max(height, 1);
  view.scan_to_view = frame_.setup.scan_to_grid.topLeftCorner<3, 3>();
  if (!frame_.status.points) return;
  const bool rests = frame_.finished || time_s - turned_s_ >= kRest_s;
  if ((preview_due_ && (rests || time_s - preview_s_ >= kPreview_s)) || (rests && !preview_full_)) {
    frame_.preview = preview_of(*frame_.status.points, frame_.setup, rests ? kFull : kQuick);
    ++frame_.previews;
    preview_due_ = false;
    preview_full_ = rests;
    preview_s_ = time_s;
  }
  if (fits_) {
    fit();
    // Once the whole object is in the picture, turning it by hand leaves its size alone.
    fits_ = !preview_full_;
  }
  tell_look();
}

void CloudController::tell_look() {
  const PointView* const points = frame_.status.points.get();
  if (!orienting_.look ||
      (points == looked_at_ && frame_.view == looked_ && same_crop(frame_.setup.crop, looked_crop_)))
    return;
  looked_at_ = points;
  looked_ = frame_.view;
  looked_crop_ = frame_.setup.crop;
  orienting_.look(frame_.view, frame_.setup);
}

bool CloudController::rests() const {
  const OrientingStatus now = orienting_.status ? orienting_.status() : frame_.status;
  const OrientingStatus& seen = frame_.status;
  const bool news = now.work != seen.work || now.points != seen.points || now.proposals != seen.proposals ||
                    now.notes != seen.notes || now.spacing_m != seen.spacing_m || now.scattered != seen.scattered ||
                    now.busy != seen.busy || now.detail != seen.detail || now.refining;
  const bool looking = frame_.status.points && (fits_ || preview_due_ || !preview_full_);
  const bool just_ended = frame_.time_s - ended_s_ < kLateStop_s;  // and time is to go on
  return !news && !now.busy && !looking && !just_ended && wishes_.empty() && words_.empty();
}

CloudController::Wish CloudController::take_wish() {
  if (wishes_.empty()) return Wish::none;
  const Wish first = wishes_.front();
  wishes_.erase(wishes_.begin());
  return first;
}

std::vector<std::string> CloudController::take_words() { return std::exchange(words_, {}); }

}  // namespace sparsha::viewer
