// All is judged by ranks and signs of steps, so that neither the unit of the time nor a far outlier matters.
#include "pipeline/scan/formats/text/time_column.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/numbers/statistics.h"

namespace sparsha::pipeline {
namespace {

using Values = std::vector<double>;

constexpr std::size_t kFewestRows = 100;
constexpr double kKeepsOn = 0.6;  // of the steps that are not 0; of noise it is a third

struct Quartiles {
  double low = 0.0, high = 0.0;
  [[nodiscard]] double size() const { return high - low; }
};

Quartiles quartiles_of(Values values) {
  const double low = quantile(values, 0.25);
  return {low, quantile(values, 0.75)};
}

/// Share of the steps that go the way of the one before, steps of 0 left out; 1 when there are none.
double share_that_keeps_on(const Values& values) {
  std::uint64_t steps = 0;
  std::uint64_t kept = 0;
  double before = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = values[i] - values[i - 1];
    if (step == 0.0) continue;
    if (before != 0.0) {
      ++steps;
      kept += (step > 0.0) == (before > 0.0) ? 1 : 0;
    }
    before = step;
  }
  return steps == 0 ? 1.0 : static_cast<double>(kept) / static_cast<double>(steps);
}

/// Whether rows lie beside the ones before them in this column.
bool is_smooth(const Values& values) {
  constexpr double kSlow = 0.1;  // of the distance of the quartiles; of noise it is 0.6
  if (share_that_keeps_on(values) >= kKeepsOn) return true;
  Values steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(std::abs(values[i] - values[i - 1]));
  return median(steps) <= kSlow * quartiles_of(values).size();
}

/// How often the values go from below the lower quartile to above the upper one, or back.
std::uint64_t count_sweeps(const Values& values) {
  const Quartiles quartiles = quartiles_of(values);
  if (!(quartiles.size() > 0.0)) return 0;
  std::uint64_t sweeps = 0;
  int side = 0;
  for (const double v : values) {
    const int now = v < quartiles.low ? -1 : v > quartiles.high ? 1 : side;
    sweeps += side != 0 && now != side ? 1 : 0;
    side = now;
  }
  return sweeps;
}

/// More than the classes and shades that whole numbers of a byte are.
bool has_many_values(const Values& values) {
  constexpr std::size_t kFew = 16;
  const bool bytes =
      std::all_of(values.begin(), values.end(), [](double v) { return v >= 0.0 && v <= 255.0 && v == std::floor(v); });
  Values distinct = values;
  std::sort(distinct.begin(), distinct.end());
  const auto count = static_cast<std::size_t>(std::unique(distinct.begin(), distinct.end()) - distinct.begin());
  return !bytes && count > kFew;
}

/// Whether a column goes to and fro in runs of rows.
bool is_sweep(const Values& values) {
  constexpr std::uint64_t kFewestSweeps = 8;
  return share_that_keeps_on(values) >= kKeepsOn && count_sweeps(values) >= kFewestSweeps;
}

std::uint64_t count_rises(const Values& time) {
  std::uint64_t rises = 0;
  for (std::size_t i = 1; i < time.size(); ++i) rises += time[i] > time[i - 1] ? 1 : 0;
  return rises;
}

/// Rows at which `time` rises while a sweep goes on.
std::uint64_t count_rises_within(const Values& time, const Values& sweep) {
  std::uint64_t rises = 0;
  for (std::size_t i = 2; i < sweep.size(); ++i) {
    rises += time[i] > time[i - 1] && (sweep[i] - sweep[i - 1]) * (sweep[i - 1] - sweep[i - 2]) > 0.0 ? 1 : 0;
  }
  return rises;
}

/// Whether one column is a multiple of another and a constant, but for rounding.
bool is_linear(const Values& x, const Values& y) {
  constexpr double kOff = 1e-3;  // of the deviation; of a time and rows of a surface it is one over the rows
  double sum_x = 0.0, sum_y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = x[i] - x[0];
    const double dy = y[i] - y[0];
    sum_x += dx;
    sum_y += dy;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  const auto count = static_cast<double>(x.size());
  xx -= sum_x * sum_x / count;
  xy -= sum_x * sum_y / count;
  yy -= sum_y * sum_y / count;
  return !(xx > 0.0) || yy - xy * xy / xx <= kOff * kOff * yy;
}

/// Whether the first column rises in a fixed ratio to a sweep, but for rounding, and by another step from one sweep to
/// the next: rows of a lattice that is turned by less than a step per row.
bool is_turned_lattice(const Values& x, const Values& sweep) {
  constexpr double kLike = 0.1;
  constexpr double kMost = 0.95;
  constexpr double kOneRounding = 1.01;  // in binary
  constexpr double kOther = 3.0;         // roundings
  Values ratios, within, between;
  double rounding = std::numeric_limits<double>::infinity();  // no more than the least step
  for (std::size_t i = 2; i < sweep.size(); ++i) {
    const double step = sweep[i] - sweep[i - 1];
    const double before = sweep[i - 1] - sweep[i - 2];
    const double rise = x[i] - x[i - 1];
    if (step * before > 0.0) {
      ratios.push_back(rise / step);
      within.push_back(rise);
      if (rise > 0.0) rounding = std::min(rounding, rise);
    } else if (before != 0.0) {
      between.push_back(rise);
    }
  }
  if (within.empty() || between.empty()) return false;
  const double ratio = median(ratios);
  std::size_t alike = 0;
  for (std::size_t i = 2; i < sweep.size(); ++i) {
    const double step = sweep[i] - sweep[i - 1];
    if (!(step * (sweep[i - 1] - sweep[i - 2]) > 0.0)) continue;
    const double expected = ratio * step;
    alike +=
        std::abs(x[i] - x[i - 1] - expected) <= std::max(kLike * std::abs(expected), kOneRounding * rounding) ? 1 : 0;
  }
  const double step = median(within);
  return static_cast<double>(alike) >= kMost * static_cast<double>(within.size()) &&
         std::abs(median(between) - step) > std::max(kLike * step, kOther * rounding);
}

}  // namespace

bool TimeColumn::sweeps() const {
  // Per sweep, of which a row and its way back are two. Sections of equal x that are closed have a half.
  constexpr double kFewestRises = 0.75;
  constexpr double kWithin = 0.25;  // of all rises; where x rises from sweep to sweep it is none
  if (rows() < kFewestRows || !(values_[0].back() > values_[0].front())) return false;
  if (!has_many_values(values_[3])) return false;  // a class, a colour
  const auto rises = static_cast<double>(count_rises(values_[0]));
  bool any = false;
  int sweeping = 0;
  for (std::size_t k = 1; k < 4; ++k) {
    if (!is_smooth(values_[k])) return false;
    if (!is_sweep(values_[k])) continue;
    const auto within = static_cast<double>(count_rises_within(values_[0], values_[k]));
    if (within < kWithin * rises) return false;
    // The fourth column may be no coordinate: it counts where neither of the two before it sweeps.
    if (k == 3 && sweeping > 0) continue;
    ++sweeping;
    any = any || within >= kFewestRises * static_cast<double>(count_sweeps(values_[k]));
  }
  return any && !is_profile_or_lattice();
}

bool TimeColumn::is_profile_or_lattice() const {
  if (rows() < kFewestRows) return false;
  if (is_linear(values_[0], values_[1]) || is_linear(values_[0], values_[2])) return true;
  return std::any_of(values_.begin() + 1, values_.end(),
                     [&](const Values& values) { return is_sweep(values) && is_turned_lattice(values_[0], values); });
}

}  // namespace sparsha::pipeline
