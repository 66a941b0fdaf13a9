// Errors in classes: everywhere, away from steps, on smooth parts, beside bars.
#include "bench/pipeline/judge.h"
#include "base/numbers/statistics.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "base/error.h"

namespace sparsha::bench {
namespace {

constexpr double kAwaySpacings = 3.0;
constexpr double kMilli = 1e-3;

double rms(const std::vector<double>& errors) {
  double sum = 0.0;
  for (const double e : errors) sum += e * e;
  return errors.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(errors.size()));
}

double quantile_or_0(std::vector<double> errors, double share) {
  return errors.empty() ? 0.0 : quantile(errors, share);
}

double percent_above(const std::vector<double>& errors, double limit) {
  const auto above = std::count_if(errors.begin(), errors.end(), [&](double e) { return e > limit; });
  return errors.empty() ? 0.0 : 100.0 * static_cast<double>(above) / static_cast<double>(errors.size());
}

}  // namespace

std::vector<Sample> samples_of(const scene::DepthGrid& grid, const pipeline::Truth& truth) {
  const scene::Lattice& lattice = grid.lattice;
  const scene::Lattice& expected = truth.lattice();
  const double slack = 1e-6 * expected.spacing_m;
  if (lattice.nx != expected.nx || lattice.ny != expected.ny || std::fabs(lattice.x_m(0) - expected.x_m(0)) > slack ||
      std::fabs(lattice.y_m(0) - expected.y_m(0)) > slack) {
    throw Error(ErrorKind::failure, {}, "the grid does not lie on the lattice of the truth");
  }
  std::vector<Sample> samples;
  for (int j = 0; j < lattice.ny; ++j) {
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t k = lattice.index(i, j);
      if (grid.state[k] != scene::NodeState::measured) continue;
      samples.push_back({lattice.x_m(i), lattice.y_m(j), lattice.origin_m.z() + static_cast<double>(grid.height_m[k])});
    }
  }
  return samples;
}

Figures judge(std::span<const Sample> samples, const pipeline::Truth& truth) {
  const double spacing = truth.lattice().spacing_m;
  const auto* bars = std::get_if<pipeline::BarsForm>(&truth.surface().config().form);
  std::vector<double> all, away, smooth, beside;
  for (const Sample& s : samples) {
    const double error = std::fabs(s.z_m - truth.height_m(s.x_m, s.y_m));
    const double step = truth.step_distance_m(s.x_m, s.y_m);
    all.push_back(error);
    if (step > kAwaySpacings * spacing) {
      away.push_back(error);
      if (truth.crease_distance_m(s.x_m, s.y_m) > kAwaySpacings * spacing) smooth.push_back(error);
    }
    const bool low = bars != nullptr && truth.height_m(s.x_m, s.y_m) < 0.5 * bars->bar_m;
    if (low && step < spacing) beside.push_back(error);
  }
  Figures f;
  f.coverage_percent = 100.0 * static_cast<double>(samples.size()) / static_cast<double>(truth.lattice().count());
  f.rms_away_mm = rms(away) / kMilli;
  f.p99_away_mm = quantile_or_0(away, 0.99) / kMilli;
  f.off2_away_percent = percent_above(away, 2.0 * kMilli);
  f.rms_all_mm = rms(all) / kMilli;
  f.off5_all_percent = percent_above(all, 5.0 * kMilli);
  f.rms_smooth_mm = rms(smooth) / kMilli;
  f.median_mm = quantile_or_0(all, 0.5) / kMilli;
  f.beside_percent = beside.empty() ? 0.0 : 100.0 - percent_above(beside, 1.0 * kMilli);
  return f;
}

}  // namespace sparsha::bench
