// The foot that an object stands on, custom, and the mirror symmetry of what is upright.
#include "pipeline/orient/front.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "pipeline/orient/foot.h"
#include "pipeline/orient/likeness.h"
#include "pipeline/orient/mantle.h"
#include "pipeline/orient/room.h"
#include "pipeline/orient/upright.h"

namespace sparsha::pipeline {
namespace {

constexpr double kCustom = 0.35;        // what custom is worth beside a foot's share
constexpr double kOtherCustom = 0.25;   // of the other of y and z
constexpr double kSideways = 0.15;      // less for x, which no custom calls up: flat ends are walls more often
constexpr double kUpsideDown = 0.25;    // less for what custom calls down
constexpr double kTilted = 0.25;        // less for a base that lies along no axis of the scan
constexpr double kEvidentFoot = 0.2;    // more than that of the opposite side
constexpr double kAlongUp = 0.6;        // cosine: a side that is open nearly above or below is no front
constexpr double kClearly = 0.1;        // more than another way to stand has, by its plane of symmetry
constexpr double kFace = 0.4;           // of a face that is e times less of one
constexpr double kMostFace = 0.8;       // that no face takes away more than
constexpr std::size_t kOutline = 4000;  // points that an outline is taken from

// Directions up from bases that lie along no axis of the scan.
std::vector<Eigen::Vector3d> tilted_bases(const EvenPoints& object) {
  EvenPoints fewer = object;
  const std::size_t step = std::max<std::size_t>(1, object.points.size() / kOutline);
  for (std::size_t i = 0; i * step < object.points.size(); ++i) fewer.points[i] = object.points[i * step];
  fewer.points.resize((object.points.size() + step - 1) / step);
  std::vector<Eigen::Vector3d> bases;
  for (const Eigen::Vector3d& start : sides_all_around()) {
    const Eigen::Vector3d up = levelled(fewer, start);
    // Nearly along an axis it is that axis: feet and chins of statues that stand upright are level by chance only.
    if (up.cwiseAbs().maxCoeff() < std::cos(5.0 * std::numbers::pi / 180.0)) bases.push_back(up);
  }
  return bases;
}

Standing standing_of_room(const Room& room) {
  Eigen::Index axis = 0;
  const double most = room.up.cwiseAbs().maxCoeff(&axis);
  const std::string name = most < 1.0 - 1e-9 ? std::string("up is")
                                             : fmt::format("{}{} is up:", room.up[axis] < 0.0 ? "-" : "", "xyz"[axis]);
  Standing standing{room.up,
                    fmt::format("{} from floor to ceiling ({:.0f} and {:.0f} % of the plan), {}", name,
                                100.0 * room.floor, 100.0 * room.ceiling,
                                room.by_things ? "of which what stands in the room is nearer to the floor"
                                               : "of which custom tells the floor"),
                    {},
                    false,
                    true};
  if (room.open_side && std::abs(room.open_side->dot(room.up)) < kAlongUp) standing.open_side = room.open_side;
  return standing;
}

// A direction that may be up, and what speaks for it.
struct Upright {
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  double foot = 0.0;    // share of the outline that it would stand on, beyond that of the opposite side
  double custom = 0.0;  // what custom is worth beside it
  double face = 0.0;    // the same of the best face around it, zero or less

