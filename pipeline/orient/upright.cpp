// The plane of symmetry leaves one angle open.
#include "pipeline/orient/upright.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <Eigen/Geometry>

#include "pipeline/orient/foot.h"
#include "pipeline/orient/human_face.h"

namespace sparsha::pipeline {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSymmetric = 0.72;     // of a mirror image: a walking lion has 0.78, one without symmetry 0.6
constexpr double kAsAlike = 0.06;       // less than the best: heads are alike before and behind, too
constexpr std::size_t kMostPlanes = 3;  // what is round has many, each with its axis in it
constexpr std::size_t kViews = 24;      // around the plane, 15 degrees apart
constexpr double kView = 2.0 * std::numbers::pi / static_cast<double>(kViews);
constexpr double kChance = 0.56;        // likeness of a face, over 45 degrees, that what has none does not reach
constexpr double kFaceSure = 0.035;     // over that
constexpr double kFace = 1.0;           // worth of a sure face beside those of feet and custom
constexpr std::size_t kFewestLegs = 3;  // two are ears or horns
constexpr double kLegs = 0.15;          // worth of them: bodies lie on their back as well as they stand
constexpr double kCarvedTop = 0.5;      // less for what shows twice as much carving from above as from beside
constexpr double kOffPlane = 8.0;       // degrees: planes of symmetry are found within 2, feet are level within 5
constexpr double kNearAxis = 5.0;     // degrees: feet and chins of statues that stand upright are level by chance only
constexpr double kLevel = 1.5;        // degrees, between a foot and an axis of the scan that was laid along it
constexpr double kLevelFoot = 0.2;    // share of the outline
constexpr double kLevelCustom = 1.0;  // worth of a custom that a level foot agrees with
constexpr double kTells = 0.2;        // worth, below which symmetry tells nothing, as of a ball
constexpr double kElsewhere = 0.71;   // cosine of 45 degrees

// Squared relief of all that is seen.
double carving_of(const SidePicture& picture) {
  double sum = 0.0;
  for (const float height : relief_of(picture)) sum += static_cast<double>(height) * static_cast<double>(height);
  return sum;
}

class Plane {
 public:
  Plane(const EvenPoints& object, const MirrorPlane& mirror) : object_(object), mirror_(mirror) {
    // The first direction is an axis of the object's own, so that a turned one has the same.
    const Eigen::Matrix3d frame = principal_frame(object);
    const Eigen::Index along = std::abs(frame.col(0).dot(mirror.normal)) < 0.8 ? 0 : 1;
    first_ = (frame.col(along) - frame.col(along).dot(mirror.normal) * mirror.normal).normalized();
    second_ = mirror.normal.cross(first_);
    look_for_faces();
  }

  [[nodiscard]] Eigen::Vector3d direction(double angle) const {
    return std::cos(angle) * first_ + std::sin(angle) * second_;
  }
  [[nodiscard]] double angle_of(const Eigen::Vector3d& d) const { return std::atan2(d.dot(second_), d.dot(first_)); }
  [[nodiscard]] bool contains(const Eigen::Vector3d& d) const {
    return std::abs(d.dot(mirror_.normal)) < std::sin(kOffPlane * kDegree);
  }
  // Likeness of a face that looks to `direction(angle - 90)` (side 0) or the other way (side 1), with direction(angle)
  // up: mean over 45 degrees.
  [[nodiscard]] double likeness(double angle, std::size_t side) const {
    const double turns = angle / kView;
    const auto below = static_cast<std::ptrdiff_t>(std::floor(turns));
    const double share = turns - static_cast<double>(below);
    const auto at = [&](std::ptrdiff_t k) { return faces_[view(k)][side]; };
    const auto mean = [&](std::ptrdiff_t k) { return 0.25 * (at(k - 1) + 2.0 * at(k) + at(k + 1)); };
    return (1.0 - share) * mean(below) + share * mean(below + 1);
  }
  // Whether the surest face, if any is sure, looks there, within 45 degrees.
  [[nodiscard]] bool face_looks_to(const Eigen::Vector3d& d) const {
    double most = kChance + 0.5 * kFaceSure;
    bool there = false;
    for (std::size_t k = 0; k < kViews; ++k) {
      for (const std::size_t side : {0U, 1U}) {
        const double angle = kView * static_cast<double>(k);
        const double found = likeness(angle, side);
        if (found <= most) continue;
        most = found;
        there = ahead(direction(angle), side).dot(d) > kElsewhere;
      }
    }
    return there;
  }
  // By how much more carving is seen from above than from beside, 0 to 1.
  [[nodiscard]] double carved_top(double angle) const {
    const auto at = [&](double turns) { return carving_[view(static_cast<std::ptrdiff_t>(std::lround(turns)))]; };
    // A view shows what is ahead(): up is ahead of the view a quarter of a turn on.
    const double turns = angle / kView;
    const double quarter = 0.25 * static_cast<double>(kViews);
    const double beside = std::max({at(turns), at(turns + 2.0 * quarter), sides_carving_});
    return std::clamp(at(turns + quarter) / std::max(beside, 1e-9) - 1.0, 0.0, 1.0);
  }
  [[nodiscard]] Eigen::Vector3d ahead(const Eigen::Vector3d& up, std::size_t side) const {
    const Eigen::Vector3d towards = up.cross(mirror_.normal).normalized();
    return side == 0 ? towards : Eigen::Vector3d(-towards);
  }

