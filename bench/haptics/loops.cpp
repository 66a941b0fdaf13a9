// The tail of stability: random loops of an independent hand on windows of scenes and formulas.
#include "bench/haptics/loops.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include <Eigen/Geometry>

#include "base/threads/thread_pool.h"
#include "bench/haptics/free_hand.h"
#include "haptics/servo/haptic_renderer.h"
#include "haptics/window/window.h"
#include "scene/frame/workspace.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

constexpr double kDuration_s = 10.0;
constexpr double kResting_s = 2.0;  // at the end
constexpr double kReach_m = 0.05;   // a device's workspace goes so far on either side
constexpr double kFastest_m_per_s = 0.5;

struct Window {
  std::string name;
  haptics::HapticWindow smooth, rough;  // without and with friction
};

class Chance {
 public:
  explicit Chance(std::uint64_t seed) : random_(seed) {}
  double between(double least, double most) { return least + (most - least) * one(); }
  /// Evenly in the logarithm.
  double over(double least, double most) { return least * std::pow(most / least, one()); }
  std::size_t index(std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(one() * static_cast<double>(count)));
  }
  bool of(double share) { return one() < share; }

 private:
  double one() { return std::generate_canonical<double, 53>(random_); }
  std::mt19937_64 random_;
};

/// What a loop's device knows and says of its delay.
struct Knowledge {
  double undeclared_s = 0.002;  ///< that it says
  /// It measures its delay, 0.3 to 1.7 ms as on a bus, but for up to so much; negative: it measures nothing of the up
  /// to 2 ms beyond the declared one.
  double hidden_s = -1.0;
};

struct Loop {
  std::size_t window = 0;
  bool friction = false, stroke = false;
  FreeHand hand;
  haptics::DeviceInfo device;
  double measured_s = 0.0;
  double press_n = 1.0, encoder_m = 20e-6, reach_m = 0.01, speed_hz = 0.4, angle = 0.0;
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();  // device frame
};

struct Outcome {
  /// Most that the hand got beyond what the spring held, from any moment on. What the spring holds at the end of that
  /// time is not delivered yet: a force that was cut on the way in may leave in it what no hand has paid for.
  double delivered_j = 0.0;
  double steps = 0.0;  // of swing; of those that rest
  bool rests = false;
  double stiffness_n_per_m = 0.0, force_n = 0.0;
};

Loop random_loop(std::uint64_t seed, std::size_t windows, const Knowledge& knowledge) {
  Chance chance(seed);
  Loop loop;
  loop.window = chance.index(windows);
  loop.friction = chance.of(0.5);
  loop.stroke = chance.of(0.67);
  loop.hand.mass_kg = chance.over(0.05, 0.5);
  loop.hand.damping_n_s_per_m = chance.over(0.5, 5.0);
  loop.hand.grip_n_per_m = chance.over(50.0, 500.0);
  const double late = chance.between(0.0, 1.0);
  loop.device.limits.undeclared_s = knowledge.undeclared_s;
  loop.press_n = chance.over(0.3, 3.0);
  loop.encoder_m = chance.over(10e-6, 60e-6);
  loop.reach_m = chance.over(0.003, 0.025);
  loop.speed_hz = chance.over(0.15, 1.0);
  loop.angle = chance.between(0.0, 2.0 * std::numbers::pi);
  loop.place_m = {chance.between(-0.025, 0.025), chance.between(-0.025, 0.025)};
  if (knowledge.hidden_s >= 0.0) loop.measured_s = chance.between(0.0003, 0.0017);
  loop.hand.delay_s = knowledge.hidden_s < 0.0 ? 0.001 + 0.002 * late : loop.measured_s + knowledge.hidden_s * late;
  return loop;
}

/// In the spring that the hand feels: its force ends at 8 N.
double stored_of(double force_n, double stiffness_n_per_m) {
  constexpr double kMost_n = 8.0;
  if (!(stiffness_n_per_m > 0.0)) return 0.0;
  const double felt_n = std::min(force_n, kMost_n);
  return (0.5 * felt_n + force_n - felt_n) * felt_n / stiffness_n_per_m;
}

