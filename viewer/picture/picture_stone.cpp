// The stone of the picture, its paint, light and heights, and where the hand is over it.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "scene/scene.h"
#include "viewer/object/paint.h"
#include "viewer/picture/picture.h"

namespace sparsha::viewer {
namespace {

constexpr double kBallShare = 0.016;   // of the window's width: the ball's radius
constexpr double kArrowShare = 0.070;  // of the window's width for each newton
constexpr double kStrong_n = 3.0;

}  // namespace

void Picture::set_object() {
  const std::shared_ptr<const scene::Charts>& charts = scene_->description().charts;
  if (charts == charts_) return;
  charts_ = charts;
  object_.reset();
  if (!is_whole(scene_->description())) return;
  std::vector<ObjectMesh> meshes = make_object_meshes(*charts, pool_);
  if (!meshes.empty()) object_ = std::make_unique<ObjectView>(std::move(meshes), charts->origin_m, charts->spacing_m);
}

void Picture::paint_whole() {
  const scene::SceneDescription& description = scene_->description();
  const Paint paint = paint_relief(whole_->data(), description, colour_, workspace_m_);
  whole_->set_paint(paint);
  legend_ = paint.legend;
  if (object_) {
    const Paint own = paint_object(*object_, {description, workspace_m_, whole_->data(), paint}, colour_);
    object_->set_paint(own);
    legend_ = own.legend;
    ++version_;
  }
  if (coarse_) coarse_->set_paint(paint_relief(coarse_->data(), description, colour_, workspace_m_, &legend_));
  stones_lit_ = false;
}

double Picture::touch_height_at(double x_m, double y_m) const {
  if (const auto height_m = touch_ground_.height_at(x_m, y_m)) return *height_m;
  return touch_ground_.waits() ? std::numeric_limits<double>::quiet_NaN() : height_at(x_m, y_m);
}

double Picture::height_at(double x_m, double y_m) const {
  if (!whole_) return 0.0;
  if (piece_) {
    const Eigen::Vector3d world = stage_.to_world({x_m, y_m, 0.0});
    const Box box = piece_->box_world();
    if (world.x() > box[0] && world.y() > box[1] && world.x() < box[2] && world.y() < box[3])
      return piece_->data().height_at(x_m, y_m);
  }
  return whole_->data().height_at(x_m, y_m);
}

bool Picture::known_at(double x_m, double y_m) const {
  if (!whole_) return false;
  const auto known = [&](const ReliefData& data) {
    const scene::Lattice& lattice = data.lattice;
    const double i = std::round((x_m - lattice.origin_m.x()) / lattice.spacing_m);
    const double j = std::round((y_m - lattice.origin_m.y()) / lattice.spacing_m);
    if (!(i >= 0.0 && j >= 0.0 && i < lattice.nx && j < lattice.ny)) return false;
    return data.known[lattice.index(static_cast<int>(i), static_cast<int>(j))] != 0;
  };
  return (piece_ && known(piece_->data())) || known(whole_->data());
}

// Shadows are hard while the light moves, and soft once it rests.
void Picture::set_light(bool fine) {
  light_fine_ = fine;
  whole_->set_light(light_, pool_, fine);
  if (coarse_) coarse_->set_light(light_, pool_, fine);
  if (piece_) piece_->set_light(light_, pool_, fine);
  stones_lit_ = false;
}

void Picture::light_stones(bool high_contrast, Look look) {
  if (stones_lit_ && high_contrast_ == high_contrast && look_ == look) return;
  high_contrast_ = high_contrast;
  look_ = look;
  stones_lit_ = true;
  whole_->light_stone(stone_program_, high_contrast, look);
  if (coarse_) coarse_->light_stone(stone_program_, high_contrast, look);
  if (piece_) piece_->light_stone(stone_program_, high_contrast, look);
  ++version_;
}

std::optional<Hand> Picture::hand_of(const haptics::State& state, const Window& window) const {
  if (state.tick == 0) return std::nullopt;
  const auto vector = [](const std::array<double, 3>& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
  Hand hand;
  hand.proxy = stage_.to_world(vector(haptics::touched_place(state)));
  hand.hip = stage_.to_world(vector(state.hip_m));
  if (!hand.proxy.allFinite() || !hand.hip.allFinite()) return std::nullopt;
  const Eigen::Vector3d normal = vector(state.normal);
  hand.contact = state.contact != 0;
  if (normal.allFinite() && normal.norm() > 0.5) hand.normal = stage_.turn * normal.normalized();
  const double width = window.width_m / stage_.unit_m;
  const Eigen::Vector3d force = vector(state.commanded_force_n);
  if (force.allFinite()) {
    hand.force = force * std::min(kArrowShare, 0.35 / std::max(force.norm(), 1e-9)) * width;
    hand.strength = std::clamp(force.norm() / kStrong_n, 0.0, 1.0);
  }
  if (const auto& turn = state.orientation; turn != std::array<double, 4>{}) {
    const Eigen::Quaterniond turned(turn[0], turn[1], turn[2], turn[3]);
    hand.stylus = turned * Eigen::Vector3d::UnitZ();
    hand.stylus_side = turned * Eigen::Vector3d::UnitY();
  }
  hand.radius = kBallShare * width;
  const Eigen::Vector3d below = stage_.to_grid_m(hand.ball());
  if (object_) {
    const ObjectView::Nearest nearest = object_->nearest(below);
    hand.up = hand.contact ? hand.normal : Eigen::Vector3d(stage_.turn * nearest.normal);
    hand.ground = hand.contact ? hand.proxy : stage_.to_world(nearest.place_m);
    return hand;
  }
  hand.ground = stage_.to_world({below.x(), below.y(), height_at(below.x(), below.y())});
  return hand;
}

}  // namespace sparsha::viewer
