// Where the measured surface ends: an independent hand strokes over it.
#include "bench/haptics/edges.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <random>
#include <string>

#include "bench/haptics/free_hand.h"
#include "haptics/servo/haptic_renderer.h"
#include "haptics/window/window.h"
#include "scene/frame/workspace.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"

namespace sparsha::bench {
namespace {

using Beyond = scene::HapticsConfig::Beyond;
constexpr double kInside_m = 0.010;  // device frame
constexpr double kBeyond_m = 0.014;
constexpr double kPress_n = 1.5;
constexpr double kFelt_m = 0.010;

/// A place of an outline: stone for kInside_m on one side, nothing known for kBeyond_m on the other.
struct Edge {
  Eigen::Vector2d place_m;  // grid frame, the last known node
  Eigen::Vector2d outward;
};

class Ground {
 public:
  Ground(const scene::Scene& scene, int level) : layers_(scene.read_level(level)) {}
  [[nodiscard]] const scene::Lattice& lattice() const { return layers_.grid.lattice; }
  [[nodiscard]] bool known(int i, int j) const {
    return i >= 0 && j >= 0 && i < lattice().nx && j < lattice().ny &&
           layers_.grid.state[lattice().index(i, j)] != scene::NodeState::unknown;
  }
  [[nodiscard]] bool known(const Eigen::Vector2d& place_m) const {
    const Eigen::Vector2d node = (place_m - lattice().origin_m.head<2>()) / lattice().spacing_m;
    return known(static_cast<int>(std::lround(node.x())), static_cast<int>(std::lround(node.y())));
  }
  /// Of the nearest node, grid frame.
  [[nodiscard]] double height_m(const Eigen::Vector2d& place_m) const {
    const Eigen::Vector2d node = (place_m - lattice().origin_m.head<2>()) / lattice().spacing_m;
    const int i = std::clamp(static_cast<int>(std::lround(node.x())), 0, lattice().nx - 1);
    const int j = std::clamp(static_cast<int>(std::lround(node.y())), 0, lattice().ny - 1);
    return lattice().origin_m.z() + static_cast<double>(layers_.grid.height_m[lattice().index(i, j)]);
  }
  /// From a place to the nearest known node, as far as `most_m`, grid frame.
  [[nodiscard]] double away_m(const Eigen::Vector2d& place_m, double most_m) const {
    const Eigen::Vector2d node = (place_m - lattice().origin_m.head<2>()) / lattice().spacing_m;
    const int reach = static_cast<int>(std::ceil(most_m / lattice().spacing_m));
    const int i = static_cast<int>(std::lround(node.x())), j = static_cast<int>(std::lround(node.y()));
    double least = most_m / lattice().spacing_m;
    for (int b = j - reach; b <= j + reach; ++b)
      for (int a = i - reach; a <= i + reach; ++a)
        if (known(a, b)) least = std::min(least, std::hypot(a - node.x(), b - node.y()));
    return least * lattice().spacing_m;
  }
  [[nodiscard]] std::optional<Edge> edge(double scale, std::mt19937_64& random) const {
    const auto chance = [&](double most) { return most * std::generate_canonical<double, 53>(random); };
    for (int trial = 0; trial < 20000; ++trial) {
      const int i = static_cast<int>(chance(lattice().nx)), j = static_cast<int>(chance(lattice().ny));
      if (!known(i, j)) continue;
      if (known(i - 1, j) && known(i + 1, j) && known(i, j - 1) && known(i, j + 1)) continue;
      const double angle = chance(2.0 * std::numbers::pi);
      const Eigen::Vector2d outward(std::cos(angle), std::sin(angle));
      const Eigen::Vector2d place_m(lattice().x_m(i), lattice().y_m(j));
      const double step_m = 0.5 * lattice().spacing_m;
      bool good = true;
      for (double way = 0.0; good && way < kInside_m / scale; way += step_m) good = known(place_m - way * outward);
      for (double way = 2.9 * step_m; good && way < (kBeyond_m + 0.001) / scale; way += step_m)
        good = !known(place_m + way * outward);
      // Not along an outline: at the end the way back to any stone is as long as the way that was gone.
      good = good && away_m(place_m + kBeyond_m / scale * outward, kBeyond_m / scale) > 0.8 * kBeyond_m / scale;
      if (good) return Edge{place_m, outward};
    }
    return std::nullopt;
  }

