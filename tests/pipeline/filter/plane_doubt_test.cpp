// A plane through a relief is said, a floor beside an object is not: made-up scenes whose own points are known.
#include "pipeline/filter/plane_doubt.h"

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "pipeline/filter/filter.h"
#include "tests/pipeline/filter/labelled.h"

namespace sparsha::pipeline {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kPanel = 0.2;  // half the width of a relief, metres

using Height = std::function<double(double x, double y)>;

/// Smooth hills and dales of +-1, about `apart` metres from each other.
Height hills(unsigned seed, double apart) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
  std::array<double, 4> p{};
  for (double& value : p) value = phase(random);
  const double k = 2.0 * std::numbers::pi / apart;
  return [p, k](double x, double y) {
    return 0.5 * std::sin(k * x + p[0]) * std::cos(0.8 * k * y + p[1]) +
           0.5 * std::sin(k * (1.2 * x + 0.7 * y) + p[2]) * std::cos(k * (1.4 * y - 0.4 * x) + p[3]);
  };
}
/// What of it lies above a ground.
Height figures(unsigned seed, double apart, double ground) {
  return [field = hills(seed, apart), ground](double x, double y) { return std::max(field(x, y), ground) - ground; };
}

/// A height field over a square, its own points on a square lattice of the spacing of the floor's.
void add_relief(LabelledCloud& cloud, double half, double level, const Height& height, double noise,
                std::mt19937& random, std::size_t count = 15000) {
  std::uniform_real_distribution<double> place(-half, half);
  std::normal_distribution<double> error(0.0, noise);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = place(random);
    const double y = place(random);
    cloud.add({x, y, level + height(x, y) + error(random)}, Part::object);
  }
}

/// A floor at z = 0 of half the width `half`, not under the object.
void add_floor(LabelledCloud& cloud, double half, double noise, std::mt19937& random,
               const std::function<bool(double, double)>& under, std::size_t count = 15000) {
  std::uniform_real_distribution<double> place(-half, half);
  std::normal_distribution<double> error(0.0, noise);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = place(random);
    const double y = place(random);
    if (!under(x, y)) cloud.add({x, y, error(random)}, Part::floor);
  }
}
bool in_panel(double x, double y) { return std::max(std::abs(x), std::abs(y)) < kPanel; }

struct Outcome {
  bool warned = false;
  bool refused = false;
  double own_lost = 0.0;  ///< of the object's points
  double removed = 0.0;   ///< of all points
  double guess = 0.0;
};

Outcome outcome(LabelledCloud& scene, scene::RemovePlaneConfig config, double tilt_deg = 0.0) {
  const Eigen::AngleAxisd tilt(tilt_deg * kDegree, Eigen::Vector3d(1.0, 0.6, 0.0).normalized());
  scene.transform(Eigen::Affine3d(Eigen::Translation3d(12.0, -7.0, 3.0) * tilt));
  Cloud cloud = scene.cloud({12.0, -7.0, 3.0});
  Work work;
  Outcome result;
  try {
    const FilterSteps steps = apply_filters(cloud, {config}, work.context());
    result.guess = steps.steps.at(0).of_object;
  } catch (const Error&) {
    result.refused = true;
    return result;
  }
  const double own = static_cast<double>(std::count(scene.parts.begin(), scene.parts.end(), Part::object));
  result.own_lost = own > 0.0 ? 1.0 - static_cast<double>(left_of(scene, cloud)[Part::object]) / own : 0.0;
  result.removed = 1.0 - static_cast<double>(cloud.size()) / static_cast<double>(scene.points_m.size());
  result.warned = !work.progress.warnings().empty();
  return result;
}

scene::RemovePlaneConfig by(double distance_mm,
                            scene::RemovePlaneConfig::Side side = scene::RemovePlaneConfig::Side::below) {
  scene::RemovePlaneConfig config;
  config.distance_m = 1e-3 * distance_mm;
  config.side = side;
  return config;
}

/// All that a made-up scene is judged by: said where a fifth of the object's own points go; else nothing, unless most
/// of all points go.
/// True where a fifth of them went.
bool judge(const std::string& name, LabelledCloud scene, const scene::RemovePlaneConfig& config, bool has_floor,
           double tilt_deg = 0.0) {
  const Outcome got = outcome(scene, config, tilt_deg);
  if (got.refused) return false;
  const std::string told = fmt::format("{}: own points lost {:.3f}, removed {:.3f}, estimated {:.3f}", name,
                                       got.own_lost, got.removed, got.guess);
  if (got.own_lost > 0.2) {
    EXPECT_TRUE(got.warned) << told;
  } else if (has_floor && got.removed < 0.66) {
    EXPECT_FALSE(got.warned) << told;
  }
  return got.own_lost > 0.2;
}

/// Heights of +-1, or 0 to 1, of reliefs that are all of one piece.
std::vector<std::pair<std::string, Height>> reliefs(unsigned seed) {
  const Height fine = hills(seed, 0.07);
  const Height coarse = hills(seed, 0.25);
  const auto frame = [](double x, double y) { return std::max(std::abs(x), std::abs(y)) > 0.85 * kPanel; };
  return {{"fine hills", fine},
          {"coarse hills", coarse},
          {"fine figures", figures(seed, 0.07, 0.1)},
          {"figures on little ground", figures(seed, 0.15, -0.3)},
          {"framed", [f = figures(seed, 0.1, 0.1), frame](double x, double y) { return frame(x, y) ? 1.5 : f(x, y); }},
          {"framed hills", [fine, frame](double x, double y) { return frame(x, y) ? 1.2 : fine(x, y); }},
          {"stepped", [coarse](double x, double y) { return 0.5 * std::round(2.0 * coarse(x, y)); }},
          {"fine steps", [fine](double x, double y) { return 0.25 * std::round(4.0 * fine(x, y)); }},
          {"boss on its slab",
           [](double x, double y) { return std::max(0.0, 1.0 - std::pow(std::hypot(x, y) / (0.95 * kPanel), 4)); }},
          {"carved letters", [fine](double x, double y) { return fine(x, y) > 0.15 ? -1.0 : 0.0; }},
          {"raised letters", [fine](double x, double y) { return fine(x, y) > -0.1 ? 1.0 : 0.0; }}};
}