Outcome run(const Loop& loop, const Window& at) {
  haptics::HapticRenderer renderer(loop.device, haptics::RendererOptions{}, loop.friction ? at.rough : at.smooth);
  const haptics::MongeSurface& surface = *renderer.window().surface;
  const Vector3d centre_m = renderer.window().surface->centre_m;
  const auto stone_m = [&](double x, double y) {  // device frame
    return surface.scale * (surface.height(centre_m.x() + x / surface.scale - surface.lattice.origin_m.x(),
                                           centre_m.y() + y / surface.scale - surface.lattice.origin_m.y()) +
                            surface.lattice.origin_m.z() - centre_m.z());
  };
  // What a hand follows is the coarse shape: a mean over 6 mm.
  const auto shape_m = [&](double x, double y) {
    double sum = 0.0;
    for (int a = -1; a <= 1; ++a)
      for (int b = -1; b <= 1; ++b) sum += stone_m(x + 0.002 * a, y + 0.002 * b) / 9.0;
    return sum;
  };
  const double depth_m = loop.press_n / loop.hand.grip_n_per_m + loop.press_n / 800.0;
  const auto wanted = [&](double t) -> Vector3d {
    Eigen::Vector2d place = loop.place_m;
    if (loop.stroke && t > 1.5) {
      const double w = 2.0 * std::numbers::pi * loop.speed_hz * (t - 1.5);
      const Eigen::Vector2d way(std::sin(w), 0.5 * std::sin(0.71 * w));
      place += std::min(1.0, t - 1.5) * loop.reach_m * (Eigen::Rotation2Dd(loop.angle) * way);
    }
    const double s = std::clamp((t - 0.15) / 0.8, 0.0, 1.0);
    const double share = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    return {place.x(), place.y(), shape_m(place.x(), place.y()) + 0.01 - share * (0.01 + depth_m)};
  };
  FreeHand hand = loop.hand;
  // Stone on steep forms at eight times their size leads out of any device's workspace, faster than a hand goes.
  const auto reachable = [&](double t) -> Vector3d { return wanted(t).cwiseMax(-kReach_m).cwiseMin(kReach_m); };
  Vector3d from_m = hand.position_m = reachable(0.0);
  Outcome outcome;
  outcome.rests = !loop.stroke;
  bool touched = false;
  double least_j = 0.0, low = 1.0, high = -1.0;
  Vector3d axis = Vector3d::Zero();
  const int ticks = static_cast<int>(kDuration_s * 1000.0);
  for (int tick = 0; tick < ticks; ++tick) {
    const double t = 0.001 * tick;
    const Vector3d way_m = reachable(t + 0.001) - from_m;
    const Vector3d to_m = from_m + way_m * std::min(1.0, 0.001 * kFastest_m_per_s / std::max(way_m.norm(), 1e-12));
    hand.go_on(t, from_m, to_m);
    from_m = to_m;
    Vector3d read_m;
    for (int k = 0; k < 3; ++k) read_m[k] = loop.encoder_m * std::round(hand.position_m[k] / loop.encoder_m);
    haptics::DeviceSample sample = haptics::sample_at(read_m, t + 0.001);
    sample.delay_s = loop.measured_s;
    renderer.update(sample, 0.001);
    const haptics::State& state = renderer.state();
    const Vector3d told(state.commanded_force_n[0], state.commanded_force_n[1], state.commanded_force_n[2]);
    const Vector3d spring(state.force_n[0], state.force_n[1], state.force_n[2]);
    hand.write(told, t + 0.001);
    if (state.contact != 0 && !touched) touched = true, least_j = hand.work_j;
    if (touched) {
      const double stored_j = stored_of(spring.norm(), state.stiffness_n_per_m);
      least_j = std::min(least_j, hand.work_j + stored_j);
      outcome.delivered_j = std::max(outcome.delivered_j, hand.work_j - least_j);
    }
    if (!loop.stroke && t >= kDuration_s - kResting_s) {
      if (axis.isZero(0.0))
        axis = state.contact != 0 ? Vector3d(state.normal[0], state.normal[1], state.normal[2]) : Vector3d::UnitZ();
      low = std::min(low, hand.position_m.dot(axis));
      high = std::max(high, hand.position_m.dot(axis));
    }
    outcome.stiffness_n_per_m = state.stiffness_n_per_m;
    outcome.force_n = told.norm();
  }
  outcome.steps = outcome.rests ? (high - low) / loop.encoder_m : 0.0;
  return outcome;
}

void add(std::vector<Window>& windows, const std::string& name, const scene::Scene& scene, int places) {
  Chance chance(windows.size() + 7);
  for (const haptics::ZoomStep& step : haptics::zoom_steps(scene.description(), scene::kDeskWorkspace_m)) {
    const scene::Layers layers = scene.read_level(step.level);
    const scene::Lattice& lattice = layers.grid.lattice;
    for (int k = 0; k < places; ++k) {
      std::size_t node = 0;
      for (int trial = 0; trial < 10000; ++trial) {
        node = chance.index(lattice.count());
        if (layers.grid.state[node] != scene::NodeState::unknown) break;
      }
      const auto nx = static_cast<std::size_t>(lattice.nx);
      const Eigen::Vector2d at(lattice.x_m(static_cast<int>(node % nx)), lattice.y_m(static_cast<int>(node / nx)));
      haptics::WindowPlan plan = haptics::plan_window(scene.description(), step, at, scene::kDeskWorkspace_m);
      Window window;
      window.name = name + " level " + std::to_string(step.level) + ", " + std::to_string(step.nodes) + " nodes";
      window.rough = haptics::load_window(scene, plan, 1);
      plan.effects.friction = false;
      window.smooth = haptics::load_window(scene, plan, 1);
      windows.push_back(std::move(window));
    }
  }
}

