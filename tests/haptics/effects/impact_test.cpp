// The ring of a strike: what it adds to a tap, when it comes, and what it gives to hands of all kinds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "haptics/window/window.h"
#include "tests/support/scenes.h"
#include "tests/support/striking_hand.h"

namespace sparsha::haptics {
namespace {

using sparsha::test::Strike;
using sparsha::test::strike;
using sparsha::test::StrikingHand;

constexpr double kWidth_m = 0.1;
constexpr double kLightestHand_kg = 0.05;

scene::ScenePointer flat(bool impact, scene::Material material = scene::Material::granite) {
  return sparsha::test::scene_of([](double, double) { return 0.0; }, 101, kWidth_m, 101, Eigen::Vector3d::Zero(),
                                 [&](scene::SceneDescription& d) {
                                   d.config.haptics.impact = impact;
                                   d.config.haptics.material = material;
                                   d.config.haptics.tip_radius_m = 0.0;
                                 });
}

HapticWindow window_of(const scene::ScenePointer& scene) {
  return load_window(*scene, plan_window(scene->description(), 0, {0.05, 0.05}, kWidth_m), 1);
}

double largest_of_first(const Strike& tap, std::size_t ticks) {
  return *std::max_element(tap.force_n.begin(), tap.force_n.begin() + static_cast<std::ptrdiff_t>(ticks));
}

TEST(Impact, PutsAFifthOfATapsEnergyAbove100HertzWithEveryMaterialWhereWithoutItIsAHundredth) {
  for (const double speed : {0.1, 0.2}) {
    StrikingHand hand;
    hand.speed_m_per_s = speed;
    const Strike soft = strike(hand, window_of(flat(false)));
    const double before = sparsha::test::share_above(soft.force_n, hand.rate_hz, 100.0);
    std::printf("| none | %.1f | %.1f %% | %.2f N | %.2f mJ |\n", speed, 100.0 * before, largest_of_first(soft, 6),
                1e3 * soft.given_j);
    EXPECT_LT(before, 0.01);
    for (std::size_t m = 0; m < scene::kMaterials.size(); ++m) {
      const Strike hard = strike(hand, window_of(flat(true, static_cast<scene::Material>(m))));
      const double share = sparsha::test::share_above(hard.force_n, hand.rate_hz, 100.0);
      std::printf("| %s | %.1f | %.1f %% | %.2f N | %.2f mJ |\n", scene::kMaterials[m].name.data(), speed,
                  100.0 * share, largest_of_first(hard, 6), 1e3 * hard.given_j);
      EXPECT_GE(share, 0.2) << scene::kMaterials[m].name;
      EXPECT_GE(largest_of_first(hard, 6), 1.5 * largest_of_first(soft, 6)) << scene::kMaterials[m].name;
      EXPECT_GE(hard.least_n, 0.0) << "the stone never pulls";
    }
  }
}

TEST(Impact, GivesNoHandMoreThanALightHandHadWhenItStruck) {
  const bool nightly = std::getenv("SPARSHA_NIGHTLY") != nullptr;
  const std::vector<double> speeds = nightly ? std::vector{0.05, 0.1, 0.2, 0.4} : std::vector{0.2};
  double worst = 0.0;
  for (const double speed : speeds)
    for (const double mass : {0.05, 0.15, 0.5})
      for (const double damping : {0.3, 2.0, 10.0})
        for (const double delay : {0.0, 0.001, 0.003})
          for (const double rate : {333.0, 1000.0, 4000.0})
            for (const auto material : {scene::Material::wood, scene::Material::granite, scene::Material::bronze}) {
              StrikingHand hand;
              hand.mass_kg = mass;
              hand.damping_n_s_per_m = damping;
              hand.delay_s = delay;
              hand.rate_hz = rate;
              hand.speed_m_per_s = speed;
              const Strike soft = strike(hand, window_of(flat(false)));
              const Strike hard = strike(hand, window_of(flat(true, material)));
              const double most_j = 0.5 * kLightestHand_kg * hard.approach_m_per_s * hard.approach_m_per_s;
              worst = std::max(worst, (hard.given_j - soft.given_j) / most_j);
              EXPECT_LE(hard.given_j, soft.given_j + most_j)
                  << speed << " m/s " << mass << " kg " << damping << " N s/m " << delay << " s " << rate << " Hz";
            }
  std::printf("at most %.2f of it\n", worst);
}

TEST(Impact, OfNoMaterialHasAHalfCycleWithMoreImpulseThanTheLightestHandBears) {
  for (const scene::MaterialTouch& material : scene::kMaterials) {
    EXPECT_GE(material.frequency_hz, 100.0);
    EXPECT_LE(material.frequency_hz, 300.0);
    // Work of one half against v is 2 n v^2 / w; the hand brings m v^2 / 2.
    const double omega = 2.0 * std::numbers::pi * material.frequency_hz;
    EXPECT_LE(2.0 * material.force_per_speed_n_s_per_m / omega, 0.5 * kLightestHand_kg) << material.name;
  }
}

/// A hand that goes where it is told on a stone that rings. Nothing else makes the commanded force larger than that of
/// the surface.
class Knocker {
 public:
  Knocker() : renderer_(DeviceInfo{}, RendererOptions{}, window_of(flat(true))) {}
  /// Goes to `z_m` above the surface in a straight line; true when the stone has rung on the way.
  bool go(double z_m, double speed_m_per_s) {
    const int ticks = std::max(1, static_cast<int>(std::lround(std::abs(z_m - z_m_) / speed_m_per_s / 0.001)));
    const double from_m = z_m_;
    bool rung = false;
    for (int i = 1; i <= ticks; ++i) rung = tick(from_m + (z_m - from_m) * i / ticks) || rung;
    return rung;
  }
  bool wait(int ticks) {
    bool rung = false;
    for (int i = 0; i < ticks; ++i) rung = tick(z_m_) || rung;
    return rung;
  }
  bool tick(double z_m) {
    if (std::isfinite(z_m)) z_m_ = z_m;
    DeviceSample sample = sample_at({0.0, 0.0, z_m}, 0.001 * ticks_++);
    sample.homed = homed;
    renderer_.update(sample, 0.001);
    const double ring_n = renderer_.state().commanded_force_n[2] - renderer_.state().force_n[2];
    most_n = std::max(most_n, ring_n);
    return ring_n > 1e-9;
  }
  void swap() {
    Command command;
    command.kind = Command::Kind::swap;
    command.window = window_of(flat(true));
    command.window.id = renderer_.window().id + 1;
    static_cast<void>(renderer_.apply(command));
  }
  void fault() { renderer_.fault(); }
  bool homed = true;
  double most_n = 0.0;