TEST(PlaneThroughAnObject, IsSaidOfReliefsWithoutAFloor) {
  using Side = scene::RemovePlaneConfig::Side;
  unsigned seed = 100;
  std::size_t said = 0;
  for (const auto& [amplitude_mm, share] : {std::pair{2.0, 0.15}, std::pair{5.0, 0.3}, std::pair{10.0, 0.5},
                                            std::pair{20.0, 0.15}, std::pair{10.0, 0.15}}) {
    ++seed;
    for (const auto& [name, height] : reliefs(seed)) {
      for (const Side side : {Side::below, Side::above, Side::both}) {
        std::mt19937 random(seed);
        LabelledCloud relief;
        add_relief(
            relief, kPanel, 0.0, [&, h = height, a = amplitude_mm](double x, double y) { return 1e-3 * a * h(x, y); },
            2e-5 * amplitude_mm, random);
        const bool lost =
            judge(fmt::format("{}, {} mm, thickness {}, side {}", name, amplitude_mm, share, static_cast<int>(side)),
                  relief, by(share * amplitude_mm, side), false, seed % 2 == 0 ? 0.0 : 7.0);
        said += lost ? 1 : 0;
      }
    }
  }
  EXPECT_GE(said, 60U) << "of 165: else there is nothing to say";
}

TEST(PlaneThroughAnObject, IsNotSaidOfAFloor) {
  unsigned seed = 200;
  for (const double amplitude_mm : {2.0, 10.0, 20.0}) {
    for (const double tilt_deg : {0.0, 7.0}) {
      for (const double wider : {1.25, 1.6}) {
        std::mt19937 random(++seed);
        const double amplitude = 1e-3 * amplitude_mm;
        const std::string name = fmt::format(" of {} mm, floor of {}, tilted {}", amplitude_mm, wider, tilt_deg);
        const auto floor = static_cast<std::size_t>(15000 * wider * wider);
        LabelledCloud slab;
        add_relief(
            slab, kPanel, 0.03, [&, f = hills(seed, 0.07)](double x, double y) { return amplitude * f(x, y); }, 2e-4,
            random);
        add_floor(slab, wider * kPanel, 2e-4, random, in_panel, floor);
        judge("relief on a floor" + name, slab, by(2.0), true, tilt_deg);
        LabelledCloud framed;
        add_relief(
            framed, kPanel, 0.01,
            [&, f = figures(seed, 0.1, 0.1)](double x, double y) {
              return std::max(std::abs(x), std::abs(y)) > 0.85 * kPanel ? 1.5 * amplitude : amplitude * f(x, y);
            },
            2e-4, random);
        add_floor(framed, wider * kPanel, 2e-4, random, in_panel, floor);
        judge("framed relief on a floor" + name, framed, by(2.0), true, tilt_deg);
        // A coin of 2 to 20 mm, round, on a table.
        LabelledCloud coin;
        const double radius = 1.2 * kPanel / wider;
        const auto on_coin = [&](double x, double y) { return std::hypot(x, y) < radius; };
        std::uniform_real_distribution<double> place(-radius, radius);
        for (int i = 0; i < 15000; ++i) {
          const double x = place(random);
          const double y = place(random);
          if (on_coin(x, y)) coin.add({x, y, amplitude}, Part::object);
        }
        add_floor(coin, 1.6 * kPanel, 1e-4, random, on_coin, 20000);
        judge("coin" + name, coin, by(0.5), true, tilt_deg);
        // Statues: a ball, and three of them in a row.
        for (const int balls : {1, 3}) {
          LabelledCloud statues;
          for (int k = 0; k < balls; ++k) {
            add_sphere(statues, {0.3 * (k - balls / 2), 0.1 * k}, 0.12, 0.0, 12000, 2e-4, Part::object, random);
          }
          add_floor(statues, 0.45 * wider, 2e-4, random, [&](double x, double y) {
            for (int k = 0; k < balls; ++k) {
              if (std::hypot(x - 0.3 * (k - balls / 2), y - 0.1 * k) < 0.11) return true;
            }
            return false;
          });
          judge(std::to_string(balls) + " balls" + name, statues, by(2.0), true, tilt_deg);
        }
        // A bust on a table over the floor of the room.
        LabelledCloud table;
        add_sphere(table, {0, 0}, 0.12, 0.0, 12000, 2e-4, Part::object, random);
        add_floor(
            table, 0.5, 2e-4, random, [](double x, double y) { return std::hypot(x, y) < 0.1; }, 16000);
        add_square(table, 0.6 * wider, -0.5 - amplitude, 6000, 2e-4, Part::floor, random);
        judge("bust on a table" + name, table, by(2.0), true, tilt_deg);
      }
    }
  }
}

}  // namespace
}  // namespace sparsha::pipeline
