// Grain: the spectrum that it continues, where it lies, when it is silent, and what it gives to a hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Geometry>

#include "haptics/effects/surface_effects.h"
#include "haptics/window/effects.h"
#include "haptics/window/objects.h"
#include "haptics/window/window.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"
#include "tests/support/touch_loop.h"
#include "tests/support/whole_scenes.h"

namespace sparsha::haptics {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kStone_m = 0.2;

/// A level stone of 0.2 m with grain of a known law, felt at `scale`.
HapticWindow grained(const scene::HeightSpectrum& law, double scale = 1.0,
                     scene::Material material = scene::Material::granite) {
  auto effects = std::make_shared<SurfaceEffects>();
  effects->grain = true;
  effects->material = material;
  effects->scale = scale;
  effects->border_m = scene::kBorder_m / scale;
  effects->field = scene::GrainField(law);
  SurfaceParts parts;
  parts.lattice = {101, 101, kStone_m / 100, Eigen::Vector3d(-0.5 * kStone_m, -0.5 * kStone_m, 0.0)};
  parts.height_m.assign(parts.lattice.count(), 0.0F);
  parts.scale = scale;
  parts.effects = effects;
  HapticWindow window;
  window.surface = make_surface(std::move(parts));
  window.id = 1;
  return window;
}

/// Forces along a straight stroke over the stone, at a constant depth and speed, once the hand has come to its speed.
class Stroke {
 public:
  Stroke(HapticWindow window, double rate_hz)
      : rate_hz_(rate_hz), renderer_(info(), options(rate_hz), std::move(window)) {
    for (int i = 0; i < static_cast<int>(0.06 * rate_hz); ++i) go({0.0, 0.0, 0.02});
  }
  const State& go(const Eigen::Vector3d& device_m) {
    renderer_.update(sample_at(device_m, static_cast<double>(tick_++) / rate_hz_), 1.0 / rate_hz_);
    return renderer_.state();
  }
  /// Of a cube about the origin at its own size, in the air; it is stroked on the face that is before the hand then.
  void turn(const Eigen::Quaterniond& device_from_grid, double half_m) {
    Command command;
    command.kind = Command::Kind::turn;
    command.turn = device_from_grid;
    static_cast<void>(renderer_.apply(command));
    const State& state = go({0.0, 0.0, 0.02});
    const Eigen::Vector3d towards = device_from_grid.conjugate() * Eigen::Vector3d::UnitZ();
    face_m_ = half_m - towards.dot(Eigen::Vector3d(state.centre_m[0], state.centre_m[1], state.centre_m[2]));
    for (int i = 0; i < static_cast<int>(0.06 * rate_hz_); ++i) go({0.0, 0.0, face_m_ + 0.02});
  }
  /// Comes down at `from`, presses `depth_m` deep and goes on; the force at every tick after the first 0.1 s.
  std::vector<Eigen::Vector3d> along(const Eigen::Vector2d& from_m, const Eigen::Vector2d& velocity, double depth_m,
                                     double seconds) {
    const auto down = static_cast<int>(0.1 * rate_hz_);
    const auto ticks = static_cast<int>(seconds * rate_hz_);
    std::vector<Eigen::Vector3d> forces;
    places_m.clear();
    for (int i = -down; i < ticks; ++i) {
      const double t = i / rate_hz_;
      const double z = face_m_ + (i < 0 ? -depth_m * (1.0 + t / 0.1) : -depth_m);
      const Eigen::Vector2d at = from_m + velocity * t;
      const State& state = go({at.x(), at.y(), z});
      if (i < 0) continue;
      forces.emplace_back(state.commanded_force_n[0], state.commanded_force_n[1], state.commanded_force_n[2]);
      places_m.emplace_back(state.proxy_m[0], state.proxy_m[1]);
      press_n = state.force_n[2];
    }
    go({from_m.x(), from_m.y(), 0.02});
    return forces;
  }
  double press_n = 0.0;
  std::vector<Eigen::Vector2d> places_m;