void add_formulas(std::vector<Window>& windows) {
  const double w = 2.0 * std::numbers::pi;
  const std::vector<std::pair<const char*, test::HeightFunction>> formulas{
      {"plane", [](double, double) { return 0.0; }},
      {"ramp", [](double x, double y) { return 0.7 * x + 0.3 * y; }},
      {"ball",
       [](double x, double y) {
         return std::sqrt(std::max(1e-4, 0.0036 - (x - 0.05) * (x - 0.05) - (y - 0.05) * (y - 0.05)));
       }},
      {"grating", [w](double x, double) { return 0.00015 * std::sin(w * x / 0.004); }},
      {"waves", [w](double x, double y) { return 0.0008 * std::sin(w * x / 0.009) * std::sin(w * y / 0.007); }},
      {"steps", [](double x, double y) { return 0.002 * std::floor(x / 0.012) + 0.001 * std::floor(y / 0.017); }}};
  const auto rough = [](scene::SceneDescription& description) {
    description.config.friction = scene::FrictionConfig{};
    description.config.friction->law = scene::FrictionConfig::Law::constant;
  };
  for (const auto& [name, height] : formulas)
    add(windows, name, *test::scene_of(height, 401, 0.1, 401, Vector3d::Zero(), rough), 1);
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

/// One row of the table, after the loops that are worst.
void write_row(const std::vector<Window>& windows, int loops, const Knowledge& knowledge) {
  std::vector<Outcome> outcomes(static_cast<std::size_t>(loops));
  ThreadPool().for_ranges(outcomes.size(), 1, [&](std::size_t k, std::size_t) {
    const Loop loop = random_loop(k + 1, windows.size(), knowledge);
    outcomes[k] = run(loop, windows[loop.window]);
  });
  std::vector<double> joules, steps;
  std::size_t above = 0, swings = 0;
  const double kBad_j = 0.008;
  for (std::size_t k = 0; k < outcomes.size(); ++k) {
    const Outcome& o = outcomes[k];
    joules.push_back(1e3 * o.delivered_j);
    if (o.rests) steps.push_back(o.steps);
    above += o.delivered_j > 0.010 ? 1 : 0;
    swings += o.steps > 3.5 ? 1 : 0;
    if (o.delivered_j <= kBad_j && o.steps <= 3.5) continue;
    const Loop loop = random_loop(k + 1, windows.size(), knowledge);
    std::fprintf(
        stderr,
        "loop %zu, %s, %s, %s: %.2f kg, %.2f N s/m, %.0f N/m, %.2f ms late, %.2f measured, %.1f N, step %.0f um: %.1f "
        "mJ, %.1f steps, at last %.0f N/m and %.2f N\n",
        k + 1, windows[loop.window].name.c_str(), loop.friction ? "friction" : "smooth",
        loop.stroke ? "stroke" : "rest", loop.hand.mass_kg, loop.hand.damping_n_s_per_m, loop.hand.grip_n_per_m,
        1e3 * loop.hand.delay_s, 1e3 * loop.measured_s, loop.press_n, 1e6 * loop.encoder_m, 1e3 * o.delivered_j,
        o.steps, o.stiffness_n_per_m, o.force_n);
  }
  const std::string measured =
      knowledge.hidden_s < 0.0 ? "nothing" : "all but " + std::to_string(std::lround(1e6 * knowledge.hidden_s)) + " us";
  std::printf("| %s | %.1f | %zu | %zu | %.3f | %.2f | %.2f | %zu | %zu | %.2f | %.2f | %zu |\n", measured.c_str(),
              1e3 * knowledge.undeclared_s, outcomes.size(), windows.size(), quantile(joules, 0.5),
              quantile(joules, 0.99), quantile(joules, 1.0), above, steps.size(), quantile(steps, 0.99),
              quantile(steps, 1.0), swings);
}

}  // namespace

bool write_loops(const std::vector<std::filesystem::path>& scenes, int loops) {
  std::vector<Window> windows;
  for (const std::filesystem::path& folder : scenes)
    add(windows, folder.filename().string(), *scene::open_scene(folder), 4);
  add_formulas(windows);
  std::printf(
      "| the device measures | assumed undeclared ms | loops | windows | delivered mJ: median | 99 %% | worst | above "
      "10 "
      "mJ | resting | swing steps: 99 %% | worst | above 3.5 |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const double hidden_s : {-1.0, 0.0007, 0.0012})
    for (const double undeclared_s : {0.0, 0.0007, 0.001, 0.002}) write_row(windows, loops, {undeclared_s, hidden_s});
  return true;
}

}  // namespace sparsha::bench