 private:
  HapticRenderer renderer_;
  double z_m_ = 0.02;
  int ticks_ = 0;
};

TEST(Impact, RingsOnceForAContactAndAgainOnlyAfterTheHandHasLeft) {
  Knocker hand;
  hand.wait(60);
  EXPECT_TRUE(hand.go(-0.001, 0.1));
  hand.wait(400);
  EXPECT_FALSE(hand.wait(50)) << "still ringing";
  EXPECT_FALSE(hand.go(-0.002, 0.1)) << "deeper";
  EXPECT_FALSE(hand.go(0.0003, 0.1));
  EXPECT_FALSE(hand.go(-0.001, 0.1)) << "a third of a millimetre is no departure";
  hand.go(0.0003, 0.1);
  hand.wait(40);
  EXPECT_FALSE(hand.go(-0.001, 0.1)) << "nor is it after 40 ms";
  hand.go(0.004, 0.1);
  hand.wait(20);
  EXPECT_TRUE(hand.go(-0.001, 0.1));
}

TEST(Impact, GrowsWithTheSpeedOfTheApproach) {
  std::vector<double> most;
  for (const double speed : {0.02, 0.04, 0.08}) {
    Knocker hand;
    hand.wait(60);
    hand.go(-0.01 * speed, speed);
    hand.wait(20);
    most.push_back(hand.most_n / speed);
  }
  EXPECT_GT(most[0], 10.0);
  EXPECT_NEAR(most[1] / most[0], 1.0, 0.15);
  EXPECT_NEAR(most[2] / most[1], 1.0, 0.15);
}

TEST(Impact, StaysSilentForSlowHandsAndWhereTheHandDidNotComeFromTheAir) {
  {
    Knocker slow;
    slow.wait(60);
    EXPECT_FALSE(slow.go(-0.001, 0.01));
  }
  {
    Knocker inside;  // from the first tick on
    inside.tick(-0.001);
    EXPECT_FALSE(inside.wait(50));
    inside.go(0.0002, 0.1);
    EXPECT_FALSE(inside.go(-0.001, 0.1));
  }
  {
    Knocker swapped;
    swapped.wait(60);
    swapped.go(0.0004, 0.1);
    swapped.swap();
    EXPECT_FALSE(swapped.go(-0.001, 0.1)) << "just after a swap";
    swapped.swap();
    EXPECT_FALSE(swapped.wait(50));
    swapped.go(0.005, 0.1);
    swapped.wait(30);
    EXPECT_TRUE(swapped.go(-0.001, 0.1)) << "and rings again as before";
  }
  {
    Knocker lost;
    lost.wait(60);
    lost.go(0.0004, 0.1);
    lost.tick(std::nan(""));
    EXPECT_FALSE(lost.go(-0.001, 0.1)) << "after a place that is no number";
  }
  {
    Knocker faulty;
    faulty.wait(60);
    faulty.go(0.0004, 0.1);
    faulty.fault();
    EXPECT_FALSE(faulty.go(-0.001, 0.1)) << "after a fault";
  }
  {
    Knocker homing;
    homing.homed = false;
    homing.wait(60);
    homing.homed = true;
    homing.go(0.0004, 2.0);
    EXPECT_FALSE(homing.go(-0.001, 0.1)) << "after homing";
  }
}

TEST(Impact, StaysSilentUnderAHandThatFlickersAtTheSurface) {
  Knocker hand;
  hand.wait(60);
  hand.go(0.0, 0.1);
  hand.wait(300);
  bool rung = false;
  for (int i = 0; i < 500; ++i) rung = hand.tick((i * 7 % 3 - 1) * 40e-6) || rung;
  EXPECT_FALSE(rung);
}

}  // namespace
}  // namespace sparsha::haptics