 private:
  static DeviceInfo info() {
    DeviceInfo info;
    info.limits.least_damping_n_s_per_m = 5.0;
    info.limits.undeclared_s = 0.0;  // the loop is known, and the hand leaves by jumps that none makes
    return info;
  }
  static RendererOptions options(double rate_hz) {
    RendererOptions options;
    options.rate_hz = rate_hz;
    return options;
  }
  double rate_hz_;
  double face_m_ = 0.0;  // z of the stone, device frame
  HapticRenderer renderer_;
  std::int64_t tick_ = 0;
};

/// Power of a signal between two frequencies, by a plain Fourier sum under a Hann window.
double power_between(const std::vector<double>& signal, double rate_hz, double low_hz, double high_hz) {
  const auto n = static_cast<double>(signal.size());
  double mean = 0.0;
  for (const double value : signal) mean += value / n;
  double power = 0.0;
  for (int bin = static_cast<int>(std::ceil(low_hz * n / rate_hz)); bin * rate_hz / n < high_hz; ++bin) {
    std::complex<double> sum = 0.0;
    const std::complex<double> turn = std::polar(1.0, -kTurn * bin / n);
    std::complex<double> phase = 1.0;
    for (std::size_t i = 0; i < signal.size(); ++i) {
      const double window = 0.5 - 0.5 * std::cos(kTurn * (static_cast<double>(i) + 0.5) / n);
      sum += window * (signal[i] - mean) * phase;
      phase *= turn;
    }
    power += 2.0 * std::norm(sum) / (n * n) / 0.375;
  }
  return power;
}

/// Power of press * slope between two frequencies at a speed, of heights with the law's spectrum along a line.
double extrapolated(const scene::HeightSpectrum& law, double press_n, double speed_m_per_s, double low_hz,
                    double high_hz) {
  double power = 0.0;
  constexpr int kSteps = 2000;
  const double low = low_hz / speed_m_per_s;
  const double step = (high_hz - low_hz) / speed_m_per_s / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const double q = low + (i + 0.5) * step;
    power += 2.0 * std::pow(press_n * kTurn * q, 2) * law.level_m3 * std::pow(q / law.from_per_m, -law.exponent) * step;
  }
  return power;
}

TEST(Grain, HasTheExtrapolatedSpectrumWithin3DecibelsUpTo300HertzAt100MillimetresPerSecond) {
  constexpr double kSpeed = 0.1;
  for (const double exponent : {1.5, 2.2, 3.0, 4.0})
    for (const double rate_hz : {1000.0, 4000.0}) {
      // The scan resolves waves up to 80 Hz at this speed; heights of some micrometres.
      const scene::HeightSpectrum law{4e-14, exponent, 800.0};
      std::vector<double> powers;
      double press_n = 0.0;
      std::vector<std::pair<double, double>> bands;
      for (double low = 80.0 * 1.06; low * std::cbrt(2.0) <= 301.0; low *= std::cbrt(2.0))
        bands.emplace_back(low, low * std::cbrt(2.0));
      bands.emplace_back(270.0, 300.0);
      powers.assign(bands.size(), 0.0);
      Stroke stroke(grained(law), rate_hz);
      constexpr int kStrokes = 8;
      for (int k = 0; k < kStrokes; ++k) {
        const double heading = 0.1 + kTurn * k / kStrokes;
        const Eigen::Vector2d way(std::cos(heading), std::sin(heading));
        const auto forces =
            stroke.along(-0.025 * way + Eigen::Vector2d(0.003 * k, 0.001 * k), kSpeed * way, 0.002, 0.512);
        std::vector<double> along;
        for (const Eigen::Vector3d& force : forces) along.push_back(force.head<2>().dot(way));
        press_n = stroke.press_n;
        for (std::size_t b = 0; b < bands.size(); ++b)
          powers[b] += power_between(along, rate_hz, bands[b].first, bands[b].second) / kStrokes;
      }
      for (std::size_t b = 0; b < bands.size(); ++b) {
        const double wanted = extrapolated(law, press_n, kSpeed, bands[b].first, bands[b].second);
        const double decibels = 10.0 * std::log10(powers[b] / wanted);
        std::printf("| q^-%.1f | %.0f Hz | %.0f to %.0f Hz | %+.1f dB |\n", exponent, rate_hz, bands[b].first,
                    bands[b].second, decibels);
        EXPECT_LE(std::abs(decibels), 3.0) << exponent << ' ' << rate_hz << ' ' << bands[b].first;
      }
    }
}

TEST(Grain, GivesTheSamePlaceTheSameForceWhateverThePathTheWindowAndTheZoom) {
  const scene::HeightSpectrum law{4e-14, 2.0, 800.0};
  // The same way over the stone: forth, back, and in a window that magnifies twice; no tick coincides by its number.
  Stroke whole(grained(law, 1.0), 1000.0);
  Stroke near(grained(law, 0.5), 1000.0);
  const Eigen::Vector2d step(0.16, 0.08);
  const auto forth = whole.along({-0.02, 0.01}, step, 0.002, 0.4);
  const std::vector<Eigen::Vector2d> there = whole.places_m;
  const double press_n = whole.press_n;
  const auto back = whole.along(there.back() + 0.05 * step, -step, 0.002, 0.4);
  const std::vector<Eigen::Vector2d> places_back = whole.places_m;
  const auto zoomed = near.along({-0.01, 0.005}, 0.5 * step, 0.001, 0.4);
  constexpr std::size_t kSettled = 150;  // the speed is known by then
  int compared = 0;
  double largest = 0.0;
  for (std::size_t i = kSettled; i < there.size(); ++i) {
    ASSERT_LT((near.places_m[i] - there[i]).norm(), 1e-9);
    EXPECT_NEAR(zoomed[i].x() / near.press_n, forth[i].x() / press_n, 1e-6) << i;
    for (std::size_t k = kSettled; k < back.size(); ++k) {
      if ((places_back[k] - there[i]).norm() > 1e-9) continue;
      ++compared;
      largest = std::max(largest, forth[i].head<2>().norm());
      EXPECT_NEAR(back[k].x(), forth[i].x(), 1e-4) << i;
      EXPECT_NEAR(back[k].y(), forth[i].y(), 1e-4) << i;
    }
  }
  EXPECT_GT(compared, 50);
  EXPECT_GT(largest, 0.02);
}

