// A hand that presses on a floor near the wall of a hollow corner: that it is before the wall does not let it go, and
// floor and wall go on until they meet.
// Lengths are in mean point spacings, h.
#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "haptics/around/around_proxy.h"
#include "tests/support/wandering_hand.h"

namespace sparsha::test {
namespace {

using Eigen::Vector3d;
using haptics::AroundState;
using haptics::AroundUpdate;

double among(double low, double high, std::mt19937_64& random) {
  return low + (high - low) * std::generate_canonical<double, 53>(random);
}

/// A slab with its top at z = 0, and on it a wall whose face looks along -x at x = 0: metres, in its own frame.
class HollowCorner : public ClosedObject {
 public:
  static constexpr double kWide = 1.2, kThick = 0.6;  // of floor and wall; of slab and wall

  explicit HollowCorner(const Eigen::Matrix3d& view) : view_(view) {
    const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
    add(-kWide * x, kWide * x, kWide * y, z);
    add(Vector3d::Zero(), kWide * y, kWide * z, -x);
    add(kWide * z, kThick * x, kWide * y, z);
    add(kThick * x - kThick * z, kWide * y, (kWide + kThick) * z, x);
    add(-kWide * x - kThick * z, kWide * y, kThick * z, -x);
    add(-kWide * x - kThick * z, (kWide + kThick) * x, kWide * y, -z);
    for (const double side : {0.0, kWide}) {
      add(side * y - kWide * x - kThick * z, (kWide + kThick) * x, kThick * z, side > 0.0 ? y : Vector3d(-y));
      add(side * y, kThick * x, kWide * z, side > 0.0 ? y : Vector3d(-y));
    }
  }

  [[nodiscard]] double area_m2() const override {
    double sum = 0.0;
    for (const Face& face : faces_) sum += face.area_m2();
    return sum;
  }
  [[nodiscard]] SurfacePoint sample(std::mt19937_64& random) const override {
    double chosen = among(0.0, area_m2(), random);
    std::size_t k = 0;
    while (k + 1 < faces_.size() && chosen > faces_[k].area_m2()) chosen -= faces_[k++].area_m2();
    const double u = among(0.0, 1.0, random), v = among(0.0, 1.0, random);
    return {view_ * (faces_[k].corner + u * faces_[k].first + v * faces_[k].second), view_ * faces_[k].normal};
  }
  [[nodiscard]] std::optional<double> front_m(double /*x*/, double /*y*/) const override { return std::nullopt; }
  [[nodiscard]] std::array<double, 4> bounds_m() const override { return {-2.0, -2.0, 2.0, 2.0}; }

