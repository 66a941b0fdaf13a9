#include "soak.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include "haptics/proxy/proxy.h"
#include "tests/support/rest_oracle.h"
#include "tests/support/surfaces.h"

namespace sparsha::haptics::test {
namespace {

using Eigen::Vector3d;

constexpr std::uint64_t kMovesASurface = 20000;

struct Ground {
  MongeSurface surface;
  double ridge_x = 0.0;  ///< metres; with a ridge along y
  double ridge_top = -std::numeric_limits<double>::infinity();
};

Ground random_ground(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const double spacing = std::pow(10.0, std::uniform_real_distribution<double>(-4.0, 0.0)(random));
  Ground ground;
  MongeSurface& surface = ground.surface;
  switch (std::uniform_int_distribution<int>(0, 6)(random)) {
    case 0:
      surface = make_sinusoid(200);
      break;
    case 1:
      surface = make_rough_surface(40, spacing, spacing * std::pow(10.0, 4.0 * uniform(random) - 2.0), random);
      break;
    case 2:
      surface = make_fractal_surface(129, spacing, 20.0 * spacing * uniform(random), random);
      break;
    case 3: {  // spikes of 1000 cells
      surface = make_rough_surface(60, spacing, spacing, random);
      for (float& z : surface.height_m)
        if (uniform(random) < 0.02) z = static_cast<float>(1000.0 * spacing * (uniform(random) < 0.5 ? -1.0 : 1.0));
      surface.highest_m = *std::max_element(surface.height_m.begin(), surface.height_m.end());
      break;
    }
    case 4: {  // steps and plateaus: exact creases, flat cells
      surface = make_surface_of(80, 50, spacing, [&](double x, double y) {
        return spacing * (std::floor(x / spacing / 7.0) * 3.0 + std::floor(y / spacing / 5.0));
      });
      break;
    }
    case 5:  // two valleys under a sheet-thin ridge
      surface = make_surface_of(60, 60, spacing, [&](double x, double y) {
        const double u = x / spacing - 30.0;
        const double ridge = std::abs(u) < 0.5 ? 60.0 : 0.0;
        return spacing * (0.1 * (std::abs(u) - 15.0) * (std::abs(u) - 15.0) + ridge + 0.2 * std::sin(y / spacing));
      });
      ground.ridge_x = 30.0 * spacing;
      ground.ridge_top = 80.0 * spacing;
      break;
    default:
      surface = make_surface_of(30, 90, spacing, [](double, double) { return 0.0; });
  }
  const double friction = uniform(random);
  if (friction < 0.4) {
    // frictionless
  } else if (friction < 0.7) {
    const double mu = 0.9 * uniform(random);
    set_friction(surface, std::max(mu, 0.9 * uniform(random)), mu);
  } else {
    set_random_friction(surface, 0.9, random);
  }
  return ground;
}

/// The next hand: steps from 1e-4 of a cell to the whole width, sometimes onto exact nodes and edges.
Vector3d next_hand(const MongeSurface& surface, const Vector3d& hand, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal;
  const double h = surface.lattice.spacing_m;
  const double width = std::max(surface.width_m(), surface.depth_m());
  const double length = h * std::pow(10.0, -4.0 + uniform(random) * (4.0 + std::log10(width / h)));
  Vector3d next = hand + length * Vector3d(normal(random), normal(random), 0.5 * normal(random));
  const double kind = uniform(random);
  if (kind < 0.03) next.x() = h * std::round(next.x() / h);
  if (kind > 0.01 && kind < 0.05) next.y() = h * std::round(next.y() / h);
  if (kind > 0.95) next = Vector3d(width * uniform(random), width * uniform(random), next.z());
  const double margin = 0.2 * width;
  next.x() = std::clamp(next.x(), -margin, surface.width_m() + margin);
  next.y() = std::clamp(next.y(), -margin, surface.depth_m() + margin);
  // Near the surface from both sides: the depth has its own scale.
  if (kind > 0.3) {
    const double depth = h * std::pow(10.0, -3.0 + 4.5 * uniform(random));
    next.z() = surface.height(next.x(), next.y()) + (uniform(random) < 0.8 ? -depth : depth);
  }
  return next;
}

}  // namespace

SoakCount run_soak(std::uint64_t moves, std::uint64_t seed) {
  SoakCount count;
  int described = 0;
  for (std::uint64_t first = 0; first < moves; first += kMovesASurface) {
    std::mt19937_64 random(seed + 0x9E3779B97F4A7C15ULL * (first / kMovesASurface + 1));
    const Ground ground = random_ground(random);
    const MongeSurface& surface = ground.surface;
    const double h = surface.lattice.spacing_m;
    Vector3d hand(0.5 * surface.width_m(), 0.5 * surface.depth_m(), 0.0);
    ProxyState state = start_proxy(surface, hand);
    const SolverOptions options;
    const std::uint64_t end = std::min(moves, first + kMovesASurface);
    for (std::uint64_t k = first; k < end; ++k) {
      hand = next_hand(surface, hand, random);
      const Vector3d before = state.position;
      const ProxyUpdate update = update_exact(surface, hand, state, options);
      ++count.moves;
      count.most_segments = std::max(count.most_segments, static_cast<std::uint64_t>(update.segments));
      if (!update.position.allFinite() || !update.normal.allFinite()) {
        ++count.not_a_number;
        continue;
      }
      if (update.unfinished) ++count.unfinished;
      const double mu =
          coefficient_at(surface, update.sticking ? surface.mu_static : surface.mu_dynamic, update.position);
      const Judgement verdict = judge(surface, update.position, hand, mu);
      const char* fault = nullptr;
      count.worst_below_cells = std::max(count.worst_below_cells, verdict.below_cells);
      if (verdict.below_cells > verdict.allowance_cells) ++count.below, fault = "below the surface";
      const double way = (hand - before).norm();
      const double slack = 1e-12 * (hand.norm() + before.norm() + h);
      if ((hand - update.position).norm() > way + slack) ++count.rose, fault = "farther from the hand than before";
      if ((before.x() < ground.ridge_x) != (update.position.x() < ground.ridge_x) && way < ground.ridge_top - hand.z())
        ++count.tunnelled, fault = "through the ridge";
      if (!update.contact && !update.unfinished && update.position != hand) ++count.stuck, fault = "stuck in the air";
      if (update.contact) {
        ++count.contacts;
        if (!update.unfinished) {
          count.worst_excess_cells = std::max(count.worst_excess_cells, verdict.excess_cells);
          if (verdict.excess_cells > verdict.allowance_cells) ++count.non_stationary, fault = "not at rest";
          if (verdict.pull_cells > verdict.allowance_cells) ++count.stuck, fault = "pulled by the surface";
        }
      }
      if (fault != nullptr && described < 10) {
        ++described;
        std::fprintf(stderr,
                     "seed %llu move %llu: %s: proxy (%.17g %.17g %.17g) hand (%.17g %.17g %.17g) cells, excess %g "
                     "below %g pull %g allowed %g mu %g sticking %d segments %d spacing %g\n",
                     static_cast<unsigned long long>(seed), static_cast<unsigned long long>(k), fault,
                     update.position.x() / h, update.position.y() / h, update.position.z() / h, hand.x() / h,
                     hand.y() / h, hand.z() / h, verdict.excess_cells, verdict.below_cells, verdict.pull_cells,
                     verdict.allowance_cells, mu, update.sticking ? 1 : 0, update.segments, h);
      }
    }
  }
  return count;
}

}  // namespace sparsha::haptics::test
