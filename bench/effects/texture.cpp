#include "bench/effects/texture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "bench/effects/wavelet.h"
#include "bench/report/figure_text.h"
#include "haptics/proxy/proxy.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector2d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr std::size_t kSamples = 2048;  // of the profile along the stroke, for methods that store its transform

/// The profile is in the depth grid, and a point feels it.
class Geometry : public TextureMethod {
 public:
  Geometry(const Profile& profile, const TextureStroke& stroke, double spacing_m) {
    constexpr int kRows = 3;
    const int margin = static_cast<int>(std::ceil(0.01 / spacing_m));
    surface_.lattice.spacing_m = spacing_m;
    surface_.lattice.nx = static_cast<int>(std::ceil(stroke.length_m() / spacing_m)) + 1 + 2 * margin;
    surface_.lattice.ny = kRows;
    start_m_ = margin * spacing_m;
    for (int j = 0; j < kRows; ++j)
      for (int i = 0; i < surface_.lattice.nx; ++i)
        surface_.height_m.push_back(static_cast<float>(profile.height(i * spacing_m - start_m_)));
  }
  Vector2d force_m(const Vector2d& hand) override {
    const Eigen::Vector3d place(hand.x() + start_m_, surface_.lattice.spacing_m, hand.y());
    if (!started_) state_ = haptics::start_proxy(surface_, place);
    started_ = true;
    const haptics::ProxyUpdate found = update_exact(surface_, place, state_, options_);
    return {found.position.x() - place.x(), found.position.z() - place.z()};
  }
  std::size_t numbers() const override { return static_cast<std::size_t>(surface_.lattice.nx); }

 private:
  haptics::MongeSurface surface_;
  haptics::SolverOptions options_;
  haptics::ProxyState state_;
  double start_m_ = 0.0;
  bool started_ = false;
};

struct Harmonic {
  double k;
  double cosine;
  double sine;
};

/// Harmonics of the stroke's length, the largest first.
std::vector<Harmonic> harmonics(const std::vector<double>& heights, double length_m) {
  std::vector<Harmonic> all;
  const auto count = static_cast<double>(heights.size());
  for (std::size_t m = 1; m < heights.size() / 2; ++m) {
    Harmonic h{kTurn * static_cast<double>(m) / length_m, 0.0, 0.0};
    for (std::size_t n = 0; n < heights.size(); ++n) {
      const double angle = kTurn * static_cast<double>((m * n) % heights.size()) / count;
      h.cosine += 2.0 / count * heights[n] * std::cos(angle);
      h.sine += 2.0 / count * heights[n] * std::sin(angle);
    }
    all.push_back(h);
  }
  std::sort(all.begin(), all.end(), [](const Harmonic& a, const Harmonic& b) {
    return std::hypot(a.cosine, a.sine) > std::hypot(b.cosine, b.sine);
  });
  return all;
}

/// A flat proxy; the force along its normal is that of a surface higher by a sum of harmonics at the hand's place.
class Harmonics : public TextureMethod {
 public:
  explicit Harmonics(std::vector<Harmonic> harmonics) : harmonics_(std::move(harmonics)) {}
  Vector2d force_m(const Vector2d& hand) override {
    double height = 0.0;
    for (const Harmonic& h : harmonics_)
      height += h.cosine * std::cos(h.k * hand.x()) + h.sine * std::sin(h.k * hand.x());
    return {0.0, std::max(0.0, height - hand.y())};
  }
  std::size_t numbers() const override { return 3 * harmonics_.size(); }

 private:
  std::vector<Harmonic> harmonics_;
};

/// As Harmonics, from the largest coefficients of the wavelet transform, put together again when the stroke begins.
class Wavelets : public TextureMethod {
 public:
  Wavelets(const std::vector<double>& heights, double length_m, std::size_t kept)
      : kept_(kept), spacing_m_(length_m / static_cast<double>(heights.size())) {
    std::vector<double> coefficients = wavelet_transform(heights);
    std::vector<std::size_t> order(coefficients.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return std::abs(coefficients[a]) > std::abs(coefficients[b]);
    });
    for (std::size_t n = kept; n < order.size(); ++n) coefficients[order[n]] = 0.0;
    height_m_ = inverse_wavelet_transform(coefficients);
  }
  Vector2d force_m(const Vector2d& hand) override {
    const double at = std::max(0.0, hand.x() / spacing_m_);
    const auto node = static_cast<std::size_t>(at);
    const double share = at - static_cast<double>(node);
    const double height =
        (1.0 - share) * height_m_[node % height_m_.size()] + share * height_m_[(node + 1) % height_m_.size()];
    return {0.0, std::max(0.0, height - hand.y())};
  }
  std::size_t numbers() const override { return 2 * kept_; }

 private:
  std::size_t kept_;
  double spacing_m_;
  std::vector<double> height_m_;
};