 private:
  scene::Layers layers_;
};

struct Stroke {
  double edge_n = 0.0, beyond_n = 0.0, drop_n = 0.0, reached_m = -1.0;
  bool on_measured = false;  // what the hand pressed on last
};

Stroke stroke_over(const scene::Scene& scene, const Ground& ground, const haptics::WindowPlan& plan, const Edge& edge) {
  haptics::HapticRenderer renderer(haptics::DeviceInfo{}, haptics::RendererOptions{},
                                   haptics::load_window(scene, plan, 1));
  const Eigen::Vector3d centre_m = renderer.window().surface->centre_m;
  const Eigen::Vector2d edge_m = plan.scale * (edge.place_m - centre_m.head<2>());
  const auto stone_m = [&](double way_m) {
    return plan.scale * (ground.height_m(edge.place_m + edge.outward * (way_m / plan.scale)) - centre_m.z());
  };
  FreeHand hand;
  const double depth_m = kPress_n / hand.grip_n_per_m + kPress_n / 800.0;
  const auto wanted = [&](double t) -> Eigen::Vector3d {
    const double pressed = std::clamp((t - 0.1) / 0.3, 0.0, 1.0);
    const double way_m = std::min(-kInside_m + 0.08 * std::max(0.0, t - 0.5), kBeyond_m);
    const Eigen::Vector2d at = edge_m + edge.outward * way_m;
    // Smoothly along the stone: the mean over 2 mm.
    double stone = 0.0;
    for (int k = -2; k <= 2; ++k) stone += 0.2 * stone_m(std::min(way_m + 0.0005 * k, 0.0));
    return {at.x(), at.y(), stone + 0.01 - pressed * (0.01 + depth_m)};
  };
  hand.position_m = wanted(0.0);
  Stroke result;
  bool was_invented = false;
  double last_n = 0.0, sum_n = 0.0;
  int ticks = 0;
  for (int tick = 0; tick < 1100; ++tick) {
    const double t = 0.001 * tick;
    hand.go_on(t, wanted(t), wanted(t + 0.001));
    renderer.update(haptics::sample_at(hand.position_m, t + 0.001), 0.001);
    const auto& f = renderer.state().commanded_force_n;
    const Eigen::Vector3d force(f[0], f[1], f[2]);
    hand.write(force, t + 0.001);
    const double now_n = force.norm();
    const double beyond_m = (hand.position_m.head<2>() - edge_m).dot(edge.outward);
    if (t > 0.5 && beyond_m > -0.006 && beyond_m < -0.001) sum_n += now_n, ++ticks;
    const haptics::State& state = renderer.state();
    const bool invented = (state.flags & (haptics::kFlagUnknownArea | haptics::kFlagOutside)) != 0;
    if (t > 0.5 && beyond_m > 0.0 && (invented || was_invented))
      result.drop_n = std::max(result.drop_n, last_n - now_n);
    const Eigen::Vector2d at_m = centre_m.head<2>() + hand.position_m.head<2>() / plan.scale;
    if (beyond_m >= 0.5 * kFelt_m && ground.away_m(at_m, kFelt_m / plan.scale) >= 0.999 * kFelt_m / plan.scale)
      result.beyond_n = std::max(result.beyond_n, now_n);
    result.reached_m = std::max(result.reached_m, beyond_m);
    last_n = now_n;
    was_invented = invented;
    result.on_measured = state.contact != 0 && !invented;
  }
  result.edge_n = ticks > 0 ? sum_n / ticks : 0.0;
  return result;
}

struct Sum {
  int strokes = 0, felt = 0, stopped = 0, dropped = 0;
  double worst_n = 0.0, worst_drop_n = 0.0;
  void take(const Stroke& s) {
    if (s.edge_n < 0.2) return;                          // slid off before the edge
    if (s.reached_m < kFelt_m && s.on_measured) return;  // by measured stone that stands in the way
    ++strokes;
    felt += s.beyond_n > 0.1 * s.edge_n ? 1 : 0;
    stopped += s.reached_m < kFelt_m ? 1 : 0;
    dropped += s.drop_n > 1.0 ? 1 : 0;
    worst_n = std::max(worst_n, s.beyond_n);
    worst_drop_n = std::max(worst_drop_n, s.drop_n);
  }
};

void print(const char* scene, const char* kind, const Sum& s) {
  const double share = s.strokes > 0 ? 100.0 / s.strokes : 0.0;
  std::printf("| %s | %s | %d | %.1f | %.1f | %.1f | %.2f | %.2f |\n", scene, kind, s.strokes, share * s.felt,
              share * s.stopped, share * s.dropped, s.worst_n, s.worst_drop_n);
  std::fflush(stdout);
}

void strokes_on(const char* name, const scene::Scene& scene, int per_zoom) {
  for (const auto& [kind, word] :
       {std::pair{Beyond::continued, "continued"}, {Beyond::falls, "falls"}, {Beyond::rim, "rim"}}) {
    std::mt19937_64 random(16);
    Sum sum;
    for (const haptics::ZoomStep& step : haptics::zoom_steps(scene.description(), scene::kDeskWorkspace_m)) {
      const Ground ground(scene, step.level);
      for (int k = 0; k < per_zoom; ++k) {
        haptics::WindowPlan plan = haptics::plan_window(scene.description(), step, haptics::middle_of(ground.lattice()),
                                                        scene::kDeskWorkspace_m);
        const std::optional<Edge> edge = ground.edge(plan.scale, random);
        if (!edge) break;
        scene::SceneDescription described = scene.description();
        described.config.haptics.beyond = kind;
        plan = haptics::plan_window(described, step, edge->place_m, scene::kDeskWorkspace_m);
        const Stroke stroke = stroke_over(scene, ground, plan, *edge);
        if (kind == Beyond::falls &&
            (stroke.beyond_n > 0.1 * stroke.edge_n || stroke.reached_m < kFelt_m || stroke.drop_n > 1.0) &&
            stroke.edge_n > 0.2)
          std::fprintf(stderr,
                       "%s level %d nodes %d at %.5f %.5f outward %.2f %.2f: %.2f N, beyond %.2f N, drop %.2f N, "
                       "reached %.1f mm%s\n",
                       name, step.level, step.nodes, edge->place_m.x(), edge->place_m.y(), edge->outward.x(),
                       edge->outward.y(), stroke.edge_n, stroke.beyond_n, stroke.drop_n, 1e3 * stroke.reached_m,
                       stroke.on_measured ? ", on stone" : "");
        sum.take(stroke);
      }
    }
    print(name, word, sum);
  }
}

double ball_m(double x, double y) {
  const double left = 0.0064 - (x - 0.1) * (x - 0.1) - (y - 0.1) * (y - 0.1);
  return left > 0.0 ? std::sqrt(left) : std::nan("");
}

double slab_m(double x, double y) {
  const bool stone = x > 0.04 && x < 0.16 && y > 0.04 && y < 0.16;
  return stone ? 0.001 * std::sin(200.0 * x) * std::cos(170.0 * y) - (y < 0.1 ? 0.03 : 0.0) : std::nan("");
}

}  // namespace

bool write_edges(const std::vector<std::filesystem::path>& scenes, int per_zoom) {
  std::puts(
      "| scene | beyond | strokes | felt 10 mm beyond % | stopped % | lose over 1 N in a tick % | most beyond N | most "
      "lost N |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |");
  if (scenes.empty()) {
    strokes_on("ball", *test::scene_of(ball_m, 401, 0.2), per_zoom);
    strokes_on("slab", *test::scene_of(slab_m, 401, 0.2), per_zoom);
  }
  for (const std::filesystem::path& folder : scenes)
    strokes_on(folder.filename().c_str(), *scene::open_scene(folder), per_zoom);
  return true;
}

}  // namespace sparsha::bench
