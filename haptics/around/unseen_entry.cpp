#include "haptics/around/unseen_entry.h"

#include <algorithm>

#include "haptics/around/holding_face.h"

namespace sparsha::haptics {
namespace {

constexpr double kAskStep = 0.5;   // cells of the hand's way
constexpr double kDeepest = 1.5;   // cells: of a hand below the face that it is given
constexpr double kFarthest = 3.0;  // cells: of a hand from where it was outside

bool is_behind_any(std::span<const Passing> faces, const Eigen::Vector3d& hand_m) noexcept {
  return std::any_of(faces.begin(), faces.end(),
                     [&](const Passing& face) { return face.height_m(hand_m) < static_cast<double>(face.high_m); });
}

}  // namespace

std::optional<Crossing> entered_unseen(const ObjectSurface& object, const Eigen::Vector3d& hand_m,
                                       FreeHand& free) noexcept {
  const double h = object.spacing_m;
  if (free.asked && (hand_m - free.asked_m).squaredNorm() < kAskStep * kAskStep * h * h) return {};
  const std::span<const Passing> faces = object.blocks.sheets_at(hand_m);
  if (faces.empty()) return {};
  free.asked = true;
  free.asked_m = hand_m;
  if (!is_behind_any(faces, hand_m) || !object.enclosure->holds(hand_m)) {
    free.outside = true;
    free.outside_m = hand_m;
    return {};
  }
  free.outside = free.outside && (hand_m - free.outside_m).norm() <= kFarthest * h;
  if (!free.outside) return {};
  const auto face = face_towards(object, hand_m, free.outside_m);
  if (!face) return {};
  const Eigen::Vector3d place_m = object.sheets[face->sheet].to_object(face->local_m);
  return (place_m - hand_m).norm() <= kDeepest * h ? face : std::nullopt;
}

}  // namespace sparsha::haptics
