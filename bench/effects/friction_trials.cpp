#include "bench/effects/friction_trials.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>

#include <Eigen/Geometry>

#include "bench/report/turns.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector2d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kPress_n = 2.0;
constexpr double kEncoder_m = 0.000058;  // a Falcon's
constexpr double kRadius_m = 0.05;
constexpr double kCircleSpeed_m_per_s = 0.1;

Vector2d on_encoder(const Vector2d& place) { return (place / kEncoder_m).array().round().matrix() * kEncoder_m; }

Vector2d on_circle(double t_s) {
  const double angle = kCircleSpeed_m_per_s / kRadius_m * t_s;
  return kRadius_m * Vector2d(std::cos(angle) - 1.0, std::sin(angle));
}

void measure_slide(FrictionLaw& law, const FrictionSetting& setting, FrictionRow& row) {
  constexpr int kTicks = 6000, kSettled = 2000;
  law.place(on_circle(0.0));
  for (int tick = 1; tick <= kTicks; ++tick) {
    const double t = setting.tick_s * tick;
    const Vector2d force = law.update(on_circle(t), kPress_n);
    if (tick <= kSettled) continue;
    const Vector2d back = on_circle(t - 0.5e-6) - on_circle(t + 0.5e-6);
    constexpr double kShare = 1.0 / (kTicks - kSettled);
    row.slide_error += kShare * (force.norm() / (setting.mu_dynamic * kPress_n) - 1.0);
    row.angle_deg +=
        kShare * std::abs(std::atan2(back.x() * force.y() - back.y() * force.x(), back.dot(force))) * 360.0 / kTurn;
  }
}

void measure_break(FrictionLaw& law, double mu, FrictionRow& row) {
  law.place(Vector2d::Zero());
  double most = 0.0;
  for (int tick = 1; tick <= 4000; ++tick) most = std::max(most, law.update({0.000001 * tick, 0.0}, kPress_n).norm());
  row.break_error = most / (mu * kPress_n) - 1.0;
}

void measure_drift(FrictionLaw& law, const FrictionSetting& setting, FrictionRow& row) {
  const double pull = 0.5 * setting.mu_dynamic * kPress_n / setting.stiffness_n_per_m;
  law.place(Vector2d::Zero());
  Vector2d after_one_second = Vector2d::Zero();
  for (int tick = 1; tick <= 10000; ++tick) {
    const double t = setting.tick_s * tick;
    const Vector2d tremble(0.1 * pull * std::sin(kTurn * 23.0 * t), 0.1 * pull * std::cos(kTurn * 23.0 * t));
    const Vector2d hand = Vector2d(pull * std::min(1.0, t / 0.05), 0.0) + tremble;
    static_cast<void>(law.update(on_encoder(hand), kPress_n * (1.0 + 0.2 * std::sin(kTurn * 7.0 * t))));
    if (tick == 1000) after_one_second = law.anchor();
  }
  row.drift_m = (law.anchor() - after_one_second).norm();
}

void measure_chatter(FrictionLaw& law, const FrictionSetting& setting, FrictionRow& row) {
  constexpr int kTicks = 6000, kSettled = 3000;
  constexpr double kSlow_m_per_s = 0.002;
  law.place(Vector2d::Zero());
  double sum = 0.0, squares = 0.0;
  for (int tick = 1; tick <= kTicks; ++tick) {
    const double x = kSlow_m_per_s * setting.tick_s * tick;
    const double force = law.update(on_encoder({x, 0.3 * x}), kPress_n).norm();
    if (tick <= kSettled) continue;
    sum += force;
    squares += force * force;
  }
  const double mean = sum / (kTicks - kSettled);
  row.chatter = std::sqrt(std::max(0.0, squares / (kTicks - kSettled) - mean * mean)) / mean;
  row.slow_error = mean / (setting.mu_dynamic * kPress_n) - 1.0;
}

void measure_times(const std::vector<std::unique_ptr<FrictionLaw>>& laws, const FrictionSetting& setting,
                   std::vector<FrictionRow>& rows) {
  constexpr std::size_t kUpdates = 20000, kGroup = 20;
  constexpr int kRounds = 5;
  std::vector<Vector2d> hands;
  for (std::size_t tick = 0; tick < kUpdates; ++tick)
    hands.push_back(on_circle(setting.tick_s * static_cast<double>(tick)));
  std::vector<TickTimes> times(laws.size(), TickTimes(0, kUpdates, kGroup));
  std::vector<Turn> methods;
  for (std::size_t n = 0; n < laws.size(); ++n)
    methods.push_back({[&law = *laws[n], &mine = times[n], &hands] {
      law.place(hands.front());
      return mine.time_round([&](std::size_t tick) { return law.update(hands[tick], kPress_n).x(); });
    }});
  const std::vector<TurnTimes> taken = take_turns(methods, kRounds);
  for (std::size_t n = 0; n < laws.size(); ++n) {
    rows[n].tick_p50_ns = times[n].quantile_ns(0.5);
    rows[n].tick_p99_ns = times[n].quantile_ns(0.99);
    rows[n].ratio = taken[n].ratio;
    rows[n].ratio_low = taken[n].ratio_low;
    rows[n].ratio_high = taken[n].ratio_high;
  }
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
  std::vector<std::unique_ptr<FrictionLaw>> laws;
  for (const FrictionEntrant& entrant : all_friction_laws()) {
    FrictionRow row;
    row.law = entrant.law;
    row.source = entrant.source;
    laws.push_back(entrant.make(setting));
    FrictionLaw* law = laws.back().get();
    measure_slide(*law, setting, row);
    measure_break(*law, entrant.two_coefficients ? setting.mu_static : setting.mu_dynamic, row);
    measure_drift(*law, setting, row);
    measure_chatter(*law, setting, row);
    row.period_s = stick_slip_period(entrant, setting, drawn);
    row.period_true_s = entrant.two_coefficients ? period : 0.0;
    rows.push_back(row);
  }
  measure_times(laws, setting, rows);
  return rows;
}

}  // namespace sparsha::bench
