#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "bench/effects/texture.h"
#include "bench/report/turns.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector2d;
using Spectrum = std::vector<std::complex<double>>;

/// Of the signal without its mean under a Hann window, up to the last band; bin n is n / duration.
Spectrum spectrum_of(const std::vector<double>& signal, double tick_s) {
  const std::size_t count = signal.size();
  double mean = 0.0;
  for (const double value : signal) mean += value / static_cast<double>(count);
  std::vector<std::complex<double>> turns(count);
  for (std::size_t n = 0; n < count; ++n)
    turns[n] = std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(count));
  std::vector<double> windowed(count);
  for (std::size_t n = 0; n < count; ++n) windowed[n] = (signal[n] - mean) * 0.5 * (1.0 - turns[n].real());
  const double top_hz = *(std::end(kTextureBands) - 1);
  const auto bins = static_cast<std::size_t>(top_hz * tick_s * static_cast<double>(count)) + 1;
  Spectrum spectrum(bins);
  for (std::size_t bin = 0; bin < bins; ++bin)
    for (std::size_t n = 0; n < count; ++n) spectrum[bin] += windowed[n] * turns[(bin * n) % count];
  return spectrum;
}

double rms(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

void measure_times(const std::vector<TextureEntrant>& entrants, const TextureStroke& stroke,
                   std::vector<TextureRow>& rows) {
  constexpr std::size_t kGroup = 16;
  constexpr int kRounds = 5;
  std::vector<TickTimes> times(entrants.size(), TickTimes(0, static_cast<std::size_t>(stroke.ticks), kGroup));
  std::vector<Turn> methods;
  for (std::size_t n = 0; n < entrants.size(); ++n)
    methods.push_back({[&rendered = *entrants[n].rendered, &mine = times[n], &stroke] {
      return mine.time_round(
          [&](std::size_t tick) { return rendered.force_m(stroke.hand(static_cast<int>(tick))).y(); });
    }});
  const std::vector<TurnTimes> taken = take_turns(methods, kRounds);
  for (std::size_t n = 0; n < entrants.size(); ++n) {
    rows[n].tick_p50_ns = times[n].quantile_ns(0.5);
    rows[n].tick_p99_ns = times[n].quantile_ns(0.99);
    rows[n].ratio = taken[n].ratio;
    rows[n].ratio_low = taken[n].ratio_low;
    rows[n].ratio_high = taken[n].ratio_high;
  }
}

}  // namespace

void compare_spectra(const std::vector<double>& rendered, const std::vector<double>& truth, double tick_s,
                     TextureRow& row) {
  const Spectrum r = spectrum_of(rendered, tick_s);
  const Spectrum t = spectrum_of(truth, tick_s);
  const double bin_hz = 1.0 / (tick_s * static_cast<double>(truth.size()));
  double apart = 0.0, all = 0.0;
  for (std::size_t band = 0; band + 1 < std::size(kTextureBands); ++band) {
    double rr = 0.0, tt = 0.0;
    std::complex<double> rt;
    for (std::size_t bin = 0; bin < t.size(); ++bin) {
      const double hz = bin_hz * static_cast<double>(bin);
      if (hz < kTextureBands[band] || hz >= kTextureBands[band + 1]) continue;
      rr += std::norm(r[bin]);
      tt += std::norm(t[bin]);
      rt += r[bin] * std::conj(t[bin]);
      apart += std::pow(std::abs(r[bin]) - std::abs(t[bin]), 2);
      all += std::norm(t[bin]);
    }
    row.gain[band] = tt > 0.0 ? std::sqrt(rr / tt) : 0.0;
    row.coherence[band] = rr > 0.0 && tt > 0.0 ? std::max(0.0, rt.real()) / std::sqrt(rr * tt) : 0.0;
  }
  row.spectrum_error = std::sqrt(apart / all);
}

std::vector<TextureRow> texture_rows() {
  const Profile profile;
  const TextureStroke stroke;
  std::vector<Vector2d> truth;
  std::vector<double> truth_x, truth_z;
  for (int tick = 0; tick < stroke.ticks; ++tick) {
    truth.push_back(true_force_m(profile, stroke.hand(tick)));
    truth_x.push_back(truth.back().x());
    truth_z.push_back(truth.back().y());
  }
  std::vector<double> variation;
  for (const Vector2d& force : truth) variation.push_back((force - Vector2d(0.0, stroke.depth_m)).norm());
  std::vector<TextureRow> rows;
  const std::vector<TextureEntrant> entrants = all_textures(profile, stroke);
  for (const TextureEntrant& entrant : entrants) {
    TextureRow row;
    row.method = entrant.method;
    row.setting = entrant.setting;
    row.source = entrant.source;
    row.numbers = entrant.rendered->numbers();
    std::vector<double> x, z, off;
    for (int tick = 0; tick < stroke.ticks; ++tick) {
      const Vector2d force = entrant.rendered->force_m(stroke.hand(tick));
      x.push_back(force.x());
      z.push_back(force.y());
      off.push_back((force - truth[static_cast<std::size_t>(tick)]).norm());
    }
    compare_spectra(z, truth_z, stroke.tick_s, row);
    row.lateral = rms(x) / rms(truth_x);
    row.force_error = rms(off) / rms(variation);
    rows.push_back(row);
  }
  measure_times(entrants, stroke, rows);
  return rows;
}

}  // namespace sparsha::bench
