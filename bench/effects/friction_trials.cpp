#include "friction_trials.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <numbers>

#include <Eigen/Geometry>

namespace sparsha::bench {
namespace {

using Eigen::Vector2d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kPress = 2.0;         // N
constexpr double kEncoder = 0.000058;  // m: a Falcon's
constexpr double kRadius = 0.05;       // m
constexpr double kCircleSpeed = 0.1;   // m/s

Vector2d on_encoder(const Vector2d& place) { return (place / kEncoder).array().round().matrix() * kEncoder; }

Vector2d on_circle(double t_s) {
  const double angle = kCircleSpeed / kRadius * t_s;
  return kRadius * Vector2d(std::cos(angle) - 1.0, std::sin(angle));
}

void measure_slide(FrictionLaw& law, const FrictionSetting& setting, FrictionRow& row) {
  constexpr int kTicks = 6000, kSettled = 2000;
  law.place(on_circle(0.0));
  for (int tick = 1; tick <= kTicks; ++tick) {
    const double t = setting.tick_s * tick;
    const Vector2d force = law.update(on_circle(t), kPress);
    if (tick <= kSettled) continue;
    const Vector2d back = on_circle(t - 0.5e-6) - on_circle(t + 0.5e-6);
    constexpr double kShare = 1.0 / (kTicks - kSettled);
    row.slide_error += kShare * (force.norm() / (setting.mu_dynamic * kPress) - 1.0);
    row.angle_deg +=
        kShare * std::abs(std::atan2(back.x() * force.y() - back.y() * force.x(), back.dot(force))) * 360.0 / kTurn;
  }
}

void measure_break(FrictionLaw& law, double mu, FrictionRow& row) {
  law.place(Vector2d::Zero());
  double most = 0.0;
  for (int tick = 1; tick <= 4000; ++tick) most = std::max(most, law.update({0.000001 * tick, 0.0}, kPress).norm());
  row.break_error = most / (mu * kPress) - 1.0;
}

void measure_drift(FrictionLaw& law, const FrictionSetting& setting, FrictionRow& row) {
  const double pull = 0.5 * setting.mu_dynamic * kPress / setting.stiffness_n_per_m;
  law.place(Vector2d::Zero());
  Vector2d after_one_second = Vector2d::Zero();
  for (int tick = 1; tick <= 10000; ++tick) {
    const double t = setting.tick_s * tick;
    const Vector2d tremble(0.1 * pull * std::sin(kTurn * 23.0 * t), 0.1 * pull * std::cos(kTurn * 23.0 * t));
    const Vector2d hand = Vector2d(pull * std::min(1.0, t / 0.05), 0.0) + tremble;
    static_cast<void>(law.update(on_encoder(hand), kPress * (1.0 + 0.2 * std::sin(kTurn * 7.0 * t))));
    if (tick == 1000) after_one_second = law.anchor();
  }
  row.drift_m = (law.anchor() - after_one_second).norm();
}

void measure_chatter(FrictionLaw& law, const FrictionSetting& setting, FrictionRow& row) {
  constexpr int kTicks = 6000, kSettled = 3000;
  constexpr double kSlow = 0.002;  // m/s
  law.place(Vector2d::Zero());
  double sum = 0.0, squares = 0.0;
  for (int tick = 1; tick <= kTicks; ++tick) {
    const double x = kSlow * setting.tick_s * tick;
    const double force = law.update(on_encoder({x, 0.3 * x}), kPress).norm();
    if (tick <= kSettled) continue;
    sum += force;
    squares += force * force;
  }
  const double mean = sum / (kTicks - kSettled);
  row.chatter = std::sqrt(std::max(0.0, squares / (kTicks - kSettled) - mean * mean)) / mean;
  row.slow_error = mean / (setting.mu_dynamic * kPress) - 1.0;
}

double measure_time(FrictionLaw& law, const FrictionSetting& setting) {
  constexpr int kUpdates = 20000;
  double best = 1e18, sink = 0.0;
  for (int run = 0; run < 5; ++run) {
    std::vector<Vector2d> hands;
    for (int tick = 0; tick < kUpdates; ++tick) hands.push_back(on_circle(setting.tick_s * tick));
    law.place(hands.front());
    const auto begin = std::chrono::steady_clock::now();
    for (const Vector2d& hand : hands) sink += law.update(hand, kPress).x();
    const auto end = std::chrono::steady_clock::now();
    best = std::min(best, std::chrono::duration<double, std::nano>(end - begin).count() / kUpdates);
  }
  return best + (sink == 0.125 ? 1e-9 : 0.0);  // the sum is used, so that no update can be left out
}

/// Times of slips: the mass becomes faster than the drawing end, having been slow.
class Slips {
 public:
  explicit Slips(double speed) : speed_(speed) {}
  void add(double t_s, double velocity) {
    if (velocity < 0.3 * speed_) armed_ = true;
    if (!armed_ || velocity < speed_) return;
    armed_ = false;
    times_.push_back(t_s);
  }
  [[nodiscard]] double period_s() const {
    std::vector<double> late;  // the first ones are not yet alike
    std::copy_if(times_.begin(), times_.end(), std::back_inserter(late), [](double t) { return t > 2.0; });
    return late.size() < 3 ? 0.0 : (late.back() - late.front()) / static_cast<double>(late.size() - 1);
  }

