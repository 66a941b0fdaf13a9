#include "haptics/device/simulated/hand.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sparsha::haptics {
namespace {

const Eigen::Vector3d kNowhere = Eigen::Vector3d::Zero();

HandParameters smooth_hand() {
  HandParameters parameters;
  parameters.coulomb_n = 0.0;
  parameters.encoder_step_m = 0.0;
  parameters.max_force_n = 0.0;
  return parameters;
}

TEST(SimulatedHand, SwingsAsTheClosedFormOfADampedOscillator) {
  const HandParameters parameters = smooth_hand();
  SimulatedHand hand(parameters, kNowhere);
  const Eigen::Vector3d force(1.5, -0.5, 0.25);
  const double decay = parameters.damping_n_s_per_m / (2.0 * parameters.mass_kg);
  const double omega = std::sqrt(parameters.stiffness_n_per_m / parameters.mass_kg - decay * decay);
  for (int tick = 1; tick <= 500; ++tick) {
    hand.advance(kNowhere, force, 0.001);
    const double t = 0.001 * tick;
    const double rise = 1.0 - std::exp(-decay * t) * (std::cos(omega * t) + decay / omega * std::sin(omega * t));
    const Eigen::Vector3d expected = force / parameters.stiffness_n_per_m * rise;
    // 50 sub-steps per tick, each good to a few ulp of the amplitude.
    const double tolerance = 50.0 * tick * 8.0 * std::numeric_limits<double>::epsilon() * force.norm() / 300.0;
    ASSERT_NEAR((hand.position_m() - expected).norm(), 0.0, tolerance) << "tick " << tick;
  }
}

TEST(SimulatedHand, FollowsAMovingTargetAsSlowlyAsItsDampingAllows) {
  SimulatedHand hand(smooth_hand(), kNowhere);
  const Eigen::Vector3d velocity(0.0, 0.0, 0.05);
  Eigen::Vector3d target = kNowhere;
  for (int tick = 0; tick < 3000; ++tick) {
    target += velocity * 0.001;
    hand.advance(target, kNowhere, 0.001);
  }
  // Stiffness and damping both pull towards the target, so that at constant speed nothing is left: exp(-b t / 2m) of
  // it.
  EXPECT_NEAR((hand.position_m() - target).norm(), 0.0, 0.05 * std::exp(-2.0 / 0.3 * 3.0) + 1e-12);
}

TEST(SimulatedHand, AFreeMassObeysNewton) {
  HandParameters parameters = smooth_hand();
  parameters.stiffness_n_per_m = 0.0;
  parameters.damping_n_s_per_m = 0.0;
  SimulatedHand hand(parameters, kNowhere);
  for (int tick = 0; tick < 100; ++tick) hand.advance(kNowhere, {0.0, 0.3, 0.0}, 0.001);
  EXPECT_NEAR(hand.position_m().y(), 0.5 * 0.3 / parameters.mass_kg * 0.1 * 0.1, 1e-12);
  EXPECT_NEAR(hand.velocity_m_per_s().y(), 0.3 / parameters.mass_kg * 0.1, 1e-12);
  const double kinetic = 0.5 * parameters.mass_kg * hand.velocity_m_per_s().squaredNorm();
  EXPECT_NEAR(hand.work_j(), kinetic, 1e-12);
}

TEST(SimulatedHand, DryFrictionHoldsARestingHandWithoutCreep) {
  HandParameters parameters = smooth_hand();
  parameters.coulomb_n = 0.05;
  SimulatedHand hand(parameters, kNowhere);
  for (int tick = 0; tick < 10'000; ++tick) hand.advance(kNowhere, {0.0, 0.0, 0.0499}, 0.001);
  EXPECT_EQ(hand.position_m(), kNowhere);
  hand.advance(kNowhere, {0.0, 0.0, 0.0501}, 0.001);
  EXPECT_GT(hand.position_m().z(), 0.0);
}

TEST(SimulatedHand, DryFrictionTakesEnergyAtItsForceTimesTheWay) {
  HandParameters parameters = smooth_hand();
  parameters.coulomb_n = 0.05;
  parameters.stiffness_n_per_m = 0.0;
  parameters.damping_n_s_per_m = 0.0;
  SimulatedHand hand(parameters, kNowhere);
  for (int tick = 0; tick < 200; ++tick) hand.advance(kNowhere, {0.3, 0.0, 0.0}, 0.001);
  const double kinetic = 0.5 * parameters.mass_kg * hand.velocity_m_per_s().squaredNorm();
  const double lost = parameters.coulomb_n * hand.position_m().x();
  // The impulse comes at the end of each sub-step: first order in it.
  EXPECT_NEAR(hand.work_j() - kinetic, lost, lost * 2.0 * 0.00002 / 0.2);
}

TEST(SimulatedHand, TheAmplifierKeepsTheDirectionOfAForceThatIsTooLong) {
  SimulatedHand hand(HandParameters{}, kNowhere);
  const Eigen::Vector3d force = hand.saturated({30.0, -40.0, 0.0});
  EXPECT_NEAR(force.norm(), 8.0, 1e-12);
  EXPECT_NEAR(force.x() / force.y(), -0.75, 1e-12);
  EXPECT_EQ(hand.saturated({1.0, 2.0, 2.0}), Eigen::Vector3d(1.0, 2.0, 2.0));
}

TEST(SimulatedHand, TheEncoderRoundsToItsSteps) {
  HandParameters parameters;
  parameters.encoder_step_m = 0.0001;
  SimulatedHand hand(parameters, {0.00026, -0.00014, 0.0});
  EXPECT_NEAR((hand.measured_m() - Eigen::Vector3d(0.0003, -0.0001, 0.0)).norm(), 0.0, 1e-18);
}

}  // namespace
}  // namespace sparsha::haptics