/// The wave of largest amplitude, raised to the RMS of them all.
std::vector<Harmonic> one_sinusoid(const std::vector<Harmonic>& all) {
  double squares = 0.0;
  for (const Harmonic& h : all) squares += h.cosine * h.cosine + h.sine * h.sine;
  Harmonic one = all.front();
  const double raise = std::sqrt(squares) / std::hypot(one.cosine, one.sine);
  one.cosine *= raise;
  one.sine *= raise;
  return {one};
}

}  // namespace

Profile::Profile() {
  constexpr int kWaves = 28;
  constexpr double kShortest_m = 0.001, kLongest_m = 0.03, kRms_m = 0.00005, kHurst = 0.8;
  std::mt19937_64 random(23);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  double squares = 0.0;
  for (int n = 0; n < kWaves; ++n) {
    const double length = kShortest_m * std::pow(kLongest_m / kShortest_m, (n + uniform()) / kWaves);
    waves_.push_back({kTurn / length, kTurn * uniform(), std::pow(length, kHurst)});
    squares += 0.5 * waves_.back().amplitude * waves_.back().amplitude;
  }
  for (Wave& wave : waves_) wave.amplitude *= kRms_m / std::sqrt(squares);
}

double Profile::height(double x) const {
  double z = 0.0;
  for (const Wave& w : waves_) z += w.amplitude * std::sin(w.k * x + w.phase);
  return z;
}

double Profile::slope(double x) const {
  double slope = 0.0;
  for (const Wave& w : waves_) slope += w.amplitude * w.k * std::cos(w.k * x + w.phase);
  return slope;
}

Vector2d true_force_m(const Profile& profile, const Vector2d& hand) {
  constexpr double kStep = 1e-7;
  const auto pull = [&](double x) { return (x - hand.x()) + (profile.height(x) - hand.y()) * profile.slope(x); };
  double x = hand.x();
  for (int k = 0; k < 100; ++k) {
    const double bend = (pull(x + kStep) - pull(x - kStep)) / (2.0 * kStep);
    const double step = pull(x) / std::max(bend, 0.2);
    x -= step;
    if (std::abs(step) < 1e-15) break;
  }
  return {x - hand.x(), profile.height(x) - hand.y()};
}

std::vector<TextureEntrant> all_textures(const Profile& profile, const TextureStroke& stroke) {
  std::vector<double> heights;
  for (std::size_t n = 0; n < kSamples; ++n)
    heights.push_back(profile.height(stroke.length_m() * static_cast<double>(n) / kSamples));
  const std::vector<Harmonic> all = harmonics(heights, stroke.length_m());
  std::vector<TextureEntrant> entrants;
  for (const double mm : {0.125, 0.25, 0.5, 1.0})
    entrants.push_back({"geometry", text_of("nodes %g mm apart", mm), "ours: docs/touch.md",
                        std::make_unique<Geometry>(profile, stroke, 1e-3 * mm)});
  entrants.push_back({"sinusoid", "one wave of the profile's RMS", "Choi and Tan, Presence 13(4), 2004",
                      std::make_unique<Harmonics>(one_sinusoid(all))});
  for (const std::size_t kept : {std::size_t{16}, std::size_t{64}, std::size_t{256}})
    entrants.push_back({"fourier", text_of("%.0f harmonics", static_cast<double>(kept)),
                        "Wall and Harwin, Eurohaptics 2001",
                        std::make_unique<Harmonics>(
                            std::vector<Harmonic>(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(kept)))});
  for (const std::size_t kept : {std::size_t{64}, std::size_t{256}, std::size_t{1024}})
    entrants.push_back({"wavelet", text_of("%.0f coefficients", static_cast<double>(kept)),
                        "Daubechies 1988, the largest coefficients",
                        std::make_unique<Wavelets>(heights, stroke.length_m(), kept)});
  return entrants;
}

}  // namespace sparsha::bench