  [[nodiscard]] double worth() const { return foot + custom + face; }
};

// The worth of the best view around a direction. Upside down it is the same. A flat end to the viewer is a base or a
// back, and no face.
double face_around(const EvenPoints& object, const Eigen::Vector3d& up) {
  const FaceRing ring(object, up);
  double most = 0.0;
  for (std::size_t k = 0; k < FaceRing::kTurns; ++k) {
    if (ring.worth()[k] <= most) continue;
    const double carved = 1.0 - std::min(1.0, foot_of(object, -ring.direction(static_cast<double>(k))));
    most = std::max(most, ring.worth()[k] * carved * carved * carved);
  }
  return most;
}

// Of directions along the axes of the scan and of others, the one of most worth. Faces are looked for around an other
// one only where its foot alone makes it the best.
Upright most_upright(const EvenPoints& object, const std::vector<Upright>& along_axes, std::vector<Upright> others) {
  Eigen::Vector3d faces;
  for (const Eigen::Index axis : {0, 1, 2}) faces[axis] = face_around(object, Eigen::Vector3d::Unit(axis));
  const double most = std::max(faces.maxCoeff(), 1e-300);
  const auto worth_of = [&](double face) {
    return std::clamp(kFace * std::log(std::max(face, 1e-300) / most), -kMostFace, 0.0);
  };
  Upright best;
  double most_worth = -2.0;
  const auto offer = [&](Upright upright, double face) {
    upright.face = worth_of(face);
    if (upright.worth() <= most_worth + 1e-9) return;
    best = upright;
    most_worth = best.worth();
  };
  for (const Upright& upright : along_axes) {
    Eigen::Index axis = 0;
    upright.up.cwiseAbs().maxCoeff(&axis);
    offer(upright, faces[axis]);
  }
  std::stable_sort(others.begin(), others.end(),
                   [](const Upright& a, const Upright& b) { return a.worth() > b.worth(); });
  for (const Upright& upright : others)
    if (upright.worth() > most_worth) offer(upright, face_around(object, upright.up));
  return best;
}

Standing standing_by(const UprightBySymmetry& upright, const Standing& custom, bool z_up) {
  Standing standing;
  standing.up = upright.up;
  standing.face = upright.face;
  standing.open = !upright.face && upright.rival > upright.worth - kClearly;
  standing.reason = upright.face ? "a face is upright in its plane of symmetry"
                    : upright.foot > kEvidentFoot
                        ? upright.up == custom.up
                              ? fmt::format("{} is up: it stands on a flat base", z_up ? "z" : "y")
                              : fmt::format("it stands on a flat base ({:.0f} % of its outline)", 100.0 * upright.foot)
                    : upright.up == custom.up
                        ? custom.reason
                        : "of the ways to stand, by foot and by its plane of symmetry, this one is best";
  return standing;
}

// What is round, as columns and vases are, stands along its axis: on the end that is closed, which custom outweighs
// where that is all that tells, as of a bell.
std::optional<Standing> standing_of_round(const EvenPoints& object, const Standing& custom,
                                          const Eigen::Vector3d& other) {
  constexpr std::size_t kSome = 6'000;
  constexpr double kNearAxis = 0.9986;  // cosine of 3 degrees
  std::vector<Eigen::Vector3d> some;
  const std::size_t step = std::max<std::size_t>(1, object.points.size() / kSome);
  for (std::size_t i = 0; i < object.points.size(); i += step) some.push_back(object.points[i]);
  const std::optional<FoundMantle> mantle = mantle_of_round(some, custom.up);
  if (!mantle) return std::nullopt;
  Eigen::Vector3d axis = mantle->unroll.axis->normalized();
  Eigen::Index longest = 0;
  if (axis.cwiseAbs().maxCoeff(&longest) > kNearAxis)
    axis = (axis[longest] < 0.0 ? -1.0 : 1.0) * Eigen::Vector3d::Unit(longest);
  const auto worth = [&](const Eigen::Vector3d& up) {
    constexpr double kClosed = 0.45, kWide = 0.3;  // of an end that is filled, and of its share of the outline
    const double custom_worth = up == custom.up ? kCustom : up == other ? kOtherCustom : 0.0;
    const Stand stand = stand_of(object, up);
    if (stand.tip_deg < kLeastTip_deg) return custom_worth;
    return custom_worth + kClosed * stand.filled * stand.filled + kWide * stand.foot;
  };
  const double upwards = worth(axis), downwards = worth(-axis);
  Standing standing;
  standing.up = downwards > upwards ? Eigen::Vector3d(-axis) : axis;
  standing.open = std::abs(upwards - downwards) < kClearly;
  standing.reason = "it is round, and its axis is upright";
  return standing;
}

// What is round and open on one side is a bowl or a bell: an axis of the scan that custom calls up tells, since it was
// laid along it.
void turn_bowl_over(const EvenPoints& object, Standing& standing) {
  constexpr double kAlongAxis = 0.98;
  if (standing.face || std::min(standing.up.y(), standing.up.z()) > -kAlongAxis) return;
  if (!is_round_on_a_rim(object, standing.up)) return;
  standing.up = -standing.up;
  standing.reason = fmt::format("it is round and open on one side, and {} is up", standing.up.z() > 0.5 ? "z" : "y");
}

Standing standing_of_solid(const EvenPoints& object, bool z_up, const std::vector<Eigen::Vector3d>& tilted) {
  const Standing custom = customary_standing(z_up);
  const Eigen::Vector3d other = customary_standing(!z_up).up;
  if (const std::optional<UprightBySymmetry> upright =
          upright_by_symmetry(object, {CustomaryUp{custom.up, kCustom}, CustomaryUp{other, kOtherCustom}}))
    return standing_by(*upright, custom, z_up);
  std::vector<Upright> along_axes, others;
  const auto add = [&](std::vector<Upright>& uprights, const Eigen::Vector3d& up, double custom_worth) {
    uprights.push_back({up, std::max(0.0, foot_of(object, up) - foot_of(object, -up)), custom_worth, 0.0});
  };
  add(along_axes, custom.up, kCustom);
  add(along_axes, other, kOtherCustom);
  for (const double side : {1.0, -1.0}) add(along_axes, side * Eigen::Vector3d::UnitX(), -kSideways);
  for (const Eigen::Vector3d& up : {custom.up, other}) add(along_axes, -up, -kUpsideDown);
  for (const Eigen::Vector3d& up : tilted) add(others, up, -kTilted);
  const Upright best = most_upright(object, along_axes, std::move(others));
  Standing standing;
  standing.up = best.up;
  standing.reason = best.up == custom.up ? best.foot > kEvidentFoot
                                               ? fmt::format("{} is up: it stands on a flat base", z_up ? "z" : "y")
                                               : custom.reason
                    : best.foot > kEvidentFoot
                        ? fmt::format("it stands on a flat base ({:.0f} % of its outline)", 100.0 * best.foot)
                        : "of the ways to stand, by foot and by the mirror symmetry of its carving, this one is best";
  return standing;
}

}  // namespace

Standing customary_standing(bool z_up) {
  if (z_up) return {Eigen::Vector3d::UnitZ(), "z is up by custom"};
  return {Eigen::Vector3d::UnitY(), "y is up by custom"};
}

std::optional<Standing> standing_of(const EvenPoints& object, bool z_up) {
  if (object.points.size() < 4) return std::nullopt;
  const std::vector<Eigen::Vector3d> tilted = tilted_bases(object);
  if (const std::optional<Room> room = room_of(object, tilted)) return standing_of_room(*room);
  Standing standing = standing_of_solid(object, z_up, tilted);
  if (!standing.face) {
    std::optional<Standing> round = standing_of_round(object, customary_standing(z_up), customary_standing(!z_up).up);
    if (round) return round;
  }
  turn_bowl_over(object, standing);
  return standing;
}

}  // namespace sparsha::pipeline