TEST(Grain, IsExactlyNothingUnderAHandAtRestEvenWhenItsEncoderFlickers) {
  const scene::HeightSpectrum law{4e-13, 2.0, 800.0};
  Stroke hand(grained(law), 1000.0);
  hand.along({0.0, 0.0}, {0.1, 0.0}, 0.002, 0.2);
  for (int i = 0; i < 60; ++i) hand.go({0.003, 0.002, 0.02});
  for (int i = 0; i < 100; ++i) hand.go({0.003, 0.002, -2e-5 * i});
  for (int i = 0; i < 600; ++i) {
    const State& state = hand.go({0.003 + (i % 3 == 0 ? 20e-6 : 0.0), 0.002, -0.002});
    EXPECT_EQ(state.commanded_force_n[1], 0.0);
    EXPECT_EQ(state.commanded_force_n, state.force_n);
  }
}

TEST(Grain, MakesNoWaveThatIsFasterThanHalfTheTicks) {
  const scene::HeightSpectrum law{4e-14, 2.0, 800.0};
  // At 0.7 m/s the longest waves come 560 times a second.
  Stroke fast(grained(law), 1000.0);
  for (const Eigen::Vector3d& force : fast.along({-0.04, 0.0}, {0.7, 0.0}, 0.002, 0.1)) {
    // Up to how places are rounded: stiffness * epsilon * the stone's width.
    EXPECT_LT(force.head<2>().norm(), 800.0 * 1e-15 * kStone_m);
  }
  // At 0.4 m/s a loop of 4000 Hz shows what one of 1000 Hz has to leave out: what it keeps lies below 500 Hz.
  Stroke slow_loop(grained(law), 1000.0);
  const auto coarse = slow_loop.along({-0.04, 0.0}, {0.4, 0.0}, 0.002, 0.2);
  double variance = 0.0;
  for (std::size_t i = 50; i < coarse.size(); ++i)
    variance += coarse[i].head<2>().squaredNorm() / static_cast<double>(coarse.size() - 50);
  // Both components of all waves of 800 to 500 / 0.4 per metre, whatever their heading.
  const double plane = std::tgamma(1.5) / (std::sqrt(std::numbers::pi) * std::tgamma(1.0)) * law.level_m3;
  const double all = std::pow(slow_loop.press_n * kTurn, 2) * kTurn * plane * 800.0 * 800.0 * (1250.0 - 800.0);
  EXPECT_LE(variance, 1.3 * all);
  EXPECT_GE(variance, 0.1 * all);
}

TEST(Grain, GrowsWithThePressAndByTheMaterial) {
  const scene::HeightSpectrum law{4e-14, 2.0, 800.0};
  const auto rms = [&](double depth_m, scene::Material material) {
    Stroke stroke(grained(law, 1.0, material), 1000.0);
    double sum = 0.0;
    const auto forces = stroke.along({-0.03, 0.0}, {0.1, 0.02}, depth_m, 0.4);
    for (std::size_t i = 100; i < forces.size(); ++i) sum += forces[i].head<2>().squaredNorm();
    return std::sqrt(sum / static_cast<double>(forces.size() - 100));
  };
  const double light = rms(0.001, scene::Material::granite);
  EXPECT_GT(light, 0.005);
  EXPECT_NEAR(rms(0.002, scene::Material::granite) / light, 2.0, 1e-3);
  EXPECT_NEAR(rms(0.001, scene::Material::marble) / light, scene::touch_of(scene::Material::marble).grain_gain, 1e-3);
}