 private:
  // Of any number of views on.
  [[nodiscard]] static std::size_t view(std::ptrdiff_t k) {
    constexpr auto kAll = static_cast<std::ptrdiff_t>(kViews);
    return static_cast<std::size_t>((k % kAll + kAll) % kAll);
  }
  void look_for_faces() {
    for (auto& both : faces_) both = {-1.0, -1.0};
    for (std::size_t k = 0; k < kViews; ++k) {
      const Eigen::Vector3d up = direction(kView * static_cast<double>(k));
      const Eigen::Vector3d towards = up.cross(mirror_.normal);
      const Eigen::Vector3d right = up.cross(towards);
      const double axis = object_.half + mirror_.offset * (right.dot(mirror_.normal) > 0.0 ? 1.0 : -1.0);
      const SidePicture picture = picture_from(object_, towards, up);
      const std::array<double, 2> found = face_likeness(picture, axis);
      carving_[k] = carving_of(picture);
      // A face is symmetric: in a plane that is little like one of symmetry chance is more likely.
      const double weight = std::sqrt(mirror_.alike);
      faces_[k][0] = weight * found[0];
      faces_[(k + kViews / 2) % kViews][1] = weight * found[1];
    }
    for (const double side : {1.0, -1.0}) {
      const SidePicture picture = picture_from(object_, side * mirror_.normal, first_);
      sides_carving_ = std::max(sides_carving_, carving_of(picture));
    }
  }

