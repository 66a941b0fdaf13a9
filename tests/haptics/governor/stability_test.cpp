// A simulated hand presses a wall through proxy and governor: when does it oscillate, and how quiet is it otherwise?
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include "haptics/device/simulated/hand.h"
#include "haptics/governor/governor.h"
#include "haptics/proxy/proxy.h"
#include "tests/support/surfaces.h"

namespace sparsha::haptics::test {
namespace {

using Eigen::Vector3d;

constexpr double kPeriod = 0.001;
constexpr double kEncoderStep = 2e-5;

/// Spectral radius of hand, hold and one tick of delay on a wall of stiffness k: x'' = (-kh x - b x' + f) / m.
double delayed_wall_radius(const HandParameters& hand, double k) {
  Eigen::Matrix3d rates = Eigen::Matrix3d::Zero();
  rates(0, 1) = 1.0;
  rates(1, 0) = -hand.stiffness_n_per_m / hand.mass_kg;
  rates(1, 1) = -hand.damping_n_s_per_m / hand.mass_kg;
  rates(1, 2) = 1.0 / hand.mass_kg;
  Eigen::Matrix3d tick = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d term = Eigen::Matrix3d::Identity();
  for (int n = 1; n < 30; ++n) {
    term = term * rates * (kPeriod / n);
    tick += term;
  }
  tick.row(2) << -k, 0.0, 0.0;  // the force of this tick's position is felt during the next one
  return tick.eigenvalues().cwiseAbs().maxCoeff();
}

/// Stiffness at which a growing function of k passes 1.
template <class Growth>
double onset(Growth growth) {
  double low = 10.0;
  double high = 20000.0;
  for (int k = 0; k < 24; ++k) {
    const double middle = 0.5 * (low + high);
    (growth(middle) < 1.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Ratio of the oscillation's size late to early, the real proxy on a plane, no governor, never out of contact.
double simulated_growth(const HandParameters& parameters, double k) {
  const MongeSurface plane = make_surface_of(4, 4, 0.05, [](double, double) { return 0.0; });
  const double depth = 0.02;
  // A constant weight k * depth on the hand keeps it at rest there.
  const Vector3d weight(0, 0, -k * depth);
  const Vector3d rest(0.07, 0.07, -depth);
  SimulatedHand hand(parameters, rest);
  ProxyState state = start_proxy(plane, rest);
  Vector3d held = -weight;
  double early = 0.0;
  double late = 0.0;
  constexpr int kTicks = 3000;
  for (int tick = 0; tick < kTicks; ++tick) {
    const Vector3d hip = hand.measured_m();
    const ProxyUpdate update = update_exact(plane, hip, state, {});
    Vector3d force = k * (update.position - hip);
    if (tick < 2) force.z() += 0.001 * k * depth;  // a tap
    hand.advance(rest, held + weight, kPeriod);
    held = force;
    const double size = std::abs(hand.position_m().z() + depth);
    if (tick > kTicks / 6 && tick < kTicks / 3) early = std::max(early, size);
    if (tick >= kTicks * 5 / 6) late = std::max(late, size);
    if (size > 0.5 * depth) return 2.0;
  }
  constexpr double kCalm = 1e-12;  // m: nothing is left of the tap
  return early < kCalm ? 0.0 : late / early;
}

struct Press {
  double peak_to_peak_steps = 0.0;
  double ripple = 0.0;        ///< RMS of the force about its mean, in k * encoder step
  double static_error = 0.0;  ///< mean force / (k * mean depth) - 1
  double observed_excess_j = 0.0;
  double true_excess_j = 0.0;
};

/// Approach at 0.1 m/s, press with `press_n` but at most 10 mm deep, one second to calm, one second of measurement.
Press press(const HandParameters& parameters, double requested, double press_n) {
  const MongeSurface plane = make_surface_of(4, 4, 0.05, [](double, double) { return 0.0; });
  DeviceLimits limits;
  limits.least_damping_n_s_per_m = parameters.damping_n_s_per_m;
  Governor governor(limits);
  double k = governed_stiffness(requested, limits, kPeriod);
  SimulatedHand hand(parameters, {0.07, 0.07, 0.01});
  ProxyState state = start_proxy(plane, hand.measured_m());
  press_n = std::min(press_n, 0.01 * k);
  const double deepest = -press_n / k - press_n / parameters.stiffness_n_per_m;
  const double pressed_s = 0.1 + (0.01 - deepest) / 0.1;
  Vector3d held = Vector3d::Zero();
  Press result;
  double low = 1.0;
  double high = -1.0;
  double depth_sum = 0.0;
  std::vector<double> forces;
  for (int tick = 0; tick * kPeriod < pressed_s + 2.0; ++tick) {
    const double t = tick * kPeriod;
    const Vector3d hip = hand.measured_m();
    const ProxyUpdate update = update_exact(plane, hip, state, {});
    GovernorInput input;
    input.position_m = hip;
    input.contact = update.contact;
    k = governor.stiffness(requested, kPeriod);
    if (update.contact) input.force_n = k * (update.position - hip);
    input.proxy_m = update.position;
    input.stiffness_n_per_m = k;
    input.normal = update.normal;
    input.spring_energy_j = 0.5 * input.force_n.squaredNorm() / k;
    const GovernorOutput output = governor.update(input);
    result.observed_excess_j = std::max(result.observed_excess_j, -output.energy_j);
    if (t > pressed_s + 1.0) {
      low = std::min(low, hip.z());
      high = std::max(high, hip.z());
      depth_sum += -hip.z();
      forces.push_back(output.force_n.z());
    }
    hand.advance({0.07, 0.07, std::max(deepest, 0.01 - 0.1 * std::max(0.0, t - 0.1))}, held, kPeriod);
    held = output.force_n;
    result.true_excess_j = std::max(result.true_excess_j, hand.work_j());
  }
  double mean = 0.0;
  for (const double f : forces) mean += f / static_cast<double>(forces.size());
  double squares = 0.0;
  for (const double f : forces) squares += (f - mean) * (f - mean) / static_cast<double>(forces.size());
  result.peak_to_peak_steps = (high - low) / kEncoderStep;
  result.ripple = std::sqrt(squares) / (k * kEncoderStep);
  result.static_error = mean / (k * depth_sum / static_cast<double>(forces.size())) - 1.0;
  return result;
}

}  // namespace

TEST(Stability, UngovernedOscillationSetsInWhereTheDelayedLinearModelSays) {
  std::printf(
      "  b N s/m   simulated   eigenvalue    2b/(3T)   Colgate-Schenkel 2b/T   Abbott-Okamura min(2b/T, 2f/D)\n");
  for (const double damping : {1.0, 2.0, 5.0}) {
    HandParameters hand;
    hand.mass_kg = 0.15;
    hand.stiffness_n_per_m = 300.0;
    hand.damping_n_s_per_m = damping;
    hand.coulomb_n = 0.0;
    hand.encoder_step_m = 0.0;
    hand.max_force_n = 0.0;
    const double model = onset([&](double k) { return delayed_wall_radius(hand, k); });
    const double simulated = onset([&](double k) { return simulated_growth(hand, k); });
    std::printf("  %7.1f   %9.0f   %10.0f   %8.0f   %21.0f   %30.0f\n", damping, simulated, model,
                2.0 * damping / (3.0 * kPeriod), 2.0 * damping / kPeriod,
                std::min(2.0 * damping / kPeriod, 2.0 * HandParameters{}.coulomb_n / kEncoderStep));
    EXPECT_NEAR(simulated / model, 1.0, 0.05);
    DeviceLimits limits;
    limits.least_damping_n_s_per_m = damping;
    EXPECT_LT(stiffness_limit(limits, kPeriod), model);
  }
}

TEST(Stability, GovernedPressingIsQuietAndHonestOverTheWholeSweep) {
  Press worst;
  for (const double mass : {0.1, 0.15, 0.2})
    for (const double damping : {1.0, 2.0, 5.0, 10.0})
      for (const double stiffness : {50.0, 150.0, 300.0, 500.0})
        for (const double request : {0.1, 0.3, 0.8, 1.0, 3.0, 10.0})
          for (const double press_n : {0.7, 3.0}) {
            HandParameters hand;
            hand.mass_kg = mass;
            hand.damping_n_s_per_m = damping;
            hand.stiffness_n_per_m = stiffness;
            hand.encoder_step_m = kEncoderStep;
            DeviceLimits limits;
            limits.least_damping_n_s_per_m = damping;
            const double requested = request * stiffness_limit(limits, kPeriod);
            const Press result = press(hand, requested, press_n);
            SCOPED_TRACE(testing::Message() << "mass " << mass << " damping " << damping << " stiffness " << stiffness
                                            << " request " << request << " press " << press_n);
            EXPECT_LE(result.peak_to_peak_steps, 3.0 + 1e-6);
            EXPECT_LE(result.ripple, 3.0);
            EXPECT_LE(std::abs(result.static_error), 0.01) << "no winning by zero force";
            EXPECT_LE(result.true_excess_j, 0.0005) << "with its one tick of delay, of a newton's press at 0.1 m/s";
            worst.peak_to_peak_steps = std::max(worst.peak_to_peak_steps, result.peak_to_peak_steps);
            worst.ripple = std::max(worst.ripple, result.ripple);
            worst.static_error = std::max(worst.static_error, std::abs(result.static_error));
            worst.observed_excess_j = std::max(worst.observed_excess_j, result.observed_excess_j);
            worst.true_excess_j = std::max(worst.true_excess_j, result.true_excess_j);
          }
  std::printf(
      "  worst of the sweep: %.2f encoder steps peak to peak, force ripple %.2f k D, static error %.3g %%, "
      "energy excess %.3g mJ observed, %.3g mJ true\n",
      worst.peak_to_peak_steps, worst.ripple, 100.0 * worst.static_error, 1e3 * worst.observed_excess_j,
      1e3 * worst.true_excess_j);
}

}  // namespace sparsha::haptics::test