 private:
  double speed_;
  bool armed_ = true;
  std::vector<double> times_;
};

constexpr double kDrawn_s = 8.0;

}  // namespace

double stick_slip_period(const FrictionEntrant& entrant, const FrictionSetting& setting, const DrawnMass& drawn) {
  constexpr int kSteps = 100;
  const auto law = entrant.make(setting);
  law->place(Vector2d::Zero());
  Slips slips(drawn.speed_m_per_s);
  double x = 0.0, v = 0.0;
  const double step = setting.tick_s / kSteps;
  for (int tick = 0; tick * setting.tick_s < kDrawn_s; ++tick) {
    const double friction = law->update({x, 0.0}, drawn.press_n).x();
    for (int k = 0; k < kSteps; ++k) {
      const double t = setting.tick_s * tick + step * k;
      v += step / drawn.mass_kg *
           (drawn.stiffness_n_per_m * (drawn.speed_m_per_s * t - x) +
            drawn.damping_n_s_per_m * (drawn.speed_m_per_s - v) + friction);
      x += step * v;
      slips.add(t, v);
    }
  }
  return slips.period_s();
}

double continuous_period(const FrictionSetting& setting, const DrawnMass& drawn) {
  constexpr double kStep = 2e-6;
  Slips slips(drawn.speed_m_per_s);
  const double k = setting.stiffness_n_per_m;
  const double most = setting.mu_static * drawn.press_n, slides = setting.mu_dynamic * drawn.press_n;
  double x = 0.0, v = 0.0, anchor = 0.0;
  bool held = true;
  for (long n = 0; kStep * static_cast<double>(n) < kDrawn_s; ++n) {
    const double t = kStep * static_cast<double>(n);
    if (held && std::abs(x - anchor) * k > most) held = false;
    if (!held && (x - anchor) * v < 0.0) held = true;
    if (!held) anchor = x - std::copysign(slides / k, x - anchor);
    v += kStep / drawn.mass_kg *
         (drawn.stiffness_n_per_m * (drawn.speed_m_per_s * t - x) +
          drawn.damping_n_s_per_m * (drawn.speed_m_per_s - v) - k * (x - anchor));
    x += kStep * v;
    slips.add(t, v);
  }
  return slips.period_s();
}

std::vector<FrictionRow> friction_rows() {
  const FrictionSetting setting;
  const DrawnMass drawn;
  const double period = continuous_period(setting, drawn);
  std::vector<FrictionRow> rows;
  for (const FrictionEntrant& entrant : all_friction_laws()) {
    FrictionRow row;
    row.law = entrant.law;
    row.source = entrant.source;
    const auto law = entrant.make(setting);
    measure_slide(*law, setting, row);
    measure_break(*law, entrant.two_coefficients ? setting.mu_static : setting.mu_dynamic, row);
    measure_drift(*law, setting, row);
    measure_chatter(*law, setting, row);
    row.period_s = stick_slip_period(entrant, setting, drawn);
    row.period_true_s = entrant.two_coefficients ? period : 0.0;
    row.tick_ns = measure_time(*law, setting);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace sparsha::bench