  const EvenPoints& object_;
  MirrorPlane mirror_;
  Eigen::Vector3d first_, second_;
  std::array<std::array<double, 2>, kViews> faces_{};
  std::array<double, kViews> carving_{};  // seen in each view
  double sides_carving_ = 0.0;            // the most of the two views across the plane
};

EvenPoints fewer_of(const EvenPoints& object) {
  constexpr std::size_t kEnough = 6000;
  EvenPoints fewer = object;
  const std::size_t step = std::max<std::size_t>(1, object.points.size() / kEnough);
  for (std::size_t i = 0; i * step < object.points.size(); ++i) fewer.points[i] = object.points[i * step];
  fewer.points.resize((object.points.size() + step - 1) / step);
  return fewer;
}

// Worth of a foot: what it stands on as a share of its outline, less for a rim and for a foot on which it seldom comes
// to rest.
double foot_worth(const Stand& stand) {
  constexpr double kOften = 0.1;  // of all directions from its middle: a bust's base has 0.1, a horse's hooves 0.07
  if (stand.tip_deg < kLeastTip_deg) return 0.0;
  return stand.foot * (0.6 + 0.4 * stand.filled) * std::min(1.0, 0.5 + 0.5 * stand.resting / kOften);
}

// The axis of the scan that is nearly there, else the direction as it is.
Eigen::Vector3d along_axis(const Eigen::Vector3d& direction) {
  Eigen::Index axis = 0;
  if (direction.cwiseAbs().maxCoeff(&axis) < std::cos(kNearAxis * kDegree)) return direction;
  return (direction[axis] < 0.0 ? -1.0 : 1.0) * Eigen::Vector3d::Unit(axis);
}

// What speaks for the directions in one plane.
void add_uprights(const EvenPoints& object, const EvenPoints& fewer, const Plane& plane,
                  const std::array<CustomaryUp, 2>& customs, std::vector<UprightBySymmetry>& all) {
  const auto add = [&](const Eigen::Vector3d& up, const Stand& stand, double custom) {
    UprightBySymmetry upright{up, std::nullopt, stand.foot, foot_worth(stand) + custom, 0.0};
    if (stand.tip_deg >= kLeastTip_deg && legs_of(object, up) >= kFewestLegs) upright.worth += kLegs;
    const double angle = plane.angle_of(up);
    const std::size_t side = plane.likeness(angle, 1) > plane.likeness(angle, 0) ? 1 : 0;
    const double likeness = plane.likeness(angle, side);
    const double sure = std::clamp((likeness - kChance) / kFaceSure, 0.0, 1.0);
    upright.worth += kFace * sure + std::max(0.0, likeness - kChance);
    if (sure > 0.5)
      upright.face = plane.ahead(up, side);
    else
      upright.worth -= kCarvedTop * plane.carved_top(angle);
    all.push_back(upright);
  };
  constexpr int kSteps = 72;  // 5 degrees
  for (int k = 0; k < kSteps; ++k) {
    const Eigen::Vector3d along = plane.direction(2.0 * std::numbers::pi * k / kSteps);
    add(along, {}, 0.0);
    const Eigen::Vector3d level = levelled(fewer, along);
    if (!plane.contains(level)) continue;
    const Eigen::Vector3d up = along_axis(plane.direction(plane.angle_of(level)));
    add(up, stand_of(object, up), 0.0);
  }
  for (const CustomaryUp& custom : customs) {
    if (!plane.contains(custom.up)) continue;
    Stand stand = stand_of(object, custom.up);
    const Eigen::Vector3d level = levelled(fewer, custom.up);
    if (level.dot(custom.up) > std::cos(kNearAxis * kDegree)) {
      const Stand of_level = stand_of(object, level);
      if (foot_worth(of_level) > foot_worth(stand)) stand = of_level;
    }
    // Chance levels no foot with an axis of the scan; but what lies on its back looks up.
    const bool level_foot = level.dot(custom.up) > std::cos(kLevel * kDegree) && stand.foot > kLevelFoot &&
                            stand.tip_deg >= kLeastTip_deg && !plane.face_looks_to(custom.up);
    add(custom.up, stand, custom.worth + (level_foot ? kLevelCustom : 0.0));
  }
}

// Three planes as good as each other that have no axis in common, as what is round has, and are not at right angles, as
// those of a block are: all planes are alike.
bool is_ball(const std::vector<MirrorPlane>& mirrors) {
  constexpr double kNoAxis = 0.1;   // volume spanned by the three normals
  constexpr double kSquare = 0.26;  // cosine of 75 degrees
  if (mirrors.size() < 3) return false;
  const Eigen::Vector3d& a = mirrors[0].normal;
  const Eigen::Vector3d& b = mirrors[1].normal;
  const Eigen::Vector3d& c = mirrors[2].normal;
  const double nearest = std::max({std::abs(a.dot(b)), std::abs(b.dot(c)), std::abs(c.dot(a))});
  return std::abs(a.dot(b.cross(c))) > kNoAxis && nearest > kSquare;
}

}  // namespace

std::optional<UprightBySymmetry> upright_by_symmetry(const EvenPoints& object,
                                                     const std::array<CustomaryUp, 2>& customs) {
  std::vector<MirrorPlane> mirrors = mirror_planes(object, kMostPlanes);
  if (mirrors.empty()) return std::nullopt;
  const double least = std::max(kSymmetric, mirrors.front().alike - kAsAlike);
  std::erase_if(mirrors, [&](const MirrorPlane& mirror) { return mirror.alike < least; });
  if (mirrors.empty()) return std::nullopt;
  if (is_ball(mirrors)) return std::nullopt;
  const EvenPoints fewer = fewer_of(object);
  std::vector<UprightBySymmetry> all;
  for (const MirrorPlane& mirror : mirrors) add_uprights(object, fewer, Plane(object, mirror), customs, all);
  UprightBySymmetry best = all.front();
  for (const UprightBySymmetry& upright : all)
    if (upright.worth > best.worth + 1e-9) best = upright;
  if (best.worth < kTells) return std::nullopt;
  for (const UprightBySymmetry& upright : all)
    if (upright.up.dot(best.up) < kElsewhere) best.rival = std::max(best.rival, upright.worth);
  return best;
}

}  // namespace sparsha::pipeline