TEST(Grain, IsFeltAlikeOnAllSidesOfAWholeObject) {
  const scene::HeightSpectrum law{4e-14, 2.0, 800.0};
  const auto scene = sparsha::test::whole_scene(sparsha::test::cube_charts(30, 0.001), kStone_m);
  const auto rms = [](const std::vector<Eigen::Vector3d>& forces) {
    double sum = 0.0;
    for (std::size_t i = 100; i < forces.size(); ++i) sum += forces[i].head<2>().squaredNorm();
    return std::sqrt(sum / static_cast<double>(forces.size() - 100));
  };
  const auto felt = [&](const Eigen::Quaterniond& turn, const Eigen::Vector2d& velocity) {
    HapticWindow window = grained(law);
    window.effects.friction = false;
    attach_object(window, scene->description());
    Stroke stroke(std::move(window), 1000.0);
    stroke.turn(turn, 0.03);
    return rms(stroke.along(-0.15 * velocity, velocity, 0.001, 0.4));
  };
  Stroke level(grained(law), 1000.0);
  const double plane_n = rms(level.along({-0.02, 0.0}, {0.1, 0.0}, 0.001, 0.4));
  EXPECT_GT(plane_n, 0.005);
  constexpr double kQuarter = 0.25 * kTurn;
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 2, 0),
                                      Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0)})
    for (const Eigen::Vector2d& velocity : {Eigen::Vector2d(0.1, 0.0), Eigen::Vector2d(0.0, 0.1)}) {
      const double angle = kQuarter * axis.norm();
      const Eigen::Quaterniond turn(angle > 0.0 ? Eigen::AngleAxisd(angle, axis.normalized())
                                                : Eigen::AngleAxisd::Identity());
      EXPECT_NEAR(felt(turn, velocity) / plane_n, 1.0, 0.35) << axis.transpose() << ", " << velocity.transpose();
    }
}

TEST(Grain, FollowsTheSlopeOfItsOwnHeights) {
  const scene::GrainField field(scene::HeightSpectrum{4e-14, 2.0, 800.0});
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> anywhere(-2000.0, 2000.0);
  for (int k = 0; k < 200; ++k) {
    const int band = k % field.bands();
    const double x = anywhere(random);
    const double y = anywhere(random);
    const double step_m = 0.02 / field.highest_per_m(band);
    const double steep = kTurn * field.highest_per_m(band) * field.deviation_m(band);
    const auto value = field.at(band, x, y);
    const double along_x =
        (field.at(band, x + step_m, y).height_m - field.at(band, x - step_m, y).height_m) / (2 * step_m);
    const double along_y =
        (field.at(band, x, y + step_m).height_m - field.at(band, x, y - step_m).height_m) / (2 * step_m);
    EXPECT_NEAR(value.slope.x(), along_x, 0.35 * steep);
    EXPECT_NEAR(value.slope.y(), along_y, 0.35 * steep);
    // In space: over all three planes.
    const Eigen::Vector3d place_m(x, y, anywhere(random));
    const Eigen::Vector3d shares = scene::GrainField::shares(Eigen::Vector3d(x, -y, 500.0));
    const Eigen::Vector3d slope = field.slope(band, place_m, shares);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d step = step_m * Eigen::Vector3d::Unit(axis);
      const double rise_m = field.height_m(band, place_m + step, shares) - field.height_m(band, place_m - step, shares);
      EXPECT_NEAR(slope[axis], rise_m / (2 * step_m), 0.7 * steep) << axis;
    }
  }
}

TEST(Grain, GivesHandsThatStrokeNoMoreThanTheLevelStoneAlone) {
  // Without friction, which would take whatever grain gives. Heights of 20 micrometres, steeper than any stone's.
  const scene::HeightSpectrum law{4e-13, 2.0, 800.0};
  const bool nightly = std::getenv("SPARSHA_NIGHTLY") != nullptr;
  double worst_j = 0.0;
  for (const double mass : nightly ? std::vector{0.05, 0.15, 0.5} : std::vector{0.05})
    for (const double damping : nightly ? std::vector{0.3, 2.0, 10.0} : std::vector{0.3, 10.0})
      for (const double delay : nightly ? std::vector{0.0, 0.001, 0.003} : std::vector{0.0, 0.003})
        for (const double rate : {333.0, 1000.0, 4000.0}) {
          sparsha::test::TouchCase c;
          c.stroke = true;
          c.mass_kg = mass;
          c.damping_n_s_per_m = damping;
          c.delay_s = delay;
          c.rate_hz = c.configured_hz = rate;
          c.duration_s = nightly ? 10.0 : 4.0;
          const double rough_j = sparsha::test::touch(c, grained(law)).delivered_j;
          const double smooth_j = sparsha::test::touch(c, grained(scene::HeightSpectrum{})).delivered_j;
          worst_j = std::max(worst_j, rough_j - smooth_j);
          EXPECT_LE(rough_j, smooth_j + 0.003) << mass << " kg " << damping << " N s/m " << delay << " s " << rate;
        }
  std::printf("at most %.2f mJ more in a run\n", 1e3 * worst_j);
}

}  // namespace
}  // namespace sparsha::haptics