 private:
  struct Face {
    Vector3d corner, first, second, normal;
    [[nodiscard]] double area_m2() const { return first.norm() * second.norm(); }
  };
  void add(const Vector3d& corner, const Vector3d& first, const Vector3d& second, const Vector3d& normal) {
    faces_.push_back({corner, first, second, normal});
  }
  std::vector<Face> faces_;
  Eigen::Matrix3d view_;
};

/// How the hand comes to its place in the floor.
enum class Way : std::uint8_t { along_floor, straight_down, from_wall };
constexpr std::array<const char*, 3> kWays{"along the floor", "straight down", "back from the wall"};
/// Of a thousand touches so many may be lost: fillets of floor and wall cross at small angles in places.
constexpr std::array<std::size_t, 3> kMostLost{3, 3, 8};

/// Touches whose last of five ticks at rest had no contact.
std::size_t lost_of(const Touched& on, const Eigen::Matrix3d& view, Way way, std::size_t touches,
                    const haptics::SolverOptions& options) {
  const double h = on.h;
  std::mt19937_64 random(5);
  std::size_t lost = 0;
  for (std::size_t k = 0; k < touches; ++k) {
    const double y = among(0.15, 1.05, random), depth = among(0.6, 6.0, random) * h, off = among(0.1, 4.0, random) * h;
    const double step = h * std::exp(among(std::log(0.05), std::log(3.0), random));
    AroundState state;
    AroundUpdate found;
    Vector3d hand(-12.0 * h, y, 6.0 * h);
    const auto move_to = [&](const Vector3d& to) {
      const Vector3d from = hand;
      const int steps = std::max(1, static_cast<int>((to - from).norm() / step));
      for (int tick = 1; tick <= steps; ++tick) {
        hand = from + (to - from) * (static_cast<double>(tick) / steps);
        found = update_around(*on.surface, view * hand - on.surface->origin_m, state, options);
      }
    };
    move_to({-12.0 * h, y, 5.0 * h});
    if (way == Way::straight_down)
      move_to({-off, y, 5.0 * h});
    else
      move_to({-12.0 * h, y, -depth});
    if (way == Way::from_wall) move_to({depth, y, -depth});
    const Vector3d end(-off, y, -depth);
    move_to(end);
    for (int tick = 0; tick < 5; ++tick) move_to(end);
    lost += found.contact ? 0 : 1;
  }
  return lost;
}

/// Is a place on something that was measured or closed, and looks that way?
bool is_covered(const haptics::ObjectSurface& object, const Vector3d& place_m, const Vector3d& normal) {
  constexpr double kGap = 0.7;     // h: faces are rounded where they meet
  constexpr double kCosine = 0.6;  // and turned to each other
  for (const haptics::Passing& passing : object.blocks.sheets_at(place_m)) {
    const haptics::SheetView view = view_of(object.sheets[passing.sheet], place_m);
    if (view.cell >= haptics::kLookCell && std::abs(view.gap_m) <= kGap * object.spacing_m &&
        view.normal.dot(normal) >= kCosine)
      return true;
  }
  return false;
}

TEST(Around, TheFacesOfAHollowCornerGoOnUntilTheyMeet) {
  for (const Eigen::Matrix3d& view : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), turned(5.0, 8.0)}) {
    const Touched on = touched("hollow corner", std::make_shared<HollowCorner>(view), 54'400);
    std::size_t asked = 0, bare = 0;
    for (double y = 0.15; y <= 1.05; y += 0.25 * on.h)
      for (double off = 0.75; off <= 4.0; off += 0.25, asked += 2) {
        const Vector3d on_floor(-off * on.h, y, 0.0), on_wall(0.0, y, off * on.h);
        const Vector3d& origin = on.surface->origin_m;
        bare += is_covered(*on.surface, view * on_floor - origin, view * Vector3d::UnitZ()) ? 0 : 1;
        bare += is_covered(*on.surface, view * on_wall - origin, -view * Vector3d::UnitX()) ? 0 : 1;
      }
    const std::string all = std::to_string(bare) + " bare of " + std::to_string(asked);
    if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
    EXPECT_LE(1'000 * bare, 5 * asked) << all;
  }
}

TEST(Around, TheWallOfAHollowCornerFreesNoHandFromTheFloor) {
  const std::size_t touches = std::getenv("SPARSHA_NIGHTLY") != nullptr ? 20'000 : 400;
  for (const Eigen::Matrix3d& view :
       {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), turned(2.0, 3.0), turned(5.0, 8.0), turned(20.0, 30.0)}) {
    const Touched on = touched("hollow corner", std::make_shared<HollowCorner>(view), 54'400);
    for (const haptics::CellShape shape : {haptics::CellShape::bilinear, haptics::CellShape::rounded}) {
      for (const Way way : {Way::along_floor, Way::straight_down, Way::from_wall}) {
        const std::size_t lost = lost_of(on, view, way, touches, {.shape = shape});
        const std::string all =
            std::to_string(lost) + " lost of " + std::to_string(touches) + " " + kWays[static_cast<std::size_t>(way)];
        if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
        EXPECT_LE(1'000 * lost, kMostLost[static_cast<std::size_t>(way)] * touches) << all;
      }
    }
  }
}

}  // namespace
}  // namespace sparsha::test
