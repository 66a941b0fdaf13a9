#include "tests/support/surfaces.h"

#include <cmath>
#include <numbers>

namespace sparsha::haptics::test {

MongeSurface make_fractal_surface(int nodes, double spacing_m, double amplitude_m, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto count = static_cast<std::size_t>(nodes);
  std::vector<double> z(count * count, 0.0);
  const auto at = [&](int i, int j) -> double& {
    return z[static_cast<std::size_t>(j) * count + static_cast<std::size_t>(i)];
  };
  double sigma = amplitude_m;
  for (int step = nodes - 1; step > 1; step /= 2) {
    const int half = step / 2;
    for (int j = half; j < nodes; j += step)
      for (int i = half; i < nodes; i += step)
        at(i, j) =
            0.25 * (at(i - half, j - half) + at(i + half, j - half) + at(i - half, j + half) + at(i + half, j + half)) +
            sigma * normal(random);
    for (int j = 0; j < nodes; j += half)
      for (int i = (j / half) % 2 == 0 ? half : 0; i < nodes; i += step) {
        double sum = 0.0;
        int neighbours = 0;
        for (const auto& [di, dj] : {std::pair{-half, 0}, {half, 0}, {0, -half}, {0, half}})
          if (i + di >= 0 && i + di < nodes && j + dj >= 0 && j + dj < nodes) sum += at(i + di, j + dj), ++neighbours;
        at(i, j) = sum / neighbours + 0.7 * sigma * normal(random);
      }
    sigma *= std::pow(2.0, -0.7);
  }
  return make_surface_of(nodes, nodes, spacing_m, [&](double x, double y) {
    return at(static_cast<int>(std::lround(x / spacing_m)), static_cast<int>(std::lround(y / spacing_m)));
  });
}

MongeSurface make_sinusoid(int nodes) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  return make_surface_of(nodes, nodes, 1.0 / (nodes - 1),
                         [](double x, double y) { return 0.05 * std::sin(kTurn * x) * std::sin(kTurn * y); });
}

}  // namespace sparsha::haptics::test
